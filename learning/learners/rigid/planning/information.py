"""Information of samples about the parameters of a chain, hence about its torque elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

DEPENDENT = 1e-12
"""Singular values below, relative to the largest, of derivatives scaled to one size."""
OPEN = 1e-6
"""A torque depends on what is not determined if so large a share of its derivative does."""
PROBES = 64


@dataclass(frozen=True, eq=False)
class Information:
    """Derivatives of whitened torques by the free parameters, decomposed.

    Attributes
    ----------
    free : (P,) bool array
        Which of turns, levers, gains, coefficients were free (`ChainDerivatives.by_parameters`).
    scale : (p,) array
        Sizes of the columns.
    values : (p,) array
        Singular values of the scaled derivatives.
    vectors : (p, p) array
        Their right singular vectors, as rows.
    """

    free: Mask
    scale: Array
    values: Array
    vectors: Array

    @classmethod
    def of(cls, chain: ChainParameters, q: Array, whitening: Array, free: Mask) -> Information:
        """At the configurations (m, n) [rad] of samples with a given whitening (m, n, n)."""
        rows = whitening @ chain.derivatives(q, raw_directions(chain.n)).by_parameters()[:, :, free]
        return cls.of_rows(rows.reshape(-1, rows.shape[2]), free)

    @classmethod
    def of_rows(cls, design: Array, free: Mask) -> Information:
        """From whitened derivatives (N, p) by the free parameters."""
        size = np.linalg.norm(design, axis=0)
        scale = np.maximum(size, 1e-9 * size.max(initial=0.0) + np.finfo(float).tiny ** 0.5)
        if len(design) > 2 * design.shape[1]:
            design = np.asarray(np.linalg.qr(design, mode="r"))
        _, values, vectors = np.linalg.svd(design / scale, full_matrices=True)
        padded = np.zeros(len(vectors))
        padded[: len(values)] = values
        return cls(free, scale, padded, vectors)

    @property
    def kept(self) -> Mask:
        """Which singular values are not rounding."""
        return np.asarray(self.values > DEPENDENT * self.values.max(initial=1e-300))

    @property
    def rank(self) -> int:
        """Number of combinations of parameters that the samples determine."""
        return int(np.sum(self.kept))

    @property
    def factor(self) -> Array:
        """L (p, rank) with covariance ``L L^T`` of what is determined."""
        kept = self.kept
        return np.asarray((self.vectors[kept] / self.values[kept][:, None]).T / self.scale[:, None])

    @property
    def null_space(self) -> Array:
        """Changes of the free parameters that no sample notices, as rows."""
        return np.asarray(self.vectors[~self.kept] / self.scale)

    def standard_error(self, chain: ChainParameters, q: Array) -> Array:
        """Of the torques at configurations (m, n) [rad], (m, n) [N m]; inf where undetermined."""
        slopes = chain.derivatives(q, raw_directions(chain.n)).by_parameters()[:, :, self.free]
        return np.sqrt(self.variance(slopes))

    def variance(self, slopes: Array) -> Array:
        """Of quantities with derivatives (..., p) by the free parameters; inf where not known."""
        scaled = slopes / self.scale
        open_part = np.linalg.norm(scaled @ self.vectors[~self.kept].T, axis=-1)
        size = np.linalg.norm(scaled, axis=-1)
        least = OPEN * np.maximum(size, 1e-6 * size.max(initial=0.0))
        known = np.sum((slopes @ self.factor) ** 2, axis=-1)
        return np.where(open_part > least, np.inf, known)


def identifiable_count(chain: ChainParameters, free: Mask) -> int:
    """Number of combinations of parameters that torques anywhere can tell apart.

    Examples
    --------
    Two parallel horizontal axes (planar): 2 n.

    >>> F = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]], np.eye(3)]
    >>> planar = ChainParameters.of(F, [[18.0, 0], [6.0, 0]])
    >>> identifiable_count(planar, parameter_mask(2))
    4
    """
    q = probe_poses(chain.n)
    return Information.of(chain, q, np.tile(np.eye(chain.n), (len(q), 1, 1)), free).rank


def parameter_mask(
    joints: int,
    *,
    free_gains: Mask | None = None,
    columns: int = 0,
) -> Mask:
    """Which parameters are free: all turns and levers, some gains, all coefficients."""
    gains = np.zeros(joints, dtype=bool) if free_gains is None else free_gains
    return np.concatenate([np.ones(4 * joints, bool), gains, np.ones(columns, bool)])


def probe_poses(joints: int) -> Array:
    """Configurations all over the torus, the same ones each time."""
    return np.random.default_rng(20141).uniform(-np.pi, np.pi, (PROBES, joints))
