"""Least squares in which coefficients that the samples leave open stay as small as torques are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import svd

Array = NDArray[np.float64]

DEPENDENT = 1e-12
"""Singular values below it, relative to the largest, are rounding."""


def shrunk_least_squares(features: Array, targets: Array, largest: float) -> tuple[Array, Array]:
    """Solve least squares with the prior that no coefficient exceeds the torques by far.

    Parameters
    ----------
    features : (m, p) array
        Of size about 1 per unit of a coefficient somewhere, if not at these samples.
    targets : (m,) or (m, k) array
        Torques [N m].
    largest : float
        Standard deviation of the prior of a coefficient: the largest torque of the data [N m].

    Returns
    -------
    solution : (p,) or (p, k) array
    root : (p, p) array
        ``root @ root.T`` is the covariance of the solution (the largest over columns), as far as
        the residuals tell; zero where there are no more samples than coefficients.

    Notes
    -----
    Maximum a posteriori with normal prior and errors: along a right singular vector with singular
    value s the least-squares solution is multiplied by ``s^2 / (s^2 + sigma^2 / largest^2)``. The
    noise sigma follows from the residuals of least squares, so that exact data are fitted exactly;
    with no more samples than coefficients it is unknown, and nothing is shrunk.

    References
    ----------
    A. E. Hoerl, R. W. Kennard, "Ridge regression: biased estimation for nonorthogonal problems",
    Technometrics 12 (1970).

    Examples
    --------
    >>> q = np.array([0.0, 1e-3, 2e-3, 3e-3])  # cos and constant can hardly be told apart
    >>> features = np.stack([np.cos(q), np.ones(4)], axis=1)
    >>> noise = 1e-3 * np.array([1.0, -1.0, -1.0, 1.0])
    >>> plain = np.linalg.lstsq(features, 2.0 * np.cos(q) + noise, rcond=None)[0]
    >>> shrunk, _ = shrunk_least_squares(features, 2.0 * np.cos(q) + noise, 2.0)
    >>> bool(np.abs(plain).max() > 100.0), bool(np.abs(shrunk).max() < 2.0)
    (True, True)
    """
    y = targets[:, None] if targets.ndim == 1 else targets
    left, singular, right = svd(features, full_matrices=False, check_finite=False)
    kept = singular > DEPENDENT * singular.max(initial=0.0)
    left, singular, right = left[:, kept], singular[kept], right[kept]
    coordinates = left.T @ y
    freedom = len(y) - len(singular)
    variance = np.zeros(y.shape[1])
    if freedom > 0:
        variance = ((y - left @ coordinates) ** 2).sum(axis=0) / freedom
    penalty = variance / max(largest, 1e-300) ** 2
    solution = right.T @ (singular[:, None] / (singular[:, None] ** 2 + penalty) * coordinates)
    worst = float(variance.max(initial=0.0))
    spread = np.sqrt(worst / (singular**2 + penalty.max(initial=0.0)))
    root = np.zeros((right.shape[1], right.shape[1]))
    root[:, : len(singular)] = right.T * spread
    if worst > 0.0 and len(singular) < right.shape[1]:
        open_ones = svd(right, full_matrices=True)[2][len(singular) :]
        root[:, len(singular) :] = largest * open_ones.T
    return (solution[:, 0] if targets.ndim == 1 else solution), root
