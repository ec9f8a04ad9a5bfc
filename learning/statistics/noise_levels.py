"""Noise of the torques of every joint, and of the angles, from what a fit leaves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS = 60
"""Of expectation and maximisation."""
CLEAR = 4.0
"""Noise of angles is there if the logarithm of the likelihood grows by so much (p = 0.005)."""
LEAST_NOISE = 1e-6
"""Least variance of the torques, relative to that without noise of the angles."""
ENOUGH = 100
"""Samples from which the noise of angles is estimated, at most twice as many."""
SHRINKING = 3.0
"""Degrees of freedom with which the noise of all joints counts for the noise of each."""


def estimated_levels(
    rest: Array, leverage: Array, weights: Array, leaning: Array | None = None
) -> Array:
    """Standard deviation of the torque error of every joint (n,) [N m], from what a fit leaves.

    Parameters
    ----------
    rest : (m, n) array
        What the fit leaves [N m].
    leverage : (m, n) array
        Share of each error that the fit takes.
    weights : (m,) array
        Of the squared errors of the samples.
    leaning : (m, n, k) array, optional
        Torques [N m] for one standard deviation of each error of the angles that is known to be
        there: it explains a part.

    Examples
    --------
    >>> rest = np.array([[0.1, 0.02], [-0.1, 0.02]] * 50)
    >>> estimated_levels(rest, np.zeros((100, 2)), np.ones(100)).round(3).tolist()
    [0.1, 0.02]
    """
    left = np.maximum(1.0 - leverage, 0.0).sum(axis=0)
    square = (rest**2 * weights[:, None]).sum(axis=0)
    pooled = square.sum() / max(left.sum(), 1e-3)
    variance = (square + SHRINKING * pooled * 1e-2) / (left + SHRINKING * 1e-2 + 1e-3)
    if leaning is not None and leaning.any():
        variance = np.maximum(variance - np.mean((leaning**2).sum(axis=2), axis=0), 0.01 * variance)
    return np.asarray(np.sqrt(variance))


def estimated_angle_noise(rest: Array, stiffness: Array, levels: Array) -> tuple[Array, float]:
    """Noise of torques and of angles that explains residuals best (maximum likelihood).

    Parameters
    ----------
    rest : (m, n) array
        What a fit leaves [N m].
    stiffness : (m, n, n) array
        H = d torque / d q [N m/rad]: an error e of the angles shows as H e.
    levels : (n,) array
        Noise of the torques without any of the angles [N m], to start from.

    Returns
    -------
    levels : (n,) array
        Standard deviation of the torque errors [N m].
    angle : float
        That of the angle errors [rad], equal for all joints; 0 unless it is `CLEAR`.

    Notes
    -----
    Errors of angles spread the residuals unevenly, more where the torque is steep, and alike over
    the joints; taken for even noise they look like causes. Expectation and maximisation [1]_ of
    ``rest_k = H_k e_k + t_k``.

    References
    ----------
    .. [1] A. P. Dempster, N. M. Laird, D. B. Rubin, Journal of the Royal Statistical Society B 39,
       1977, pp. 1-22.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> H = rng.normal(size=(200, 2, 2))
    >>> rest = 0.1 * np.einsum("kij,kj->ki", H, rng.normal(size=(200, 2)))
    >>> levels, angle = estimated_angle_noise(rest, H, np.ones(2))
    >>> round(angle, 2), bool(levels.max() < 0.03)
    (0.09, True)
    """
    n = rest.shape[1]
    square = stiffness @ stiffness.transpose(0, 2, 1)
    if not square.any():
        return levels, 0.0
    plain = np.maximum(levels**2, 1e-30)
    noise, angle = plain / 2.0, float(np.sum(plain) / 2.0 / np.mean(np.trace(square.T)) + 1e-300)
    for _ in range(ROUNDS):
        inverse = np.linalg.inv(angle * square + noise * np.eye(n))
        weighted = np.einsum("kij,kj->ki", inverse, rest)
        diagonal = np.einsum("kii->ki", inverse)
        leaning = np.einsum("kji,kj->ki", stiffness, weighted)
        spread = np.einsum("kij,kij->k", inverse, square)
        angle *= 1.0 + angle * float(np.mean(np.sum(leaning**2, axis=1) - spread)) / n
        noise = noise * (1.0 + noise * np.mean(weighted**2 - diagonal, axis=0))
        noise = np.maximum(noise, LEAST_NOISE * plain)
    better = _log_likelihood(rest, angle * square + noise * np.eye(n))
    if better - _log_likelihood(rest, np.broadcast_to(plain * np.eye(n), square.shape)) < CLEAR:
        return levels, 0.0
    return np.sqrt(noise), float(np.sqrt(angle))


def noise_left(
    rest: Array, leverage: Array, weights: Array, stiffness: Array
) -> tuple[Array, float]:
    """Noise of torques, of every joint its own, and of angles, both unknown, that a fit leaves.

    Parameters
    ----------
    rest, leverage, weights
        As of `estimated_levels`.
    stiffness : (m, n, n) array
        As of `estimated_angle_noise`.

    Returns
    -------
    levels : (n,) array
        [N m].
    angle : float
        [rad].
    """
    levels = estimated_levels(rest, leverage, weights)
    kept = np.maximum(1.0 - leverage.mean(axis=0), 1.0 / len(leverage))
    step = max(1, len(leverage) // ENOUGH)
    return estimated_angle_noise((rest / np.sqrt(kept))[::step], stiffness[::step], levels)


def whitening_of(levels: Array, leaning: Array | None, weights: Array) -> Array:
    """Lower triangular W (m, n, n): errors of a sample, times W, are independent of size 1.

    Parameters
    ----------
    levels : (n,) array
        Standard deviation of the torque errors, all above 0 [N m].
    leaning : (m, n, k) array or None
        Torques [N m] for one standard deviation of each error of the angles.
    weights : (m,) array
        Of the squared errors of the samples.

    Examples
    --------
    >>> whitening_of(np.array([0.1, 0.2]), None, np.array([1.0, 4.0]))[1].tolist()
    [[20.0, 0.0], [0.0, 10.0]]
    """
    m, n = len(weights), len(levels)
    if leaning is None or not leaning.any():
        result = np.broadcast_to(np.diag(1.0 / levels), (m, n, n))
    else:
        covariance = leaning @ leaning.transpose(0, 2, 1)
        covariance[:, np.arange(n), np.arange(n)] += levels**2
        result = np.linalg.inv(np.linalg.cholesky(covariance))
    return np.asarray(result * np.sqrt(weights)[:, None, None])


def _log_likelihood(rest: Array, covariance: Array) -> float:
    """Of normal residuals (m, n) with covariances (m, n, n), but for a constant."""
    root = np.linalg.cholesky(covariance)
    whitened = np.linalg.solve(root, rest[:, :, None])
    size = np.log(np.einsum("kii->ki", root)).sum()
    return float(-0.5 * np.sum(whitened**2) - size)
