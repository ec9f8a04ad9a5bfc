"""Noise of every joint where it is not stated, and errors at poses left out of a fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import raw_directions
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import (
    ChainModel,
    SearchedChain,
    minimise,
    search,
)
from isotorque.learning.learners.rigid.planning.information import Information

Array = NDArray[np.float64]

FOLDS = 10
"""Parts that are left out in turn."""
ROUNDS = 60
"""Of expectation and maximisation."""
CLEAR = 4.0
"""Noise of angles is there if the logarithm of the likelihood grows by so much (p = 0.005)."""
LEAST_NOISE = 1e-6
"""Least variance of the torques, relative to that without noise of the angles."""
SHRINKING = 3.0
"""Degrees of freedom with which the noise of all joints counts for the noise of each."""


def with_estimated_noise(
    samples: ChainSamples, found: SearchedChain, model: ChainModel, rounds: int = 3
) -> tuple[ChainSamples, SearchedChain]:
    """Noise of every joint from the residuals, and the chain refitted with it.

    Squares of residuals are divided by what the fit leaves of them (one minus leverage); joints
    with few of them lean on the others.
    """
    for _ in range(rounds):
        found, samples = _reweighted(samples, found, model)
    return samples, found


def _reweighted(
    samples: ChainSamples, found: SearchedChain, model: ChainModel
) -> tuple[SearchedChain, ChainSamples]:
    information = Information.of(found.chain, samples.q, found.whitening, model.free)
    slopes = found.chain.derivatives(samples.q, raw_directions(model.n))
    rows = found.whitening @ slopes.by_parameters()[:, :, model.free]
    leverage = np.sum((rows @ information.factor) ** 2, axis=2)
    rest = samples.torque - slopes.torque
    levels = estimated_levels(samples, rest, leverage, slopes.stiffness)
    noisy = samples.with_torque_noise(levels)
    again = search(noisy, found.chain, model.free_gains, warm=True)
    return again, noisy


def estimated_levels(
    samples: ChainSamples, rest: Array, leverage: Array, stiffness: Array
) -> Array:
    """Standard deviation of the torque error of every joint (n,) [N m], from what a fit leaves.

    Parameters
    ----------
    samples : ChainSamples
        What was fitted.
    rest : (m, n) array
        What the fit leaves [N m].
    leverage : (m, n) array
        Share of each error that the fit takes.
    stiffness : (m, n, n) array
        d torque / d q [N m/rad]: errors of the angles explain a part.
    """
    left = np.maximum(1.0 - leverage, 0.0).sum(axis=0)
    square = (rest**2 * samples.weights[:, None]).sum(axis=0)
    pooled = square.sum() / max(left.sum(), 1e-3)
    variance = (square + SHRINKING * pooled * 1e-2) / (left + SHRINKING * 1e-2 + 1e-3)
    if samples.angle_noise.any():
        leaning = stiffness * samples.angle_noise
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


def _log_likelihood(rest: Array, covariance: Array) -> float:
    """Of normal residuals (m, n) with covariances (m, n, n), but for a constant."""
    root = np.linalg.cholesky(covariance)
    whitened = np.linalg.solve(root, rest[:, :, None])
    size = np.log(np.einsum("kii->ki", root)).sum()
    return float(-0.5 * np.sum(whitened**2) - size)


def held_out_error(samples: ChainSamples, found: SearchedChain, model: ChainModel) -> float:
    """RMS torque error [N m] at poses left out, tenth by tenth; equal poses are left out together.

    Every refit starts from the chain of all samples.
    """
    _, pose = np.unique(samples.q.round(9), axis=0, return_inverse=True)
    poses = int(pose.max()) + 1
    fold = np.random.default_rng(poses).permutation(poses)[pose.ravel()] % min(FOLDS, poses)
    total = 0.0
    for k in range(min(FOLDS, poses)):
        out = fold == k
        kept = samples.part(~out)
        refit = minimise(kept, found.chain, model.free_gains, found.whitening[~out])
        rest = samples.torque[out] - refit.chain.torque(samples.q[out])
        total += float(np.sum(rest**2))
    return float(np.sqrt(total / samples.equations))
