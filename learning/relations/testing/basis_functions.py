"""Torque fields that need not come from rigid gravity, as linear combinations of functions of q."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
HARMONICS = 2


@dataclass(frozen=True, eq=False)
class Functions:
    """Values and derivatives of p functions at N configurations.

    Attributes
    ----------
    values : (N, p) array
    slopes : (N, p, n) array
        Derivatives by the joints [1 / rad].
    """

    values: Array
    slopes: Array

    def combined(self, weights: Array) -> Functions:
        """Linear combinations with the columns of ``weights`` (p, p')."""
        slopes = np.einsum("Npn,pk->Nkn", self.slopes, weights, optimize=True)
        return Functions(self.values @ weights, slopes)

    def beside(self, other: Functions) -> Functions:
        """Both, one after the other."""
        return Functions(
            np.concatenate([self.values, other.values], axis=1),
            np.concatenate([self.slopes, other.slopes], axis=1),
        )


def waves(q: Array, frequencies: NDArray[np.int64]) -> Functions:
    """All cos(k.q), then all sin(k.q), for the rows k of ``frequencies`` (m, n).

    Examples
    --------
    >>> found = waves(np.array([[0.0, np.pi]]), np.array([[1, 1]]))
    >>> found.values.round(6).tolist(), found.slopes.round(6).tolist()
    ([[-1.0, 0.0]], [[[-0.0, -0.0], [-1.0, -1.0]]])
    """
    phase = q @ frequencies.T
    cos, sin = np.cos(phase), np.sin(phase)
    slopes = np.concatenate([-sin[:, :, None] * frequencies, cos[:, :, None] * frequencies], axis=1)
    return Functions(np.concatenate([cos, sin], axis=1), slopes)


def angles(q: Array) -> Functions:
    """The angles q (N, n) themselves, not wrapped [rad]."""
    return Functions(
        q.copy(), np.array(np.broadcast_to(np.eye(q.shape[1]), (*q.shape, q.shape[1])))
    )


def breaking_functions(q: Array) -> Functions:
    """What usually breaks symmetries: constants, angles themselves, harmonics of every joint.

    Parameters
    ----------
    q : (N, n) array
        Configurations as they are, not wrapped [rad].

    Returns
    -------
    Functions
        1 (cables, friction that always pulls one way), q_j (springs), and cos(h q_j), sin(h q_j)
        for h up to 2 (bent links, springs that act through levers).
    """
    count, n = q.shape
    constant = Functions(np.ones((count, 1)), np.zeros((count, 1, n)))
    turns = np.concatenate([h * np.eye(n, dtype=np.int64) for h in range(1, HARMONICS + 1)])
    return constant.beside(angles(q)).beside(waves(q, turns))
