"""Symmetric copies of a configuration, as an exported model computes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates

Array = NDArray[np.float64]
TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Copies:
    """Points ``y_g = A_g B q + d_g`` and the signs with which their torques count.

    Attributes
    ----------
    linear : (G, r, n) array
        A_g B.
    offset : (G, r) array
        d_g [rad].
    signs : (G, k) array
        Y_g.
    wrapped : bool
        Whether copies are brought to [-pi, pi), for models that are not periodic by themselves.
    """

    linear: Array
    offset: Array
    signs: Array
    wrapped: bool = False

    @classmethod
    def of_group(cls, group: SymmetryCoordinates, outputs: int, wrapped: bool = False) -> Copies:
        """All copies under a learner's group; signs 1 where outputs are not one per joint."""
        joints = group.basis.shape[1]
        signs = group.Y if outputs == joints else np.ones((group.order, outputs))
        return cls(group.A_sat @ group.basis, group.d_sat, signs, wrapped)

    @classmethod
    def plain(cls, basis: Array, outputs: int, wrapped: bool = False) -> Copies:
        """Nothing but ``y = B q``."""
        return cls(basis[None], np.zeros((1, len(basis))), np.ones((1, outputs)), wrapped)

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.linear.shape[2]

    @property
    def outputs(self) -> int:
        """Number of torques k."""
        return self.signs.shape[1]

    @property
    def rank(self) -> int:
        """Number of coordinates r."""
        return self.linear.shape[1]

    def of(self, space: Space, q: Any) -> list[tuple[Any, Any]]:
        """Copies (r, 1) of a configuration (n, 1) and their signs (k, 1)."""
        points = []
        for A, d, signs in zip(self.linear, self.offset, self.signs, strict=True):
            y = space.constant(A) @ q + space.constant(d)
            points.append((wrap(space, y) if self.wrapped else y, space.constant(signs)))
        return points

    def c_source(self, tables: Tables) -> str:
        """A function ``copy_of(g, q, y)``, g < SUMMED, that returns the row of SIGN."""
        tables.number("SUMMED", len(self.linear))
        tables.number("RANK", self.rank)
        tables.add("LINEAR", self.linear)
        tables.add("OFFSET", self.offset)
        tables.add("SIGN", self.signs)
        wrapping = ""
        if self.wrapped:
            tables.value("TURN", TURN)
            wrapping = "\n        y[i] -= TURN * floor(y[i] / TURN + 0.5);"
        return f"""
/* Coordinates y of symmetric copy g of q [rad]; returns its row of SIGN. */
static int copy_of(int g, const double *q, double *y)
{{
    int i, j;
    for (i = 0; i < RANK; i++) {{
        y[i] = OFFSET[g][i];
        for (j = 0; j < JOINTS; j++)
            y[i] += LINEAR[g][i][j] * q[j];{wrapping}
    }}
    return g;
}}
"""


def wrap(space: Space, y: Any) -> Any:
    """Angles modulo 2 pi in [-pi, pi)."""
    half = space.constant(np.full(y.shape, 0.5))
    return y - TURN * space.floor(y / TURN + half)
