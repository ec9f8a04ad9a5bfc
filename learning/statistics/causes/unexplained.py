"""What a model with its causes leaves of samples, and noise does not explain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.poses import Poses
from isotorque.learning.statistics.tails import tail_probability

Array = NDArray[np.float64]

SIGNIFICANCE, SHARE = 1e-4, 0.02
"""Where poses repeat, what is left must be this significant and this share of the torque (RMS)."""


def beyond_scatter(fit: ExtendedFit, poses: Poses, rows: Array) -> Array:
    """What is left where the scatter of rows of one pose does not explain it.

    Parameters
    ----------
    fit : ExtendedFit
        Of one sample per pose.
    poses : Poses
        How rows were grouped into samples.
    rows : (N, n) array
        Torques of the rows [N m].

    Returns
    -------
    (n,) array
        Root mean square by joint [N m], as large as if no degrees of freedom had been spent; 0
        where there is nothing.

    Notes
    -----
    N. R. Draper, H. Smith, "Applied Regression Analysis", 3rd ed., Wiley 1998, section 2.1.
    """
    m, n = fit.q.shape
    if not poses.repeated or m != poses.count:
        return np.zeros(n)
    deviation, freedom = poses.spread(rows)
    residual, own = unspent(fit), max(fit.spare / n, 0.5)
    found = np.sqrt(np.mean(residual**2, axis=0))
    for joint, sigma in enumerate(deviation):
        weighted = float((residual[:, joint] ** 2 @ poses.rows) / m)
        ratio = weighted / max(float(sigma) ** 2, 1e-30 * weighted, 1e-300)
        chance = tail_probability(ratio * own, int(np.ceil(own)), float(freedom))
        if chance > SIGNIFICANCE / n:
            found[joint] = 0.0
    large = found.max(initial=0.0) > SHARE * float(np.sqrt(np.mean(fit.torque**2)))
    return np.asarray(found) if large else np.zeros(n)


def beyond_stated_noise(fit: ExtendedFit) -> Array:
    """What is left where the noise that was stated, all of the whitening, does not explain it.

    Returns
    -------
    (n,) array
        Root mean square by joint [N m]; 0 where noise explains it.
    """
    if tail_probability(fit.cost, fit.spare, np.inf) > SIGNIFICANCE:
        return np.zeros(fit.q.shape[1])
    return np.asarray(np.sqrt(np.mean(unspent(fit) ** 2, axis=0)))


def unspent(fit: ExtendedFit) -> Array:
    """Return residuals (m, n) [N m], as large as if no degrees of freedom had been spent."""
    return fit.rest / np.sqrt(fit.spare / fit.torque.size)
