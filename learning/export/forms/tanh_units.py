"""Torques of a network with one hidden layer of tanh units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.export.forms.canonical_copy import (
    CanonicalCopy,
    copies_from_arrays,
    copies_to_arrays,
)
from isotorque.learning.export.forms.symmetric_copies import Copies

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TanhUnits:
    """``tau = mean over copies y of Y (V tanh(W x(y) + b) + c)``.

    Attributes
    ----------
    copies : Copies or CanonicalCopy
        What the network is shown.
    periodic : bool
        Whether its inputs x are cos y, sin y or y / pi.
    hidden : (H, f + 1) array
        W and b.
    output : (k, H + 1) array
        V and c [N m].
    """

    copies: Copies | CanonicalCopy
    periodic: bool
    hidden: Array
    output: Array

    KIND: ClassVar[str] = "tanh units"
    FORMULA: ClassVar[str] = (
        "tau = mean over copies y of signs * (output [tanh(hidden [x, 1]), 1]), "
        "x = [cos y, sin y] if periodic else y / pi"
    )

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.copies.joints

    @property
    def outputs(self) -> int:
        """Number of torques k."""
        return len(self.output)

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (k, 1) [N m] at a configuration (n, 1) [rad]."""
        one = space.constant([[1.0]])
        W, V = space.constant(self.hidden), space.constant(self.output)
        points = self.copies.of(space, q)
        total = space.constant(np.zeros(self.outputs))
        for y, signs in points:
            x = [space.cos(y), space.sin(y)] if self.periodic else [y / np.pi]
            units = space.tanh(W @ space.above([*x, one]))
            total = total + signs * (V @ space.above([units, one]))
        return total / len(points)

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        tables.number("JOINTS", self.outputs)
        tables.number("UNITS", len(self.hidden))
        tables.number("INPUTS", self.hidden.shape[1] - 1)
        tables.add("HIDDEN", self.hidden)
        tables.add("OUTPUT", self.output)
        if not self.periodic:
            tables.value("HALF_TURN", np.pi)
        inputs = C_CIRCLES if self.periodic else C_ANGLES
        copies = self.copies.c_source(tables)
        return tables.source() + "\n" + copies + C_SOURCE.replace("@INPUTS@", inputs)

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        return {
            **copies_to_arrays(self.copies),
            "periodic": np.array(self.periodic),
            "hidden": self.hidden,
            "output": self.output,
        }

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> TanhUnits:
        """The form with these tables."""
        copies = copies_from_arrays(arrays)
        return cls(copies, bool(arrays["periodic"]), arrays["hidden"], arrays["output"])


C_CIRCLES = """x[i] = cos(y[i]);
            x[RANK + i] = sin(y[i]);"""
C_ANGLES = "x[i] = y[i] / HALF_TURN;"

C_SOURCE = """
void isotorque_gravity(const double *q, double *tau)
{
    double torque[JOINTS] = {0.0}, value[JOINTS], y[RANK], x[INPUTS], unit;
    int g, h, i, row;
    for (g = 0; g < SUMMED; g++) {
        row = copy_of(g, q, y);
        for (i = 0; i < RANK; i++) {
            @INPUTS@
        }
        for (i = 0; i < JOINTS; i++)
            value[i] = OUTPUT[i][UNITS];
        for (h = 0; h < UNITS; h++) {
            unit = HIDDEN[h][INPUTS];
            for (i = 0; i < INPUTS; i++)
                unit += HIDDEN[h][i] * x[i];
            unit = tanh(unit);
            for (i = 0; i < JOINTS; i++)
                value[i] += OUTPUT[i][h] * unit;
        }
        for (i = 0; i < JOINTS; i++)
            torque[i] += SIGN[row][i] * value[i];
    }
    for (i = 0; i < JOINTS; i++)
        tau[i] = torque[i] / SUMMED;
}
"""
