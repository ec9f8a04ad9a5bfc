"""Advice where rigid gravity explains samples badly and further ones will not mend it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.errors_in_variables import torque_features
from isotorque.learning.relations.potential.potential_fit import Frequencies
from isotorque.learning.statistics.torque_scales import torque_scales

Array = NDArray[np.float64]

NOISY = 0.1
"""Torque sensors leave less than this share of the torques (RMS) unexplained, unless said."""


def misfit_advice(q: Array, tau: Array, frequencies: Frequencies) -> str:
    """Say why more samples will not help; nothing where they may.

    Parameters
    ----------
    q, tau : (N, n) arrays
        One sample per pose [rad], [N m].
    frequencies : (m, n) int array
        Those that the potential may have.

    Notes
    -----
    Named is what explains the samples: a scale or a sign of single joints' torques
    (`torque_scales`). Otherwise the size of what is left is told where it is no noise of sensors.

    Examples
    --------
    >>> from isotorque.learning.relations.potential.potential_fit import all_frequencies
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (40, 2))
    >>> print(misfit_advice(q, np.tanh(q), all_frequencies(2)))
    rigid gravity and constants leave 0.27, 0.35 N m RMS by joint, 38 % of the torques: unless the
    torques were measured that badly more samples will not help (a sign or a scale, the order of
    columns, degrees, friction)
    """
    scales = torque_scales(q, tau, frequencies)
    if scales is not None:
        return f"{scales}; more samples will not help"
    touched = frequencies.any(axis=0)
    count, n = len(q), int(touched.sum())
    constants = np.broadcast_to(np.eye(n), (count, n, n))
    columns = np.concatenate([constants, torque_features(frequencies, q)[:, touched]], axis=2)
    design, measured = columns.reshape(count * n, -1), tau[:, touched]
    freedom = count * n - design.shape[1]
    if freedom < 1:
        return ""
    left = measured.ravel() - design @ np.linalg.lstsq(design, measured.ravel(), rcond=None)[0]
    spread = np.sqrt(np.mean(left.reshape(count, n) ** 2, axis=0) * count * n / freedom)
    share = float(np.linalg.norm(spread) / np.linalg.norm(np.sqrt(np.mean(measured**2, axis=0))))
    if not share > NOISY:
        return ""
    listed = ", ".join(f"{x:.2g}" for x in spread)
    return (
        f"rigid gravity and constants leave {listed} N m RMS by joint, {100 * share:.2g} % of the "
        "torques: unless the torques were measured that badly more samples will not help (a sign "
        "or a scale, the order of columns, degrees, friction)"
    )
