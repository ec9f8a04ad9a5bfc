"""A chain fitted to samples whose errors are correlated from pose to pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_search import orthonormal, stepped
from isotorque.learning.learners.rigid.planning.information import Information

Array = NDArray[np.float64]

ITERATIONS = 60
PROGRESS = 1e-6
"""The fit ends when a step lowers the cost by a smaller share."""
TRIES = 8
"""Dampings tried for one step, each ten times the last."""


@dataclass(frozen=True, eq=False)
class CorrelatedSamples:
    """Samples and what makes their errors independent.

    Attributes
    ----------
    q, torque : (m, n) arrays
        [rad], [N m].
    whitening : (n, m, m) array
        Of every joint: errors of all samples, times it, are independent of size 1.
    """

    q: Array
    torque: Array
    whitening: Array

    def part(self, rows: NDArray) -> CorrelatedSamples:
        """Some of the samples: a mask. Valid as their own covariances are parts of the whole."""
        covariance = np.linalg.inv(self.whitening)
        covariance = covariance @ covariance.transpose(0, 2, 1)
        kept = covariance[:, rows][:, :, rows]
        whitening = np.linalg.inv(np.linalg.cholesky(kept))
        return CorrelatedSamples(self.q[rows], self.torque[rows], whitening)

    def whitened(self, values: Array) -> Array:
        """Values (m, n, ...) of samples and joints times the whitening, (n m, ...)."""
        by_joint = np.einsum("jab,bj...->ja...", self.whitening, values)
        return np.asarray(by_joint.reshape(-1, *values.shape[2:]))

    def cost(self, chain: ChainParameters) -> float:
        """Sum of squares of whitened errors."""
        return float(np.sum(self.whitened(self.torque - chain.torque(self.q)) ** 2))

    def design(self, chain: ChainParameters, free: NDArray[np.bool_]) -> Array:
        """Whitened derivatives by the free parameters, (n m, p)."""
        slopes = chain.derivatives(self.q, raw_directions(chain.n)).by_parameters()
        return self.whitened(slopes[:, :, free])

    def information(self, chain: ChainParameters, free: NDArray[np.bool_]) -> Information:
        """What the samples tell about the free parameters."""
        return Information.of_rows(self.design(chain, free), free)


def correlated_fit(
    samples: CorrelatedSamples,
    start: ChainParameters,
    free: NDArray[np.bool_],
    iterations: int = ITERATIONS,
) -> tuple[ChainParameters, float]:
    """The chain of least cost that a start leads to, and its cost.

    Parameters
    ----------
    samples
        Samples with the whitening of every joint.
    start
        A chain with levers.
    free : (P,) bool array
        Which of turns, levers, gains, coefficients may change.
    iterations
        Steps at most.

    Notes
    -----
    Generalised least squares by the method of Levenberg and Marquardt on all parameters at once.
    The compiled fit takes errors that are independent from pose to pose, and eliminates the levers;
    this one starts where that one ended.
    """
    chain, cost, damping = start, samples.cost(start), 1e-3
    directions = raw_directions(chain.n)
    for _ in range(iterations):
        rows = samples.design(chain, free)
        rest = samples.whitened(samples.torque - chain.torque(samples.q))
        size = np.linalg.norm(rows, axis=0)
        scale = np.maximum(size, 1e-9 * size.max(initial=0.0) + np.finfo(float).tiny ** 0.5)
        rows = rows / scale
        normal, against, before = rows.T @ rows, rows.T @ rest, cost
        for _ in range(TRIES):
            step = np.zeros(len(free))
            step[free] = np.linalg.solve(normal + damping * np.eye(len(normal)), against) / scale
            moved = stepped(chain, directions, step)
            moved_cost = samples.cost(moved)
            if moved_cost < cost:
                chain, cost, damping = moved, moved_cost, max(damping / 10.0, 1e-9)
                break
            damping *= 10.0
        if not cost < (1.0 - PROGRESS) * before:
            break
    return orthonormal(chain), cost
