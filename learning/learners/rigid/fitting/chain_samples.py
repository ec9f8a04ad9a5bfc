"""Static samples of an arm and the noise they were measured with."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.statistics.noise_levels import whitening_of
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

FLOOR = 1e-11
"""Least standard deviation of a torque, relative to the largest torque: rounding."""
LEAST_FLOOR = 1e-15
"""The same where all torques are zero or rounding [N m]."""


@dataclass(frozen=True, eq=False)
class ChainSamples:
    """Configurations at rest, the torques that held them, and standard deviations of both.

    Attributes
    ----------
    q, torque : (m, n) arrays
        [rad], [N m].
    torque_noise : (n,) array
        Standard deviation of the torque error of every joint [N m].
    angle_noise : (n,) array
        Standard deviation of the angle error of every joint [rad].
    weights : (m,) array
        Weight of the squared errors of every sample, positive.
    """

    q: Array
    torque: Array
    torque_noise: Array
    angle_noise: Array
    weights: Array

    def __post_init__(self) -> None:
        """Lay out q and torque row by row: the search is compiled anew for any other layout."""
        for name in ("q", "torque"):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name)))

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.q.shape[1]

    @property
    def equations(self) -> int:
        """Number of measured torques."""
        return self.torque.size

    @property
    def poses(self) -> int:
        """Number of different configurations."""
        return len(np.unique(self.q.round(9), axis=0))

    @property
    def largest_torque(self) -> float:
        """Of all samples and joints [N m]."""
        return float(np.abs(self.torque).max(initial=0.0))

    @property
    def floor(self) -> float:
        """Standard deviation that stands for rounding [N m]."""
        return max(FLOOR * self.largest_torque, LEAST_FLOOR)

    def whitening(self, chain: ChainParameters | None = None) -> Array:
        """Lower triangular W (m, n, n): errors of a sample, times W, are independent of size 1.

        Parameters
        ----------
        chain : ChainParameters, optional
            Where angles are measured with errors e, torques err by ``H e`` with H the stiffness;
            without a chain H is guessed from the size of the torques.
        """
        levels = np.maximum(self.torque_noise, self.floor)
        if not self.angle_noise.any():
            return whitening_of(levels, None, self.weights)
        if chain is None:
            size = np.sqrt(np.mean(self.torque**2, axis=0))
            guess = levels**2 + 2.0 * size**2 * np.max(self.angle_noise) ** 2
            return whitening_of(np.sqrt(guess), None, self.weights)
        return whitening_of(levels, chain.stiffness(self.q) * self.angle_noise, self.weights)

    def with_torque_noise(self, torque_noise: Array) -> ChainSamples:
        """The same samples with other noise levels."""
        return replace(self, torque_noise=torque_noise)

    def part(self, rows: NDArray | slice) -> ChainSamples:
        """Some of the samples: indices, a mask or a slice."""
        return replace(self, q=self.q[rows], torque=self.torque[rows], weights=self.weights[rows])


def noise_by_joint(where: str, name: str, value: ArrayLike, joints: int) -> Array:
    """Standard deviations as one number >= 0 per joint.

    Raises
    ------
    InputError
        If it is anything else than a number, or one per joint.
    """
    given = np.asarray(value, dtype=float)
    if given.shape not in ((), (joints,)) or not np.all(np.isfinite(given) & (given >= 0)):
        raise InputError(where, name, value, f"a number >= 0, or {joints} of them")
    return np.ascontiguousarray(np.broadcast_to(given, (joints,)), dtype=float)
