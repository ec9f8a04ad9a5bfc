"""What a set of poses would leave unknown of the torque over a region."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

NEIGHBOURS = 3
"""So many chains near the one that is known are planned for, together, ..."""
TILT, SHARE = 0.05, 0.02
"""... axes turned by so much [rad] and levers changed by this share of the largest (normal)."""
DIFFERENCE = 1e-6
"""Step of the derivatives by the poses [rad]."""
AT_ONCE = 50
"""Candidates looked at in one matrix product."""


@dataclass(frozen=True, eq=False)
class PoseDesign:
    """A chain that is known roughly, and the region in which its torque is to be known.

    Attributes
    ----------
    chains : tuple of ChainParameters
        Chains at which derivatives are taken.
    free : (P,) bool array
        Which of their parameters are unknown (`Information`).
    like : ChainSamples
        Samples with the noise of those to come.
    slopes : tuple of (m n, p) arrays
        Derivatives of the torques over the region, of every chain.
    known : tuple of (p, p) arrays
        Information before any pose is added, of every chain.

    Notes
    -----
    Where axes are parallel or vertical exactly, the chain is singular and its derivatives say that
    some of its numbers do not matter, though errors of theirs do (to second order). So a design is
    made for a few neighbours of the chain, all in one: on the ur5 that is worth 1 to 3 poses of 8
    to 15, elsewhere nothing is lost.

    What no sample has told yet is taken to be as unknown as a rad, or as the largest torque, so
    that a design can begin with nothing.

    References
    ----------
    Chaloner, Verdinelli, Bayesian experimental design, Statistical Science 10, 1995: designs for
    a distribution of parameters.
    """

    chains: tuple[ChainParameters, ...]
    free: Mask
    like: ChainSamples
    slopes: tuple[Array, ...]
    known: tuple[Array, ...]

    @classmethod
    def of(
        cls, chain: ChainParameters, free: Mask, seen: ChainSamples, region: Array
    ) -> PoseDesign:
        """From the chain that is known, samples there are already, and poses (m, n) of a region."""
        chains = neighbours(chain)
        slopes = [
            c.derivatives(region, raw_directions(c.n)).by_parameters()[:, :, free] for c in chains
        ]
        flat = tuple(s.reshape(-1, s.shape[2]) for s in slopes)
        nothing = tuple(_vague(c, free, seen) for c in chains)
        design = cls(chains, free, seen, flat, nothing)
        if not len(seen.q):
            return design
        rows = [design._rows(k, seen.q, seen.weights).reshape(-1, len(x)) for k, x in design._all]
        return replace(design, known=tuple(x + r.T @ r for x, r in zip(nothing, rows, strict=True)))

    @property
    def _all(self) -> list[tuple[int, Array]]:
        return list(enumerate(self.known))

    def rows(self, poses: Array) -> tuple[Array, ...]:
        """Whitened derivatives (m, n, p) of samples at poses (m, n), of every chain."""
        return tuple(self._rows(k, poses) for k, _ in self._all)

    def covariances(self, rows: Sequence[Array]) -> tuple[Array, ...]:
        """Of the parameters of every chain (p, p), poses with such rows (m, n, p) added."""
        found = []
        for known, row in zip(self.known, rows, strict=True):
            flat = row.reshape(-1, len(known))
            found.append(np.asarray(np.linalg.inv(known + flat.T @ flat)))
        return tuple(found)

    def largest_error(self, covariances: Sequence[Array]) -> float:
        """Largest standard error of a torque in the region [N m], geometric mean of the chains."""
        largest = [
            np.sum((s @ c) * s, axis=1).max() for s, c in zip(self.slopes, covariances, strict=True)
        ]
        return float(np.exp(0.5 * np.mean(np.log(np.maximum(largest, np.finfo(float).tiny)))))

    def after_each(
        self, covariances: Sequence[Array], offered: Sequence[Array], power: float
    ) -> Array:
        """Criterion after each of the offered samples, rows (c, n, p), (c,): `value_and_slope`."""
        count = len(offered[0])
        result = np.zeros(count)
        for slopes, covariance, rows in zip(self.slopes, covariances, offered, strict=True):
            variance = np.sum((slopes @ covariance) * slopes, axis=1)
            largest = max(float(variance.max()), np.finfo(float).tiny)
            for begin in range(0, count, AT_ONCE):
                row = rows[begin : begin + AT_ONCE]
                across = row @ covariance
                gram = across @ row.transpose(0, 2, 1) + np.eye(row.shape[1])
                # Woodbury's formula: the variances fall by the squares of these
                gained = np.linalg.solve(np.linalg.cholesky(gram), across) @ slopes.T
                after = np.maximum(variance - np.sum(gained**2, axis=1), 0.0) / largest
                level = np.mean(after**power, axis=1) ** (1.0 / power)
                result[begin : begin + AT_ONCE] += np.log(largest * np.maximum(level, 1e-300))
        return result / len(self.chains)

    def value_and_slope(self, poses: Array, power: float) -> tuple[float, Array]:
        """Criterion of poses (m, n), and its derivatives (m, n) by them.

        The logarithm of the power mean of all variances of torques in the region, mean over the
        chains: power 1 is the mean variance, a high power nearly the largest.
        """
        m, n = poses.shape
        moved = [poses, *(poses + DIFFERENCE * np.eye(n)[i] for i in range(n))]
        total, slope = 0.0, np.zeros((m, n))
        for k, known in self._all:
            p, s = len(known), self.slopes[k]
            rows = self._rows(k, np.concatenate(moved)).reshape(n + 1, m, n, p)
            flat = rows[0].reshape(m * n, p)
            across = s @ np.linalg.inv(known + flat.T @ flat)
            variance = np.maximum(np.sum(across * s, axis=1), np.finfo(float).tiny)
            largest = float(variance.max())
            share = variance / largest
            level = float(np.mean(share**power))
            total += np.log(largest) + np.log(level) / power
            # d log = sum of weights times the change of each variance, -2 s C R^T dR C s
            weights = share ** (power - 1.0) / (level * largest * len(share))
            pulled = (flat @ ((across * weights[:, None]).T @ across)).reshape(m, n, p)
            change = (rows[1:] - rows[0]) / DIFFERENCE
            slope -= 2.0 * np.sum(pulled * change, axis=(2, 3)).T
        return total / len(self.chains), slope / len(self.chains)

    def _rows(self, k: int, q: Array, weights: Array | None = None) -> Array:
        """Whitened derivatives (m, n, p) at q of one chain, with the noise of other samples."""
        chain, like = self.chains[k], self.like
        weight = np.ones(len(q)) if weights is None else weights
        samples = ChainSamples(q, like.torque, like.torque_noise, like.angle_noise, weight)
        slopes = chain.derivatives(q, raw_directions(chain.n)).by_parameters()[:, :, self.free]
        if not like.angle_noise.any():  # the same everywhere
            scale = 1.0 / np.maximum(like.torque_noise, samples.floor)
            return np.asarray(slopes * scale[:, None] * np.sqrt(weight)[:, None, None])
        return np.asarray(samples.whitening(chain) @ slopes)


def neighbours(chain: ChainParameters, count: int = NEIGHBOURS) -> tuple[ChainParameters, ...]:
    """Chains near one, the same ones each time."""
    rng, n = np.random.default_rng(20143), chain.n
    size = float(np.abs(chain.levers).max(initial=0.0))
    found = []
    for _ in range(count):
        turns = Rotation.from_rotvec(TILT * rng.normal(size=(n, 3))).as_matrix()
        levers = chain.levers + SHARE * size * rng.normal(size=(n, 2))
        found.append(
            replace(chain, rotations=np.ascontiguousarray(chain.rotations @ turns), levers=levers)
        )
    return tuple(found)


def _vague(chain: ChainParameters, free: Mask, seen: ChainSamples) -> Array:
    """Information (p, p) of knowing that numbers are within a rad, or the largest torque."""
    n = chain.n
    size = max(float(np.abs(chain.levers).max()), seen.largest_torque, 1e-9)
    scale = np.ones(len(free))
    scale[2 * n : 4 * n] = size
    scale[5 * n :] = size
    return np.diag(scale[free] ** -2.0)
