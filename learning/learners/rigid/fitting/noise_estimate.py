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
from isotorque.learning.statistics.noise_levels import estimated_levels

Array = NDArray[np.float64]

FOLDS = 10
"""Parts that are left out in turn."""


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
    leaning = slopes.stiffness * samples.angle_noise
    levels = estimated_levels(rest, leverage, samples.weights, leaning)
    noisy = samples.with_torque_noise(levels)
    again = search(noisy, found.chain, model.free_gains, warm=True)
    return again, noisy


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
