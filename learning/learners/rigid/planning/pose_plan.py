"""The poses that tell most about a chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
POWER = 4
"""Variances to this power are added up: a maximum that notices the second largest too."""
EXCHANGES = 1
"""Rounds in which each chosen pose may be exchanged for a better one."""


@dataclass(frozen=True, eq=False)
class PosePlan:
    """Poses to measure next, in this order.

    Attributes
    ----------
    poses : (k, n) array
        [rad].
    before : float
        Largest standard error of any torque in the region without them [N m].
    expected : (k,) array
        The same after each of them.
    """

    poses: Array
    before: float
    expected: Array


@single_thread()
def plan_poses(
    chain: ChainParameters,
    free: Mask,
    seen: ChainSamples,
    candidates: Array,
    region: Array,
    count: int,
    within: float = 0.0,
) -> PosePlan:
    """Choose poses that lower the largest standard error of the torque most, one by one.

    Parameters
    ----------
    chain : ChainParameters
        What is known: derivatives are taken there.
    free : (P,) bool array
        Which of its parameters are unknown (`Information`).
    seen : ChainSamples
        Samples that there are already (maybe none), and the noise of those to come.
    candidates : (c, n) array
        Poses to choose from [rad].
    region : (m, n) array
        Poses at which the torque is to be known [rad].
    count : int
        Poses at most.
    within : float
        Enough: three standard errors of any torque in the region [N m].

    Notes
    -----
    What no sample has told yet is taken to be as unknown as a rad, or as the largest torque, so
    that a plan can begin with nothing. Each candidate's effect on the covariance is exact for the
    linearised chain (Woodbury's formula).

    Raises
    ------
    InputError
        If there is nothing to choose from.

    Examples
    --------
    A pendulum measured where it hangs, told to look where it does not:

    >>> sideways = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]]
    >>> pendulum = ChainParameters.of(sideways, [[6.0, 0.0]])
    >>> q, one = np.array([[-1.5], [-1.6]]), np.ones(1)
    >>> seen = ChainSamples(q, pendulum.torque(q), 0.1 * one, 0.0 * one, np.ones(2))
    >>> choice = np.array([[-1.55], [0.0], [1.6]])
    >>> free = np.array([True] * 4 + [False])
    >>> plan_poses(pendulum, free, seen, choice, choice, 1).poses.tolist()
    [[0.0]]
    """
    if not len(candidates) or not len(region):
        raise InputError("plan", "poses to choose from", 0, "at least one")
    covariance = _prior(chain, free, seen)
    if len(seen.q):
        rows = _rows(chain, free, seen, seen.q)
        covariance = np.asarray(np.linalg.inv(np.linalg.inv(covariance) + rows.T @ rows))
    n, p = chain.n, int(free.sum())
    offered = _rows(chain, free, seen, candidates).reshape(len(candidates), n, p)
    slopes = chain.derivatives(region, raw_directions(n)).by_parameters()[:, :, free].reshape(-1, p)
    variance = _variances(slopes, covariance)
    before = float(np.sqrt(variance.max()))
    chosen: list[int] = []
    expected: list[float] = []
    start = covariance
    while len(chosen) < count and 3.0 * np.sqrt(variance.max()) > within:
        best = _most_telling(covariance, offered, slopes)
        chosen.append(best)
        covariance = _lowered(covariance, offered[best])
        for _ in range(EXCHANGES):
            changed = False
            for k in range(len(chosen)):
                others = start
                for c in (*chosen[:k], *chosen[k + 1 :]):
                    others = _lowered(others, offered[c])
                best = _most_telling(others, offered, slopes)
                changed |= best != chosen[k]
                chosen[k] = best
                covariance = _lowered(others, offered[best])
            if not changed:
                break
        variance = _variances(slopes, covariance)
        expected.append(float(np.sqrt(variance.max())))
    return PosePlan(candidates[chosen].reshape(-1, n), before, np.array(expected))


def _variances(slopes: Array, covariance: Array) -> Array:
    return np.maximum(np.sum((slopes @ covariance) * slopes, axis=1), 0.0)


def _most_telling(covariance: Array, offered: Array, slopes: Array) -> int:
    """The candidate after which the largest variances are least."""
    across = slopes @ covariance
    variance = np.sum(across * slopes, axis=1)
    best, least = -1, np.inf
    for c, row in enumerate(offered):
        factor = np.linalg.cholesky(np.eye(len(row)) + row @ covariance @ row.T)
        lowered = np.linalg.solve(factor, row @ across.T)
        after = np.maximum(variance - np.sum(lowered**2, axis=0), 0.0)
        value = float(np.sum(after**POWER))
        if value < least:
            best, least = c, value
    return best


def _lowered(covariance: Array, row: Array) -> Array:
    """The covariance after one more sample (Woodbury's formula)."""
    gain = covariance @ row.T
    return np.asarray(covariance - gain @ np.linalg.solve(np.eye(len(row)) + row @ gain, gain.T))


def _prior(chain: ChainParameters, free: Mask, seen: ChainSamples) -> Array:
    n = chain.n
    size = max(float(np.abs(chain.levers).max()), seen.largest_torque, 1e-9)
    scale = np.ones(len(free))
    scale[2 * n : 4 * n] = size
    scale[5 * n :] = size
    return np.diag(scale[free] ** 2)


def _rows(chain: ChainParameters, free: Mask, like: ChainSamples, q: Array) -> Array:
    """Whitened derivatives (m n, p) of samples at q with the noise of others."""
    samples = ChainSamples(q, chain.torque(q), like.torque_noise, like.angle_noise, np.ones(len(q)))
    slopes = chain.derivatives(q, raw_directions(chain.n)).by_parameters()[:, :, free]
    return (samples.whitening(chain) @ slopes).reshape(samples.equations, -1)
