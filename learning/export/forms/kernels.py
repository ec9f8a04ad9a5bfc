"""Torques as sums of covariances: the mean of a Gaussian process, averaged over a group."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.export.forms.canonical_copy import copies_from_arrays, copies_to_arrays
from isotorque.learning.export.forms.symmetric_copies import Copies
from isotorque.learning.export.forms.waves import Waves

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Kernels:
    """``tau_j = sum over i of w_ij sum over copies y of Y_j exp((x(y).c_i - r) / l_j^2)``.

    Attributes
    ----------
    copies : Copies
        y.
    rows : (a, r) array
        Combinations of y that are put on circles.
    radii : (a,) array
        Radii of the circles; their squares sum to r: x(y) is radii times cosines, then sines.
    centres : (m, 2 a) array
        c_i: x of the samples.
    weights : (m, k) array
        w [N m].
    lengths : (k,) array
        l [rad].
    waves : Waves
        What is added: means of long length scale (w = 0), as sums of covariances cancel there.
    """

    copies: Copies
    rows: Array
    radii: Array
    centres: Array
    weights: Array
    lengths: Array
    waves: Waves

    KIND: ClassVar[str] = "kernels"
    FORMULA: ClassVar[str] = (
        "tau_j = sum_i weights_ij sum over copies y of signs_j exp((x.centres_i - r) / lengths_j^2)"
        ", x = [radii cos(rows y), radii sin(rows y)]; plus the waves"
    )

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.copies.joints

    @property
    def outputs(self) -> int:
        """Number of torques k."""
        return len(self.lengths)

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (k, 1) [N m] at a configuration (n, 1) [rad]."""
        rows, radii = space.constant(self.rows), space.constant(self.radii)
        centres = space.constant(self.centres)
        rank = space.constant(np.full(len(self.centres), float(self.copies.rank)))
        covariances: list[Any] = [0.0] * self.outputs
        for y, signs in self.copies.of(space, q):
            phase = rows @ y
            x = space.above([radii * space.cos(phase), radii * space.sin(phase)])
            exponent = centres @ x - rank
            for j, length in enumerate(self.lengths):
                value = space.exp(exponent / float(length) ** 2)
                covariances[j] = covariances[j] + value @ signs[j : j + 1, :]
        summed = [
            space.constant(self.weights[:, j][None]) @ column
            for j, column in enumerate(covariances)
        ]
        return space.above(summed) + self.waves.torque(space, q)

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        tables.number("JOINTS", self.outputs)
        tables.number("CIRCLES", len(self.rows))
        tables.number("CENTRES", len(self.centres))
        tables.add("ROW", self.rows)
        tables.add("RADIUS", self.radii)
        tables.add("LENGTH", self.lengths)
        tables.add("CENTRE", self.centres)
        tables.add("WEIGHT", self.weights)
        copies = self.copies.c_source(tables)
        waves = self.waves.c_function(tables)
        return tables.source() + "\n" + copies + waves + C_SOURCE

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        own = ("rows", "radii", "centres", "weights", "lengths")
        tables = {name: getattr(self, name) for name in own}
        return copies_to_arrays(self.copies) | tables | self.waves.to_arrays()

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> Kernels:
        """The form with these tables."""
        copies = copies_from_arrays(arrays)
        assert isinstance(copies, Copies)
        own = ("rows", "radii", "centres", "weights", "lengths")
        tables = {name: arrays[name] for name in own}
        return cls(copies, **tables, waves=Waves.from_arrays(arrays))


C_SOURCE = """
void isotorque_gravity(const double *q, double *tau)
{
    double torque[JOINTS] = {0.0}, covariance[JOINTS], y[RANK], x[SUMMED][2 * CIRCLES];
    double phase, exponent;
    int a, c, g, i, row[SUMMED];
    for (g = 0; g < SUMMED; g++) {
        row[g] = copy_of(g, q, y);
        for (a = 0; a < CIRCLES; a++) {
            phase = 0.0;
            for (i = 0; i < RANK; i++)
                phase += ROW[a][i] * y[i];
            x[g][a] = RADIUS[a] * cos(phase);
            x[g][CIRCLES + a] = RADIUS[a] * sin(phase);
        }
    }
    for (c = 0; c < CENTRES; c++) {
        for (i = 0; i < JOINTS; i++)
            covariance[i] = 0.0;
        for (g = 0; g < SUMMED; g++) {
            exponent = -RANK;
            for (a = 0; a < 2 * CIRCLES; a++)
                exponent += CENTRE[c][a] * x[g][a];
            for (i = 0; i < JOINTS; i++)
                covariance[i] += SIGN[row[g]][i] * exp(exponent / (LENGTH[i] * LENGTH[i]));
        }
        for (i = 0; i < JOINTS; i++)
            torque[i] += WEIGHT[c][i] * covariance[i];
    }
    add_waves(q, torque);
    for (i = 0; i < JOINTS; i++)
        tau[i] = torque[i];
}
"""
