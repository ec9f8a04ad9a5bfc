"""Torques at single joints that are linear in one unknown: offsets, and what else is added."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ColumnShape(StrEnum):
    """Dependence of a column's torque on the angle of its joint."""

    OFFSET = "offset"
    """Constant: a zero error of the torque sensor. The unknown is in N m."""
    SPRING = "spring"
    """Proportional to the angle. The unknown is in N m/rad."""
    SINE = "sine"
    COSINE = "cosine"
    """Sine and cosine of the angle. The unknowns are in N m."""


FEATURES: dict[ColumnShape, Callable[[Array], Array]] = {
    ColumnShape.OFFSET: np.ones_like,
    ColumnShape.SPRING: lambda angle: angle,
    ColumnShape.SINE: np.sin,
    ColumnShape.COSINE: np.cos,
}

SLOPES: dict[ColumnShape, Callable[[Array], Array]] = {
    ColumnShape.OFFSET: np.zeros_like,
    ColumnShape.SPRING: np.ones_like,
    ColumnShape.SINE: np.cos,
    ColumnShape.COSINE: lambda angle: -np.sin(angle),
}
"""Their derivatives by the angle."""


@dataclass(frozen=True)
class JointColumn:
    """A torque ``x f(q_j)`` that one joint has beside the chain's, x unknown.

    Attributes
    ----------
    joint : int
        j, from 0.
    shape : ColumnShape
        f.
    """

    joint: int
    shape: ColumnShape

    def feature(self, q: Array) -> Array:
        """F of the angles in configurations (m, n) [rad], shape (m,)."""
        return np.asarray(FEATURES[self.shape](q[:, self.joint]))

    def slope(self, q: Array) -> Array:
        """Derivative of `feature` by the angle, shape (m,)."""
        return np.asarray(SLOPES[self.shape](q[:, self.joint]))


def columns_of(joints: int, *shapes: ColumnShape) -> tuple[JointColumn, ...]:
    """A column of each of these shapes at every joint."""
    return tuple(JointColumn(j, shape) for shape in shapes for j in range(joints))


def features(columns: Sequence[JointColumn], q: Array) -> Array:
    """Derivatives of all torques by the unknowns, shape (m, n, p), at q (m, n) [rad].

    Examples
    --------
    >>> features(columns_of(2, ColumnShape.OFFSET), np.zeros((1, 2))).tolist()
    [[[1.0, 0.0], [0.0, 1.0]]]
    """
    result = np.zeros((*q.shape, len(columns)))
    for c, column in enumerate(columns):
        result[:, column.joint, c] = column.feature(q)
    return result
