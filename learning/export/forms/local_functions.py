"""Torques blended from local linear functions around prototypes, alone or tied by a group."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.export.forms.canonical_copy import copies_from_arrays, copies_to_arrays
from isotorque.learning.export.forms.symmetric_copies import TURN, Copies, wrap

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LocalFunctions:
    """``tau = sum Y h(x) (o_p + W_p x / radius) / sum h(x)``, over copies and prototypes p.

    Attributes
    ----------
    copies : Copies
        y, wrapped.
    prototypes : (M, r) array
        p [rad].
    isometry : (r, r) array
        L, upper triangular.
    turns : (T, r) int array
        Full turns at which prototypes are seen, none first: x = L (wrap(y - p) - 2 pi turn).
    values : (M, k, 1 + r) array
        o and W [N m].
    radius, kernel, reach : float
        Unit of x; width of ``h(x) = exp(-|x|^2 / kernel^2)``; h is zero beyond reach [rad].

    Notes
    -----
    Where no prototype is in reach of any copy, each copy takes those hardly farther than its
    nearest one: up to reach^2 more in |x|^2.
    """

    copies: Copies
    prototypes: Array
    isometry: Array
    turns: NDArray[np.int64]
    values: Array
    radius: float
    kernel: float
    reach: float

    KIND: ClassVar[str] = "local functions"
    FORMULA: ClassVar[str] = (
        "tau = sum signs h (values_0 + values_1.. x / radius) / sum h over copies y, prototypes, "
        "turns; x = isometry (wrap(y - prototype) - 2 pi turn), h = exp(-|x|^2 / kernel^2) within "
        "reach"
    )

    @classmethod
    def around(
        cls,
        copies: Copies,
        prototypes: Array,
        isometry: Array,
        values: Array,
        radius: float,
        kernel: float,
        reach: float,
        periodic_images: bool,
    ) -> LocalFunctions:
        """The form, with all periodic images within reach or the nearest ones alone."""
        box = reach * np.linalg.norm(np.linalg.inv(isometry), axis=1)
        most = np.floor((box + np.pi) / TURN + 1e-9).astype(int) * periodic_images
        turns = np.array(list(itertools.product(*(range(-m, m + 1) for m in most))), dtype=np.int64)
        turns = turns[np.argsort(np.abs(turns).sum(axis=1), kind="stable")]
        return cls(copies, prototypes, isometry, turns, values, radius, kernel, reach)

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.copies.joints

    @property
    def outputs(self) -> int:
        """Number of torques k."""
        return self.values.shape[1]

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (k, 1) [N m] at a configuration (n, 1) [rad]."""
        count, images = len(self.prototypes), len(self.turns)
        points = self.copies.of(space, q)
        seen = [self._offsets(space, y) for y, _ in points]  # t = 0 in the first `count` columns
        squares = [space.constant(np.ones((1, x.shape[0]))) @ (x * x) for x in seen]
        nearest = [space.smallest(square[:, :count]) for square in squares]
        reach = space.constant([[self.reach**2]])
        least = space.smallest(space.beside([space.smallest(square) for square in squares]))
        near = space.at_most(least, reach)
        least = space.choose(near, least, space.smallest(space.beside(nearest)))
        everywhere = space.constant(np.ones((1, count * images)))
        home = space.constant(np.repeat([[1.0, 0.0]], [count, count * (images - 1)], axis=1))
        usable = space.choose(near, everywhere, home)
        tables = [np.tile(table, (1, images)) for table in self.values.transpose(2, 1, 0)]
        torque, total = space.constant(np.zeros(self.outputs)), space.constant([[0.0]])
        for (_, signs), x, square, own in zip(points, seen, squares, nearest, strict=True):
            limit = space.choose(near, reach, own + reach)
            inside = space.at_most(square, limit @ everywhere) * usable
            h = inside * space.exp(inside * (least @ everywhere - square) / self.kernel**2)
            value = space.constant(tables[0]) @ h.T
            for axis, table in enumerate(tables[1:]):
                value = value + space.constant(table) @ (h * x[axis : axis + 1, :]).T / self.radius
            torque = torque + signs * value
            total = total + h @ everywhere.T
        return torque / (space.constant(np.ones(self.outputs)) @ total)

    def _offsets(self, space: Space, y: Any) -> Any:
        """Offsets x (r, T M) for all turns and prototypes."""
        row = space.constant(np.ones((1, len(self.prototypes))))
        difference = wrap(space, y @ row - space.constant(self.prototypes.T))
        isometry = space.constant(self.isometry)
        return space.beside(
            [isometry @ (difference - space.constant(TURN * turn) @ row) for turn in self.turns]
        )

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        tables.number("JOINTS", self.outputs)
        tables.number("PROTOTYPES", len(self.prototypes))
        tables.number("IMAGES", len(self.turns))
        tables.value("KERNEL", self.kernel**2)
        tables.value("REACH", self.reach**2)
        tables.value("UNIT", self.radius)
        copies = self.copies.c_source(tables)
        tables.add("ISOMETRY", self.isometry)
        tables.add("IMAGE", TURN * self.turns)
        tables.add("PROTOTYPE", self.prototypes)
        tables.add("VALUE", self.values)
        return tables.source() + "\n" + copies + C_SOURCE

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        return {
            **copies_to_arrays(self.copies),
            "prototypes": self.prototypes,
            "isometry": self.isometry,
            "turns": self.turns,
            "values": self.values,
            "radius": np.array(self.radius),
            "kernel": np.array(self.kernel),
            "reach": np.array(self.reach),
        }

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> LocalFunctions:
        """The form with these tables."""
        copies = copies_from_arrays(arrays)
        assert isinstance(copies, Copies)
        return cls(
            copies,
            arrays["prototypes"],
            arrays["isometry"],
            arrays["turns"],
            arrays["values"],
            float(arrays["radius"]),
            float(arrays["kernel"]),
            float(arrays["reach"]),
        )


C_SOURCE = """
/* x = L (y - p) for prototype p, seen t turns away; returns its squared length. */
static double offset_of(int p, int t, const double *y, double *x)
{
    double difference[RANK], squared = 0.0;
    int i, j;
    for (i = 0; i < RANK; i++) {
        difference[i] = y[i] - PROTOTYPE[p][i];
        if (difference[i] >= 0.5 * TURN)
            difference[i] -= TURN;
        else if (difference[i] < -0.5 * TURN)
            difference[i] += TURN;
        difference[i] -= IMAGE[t][i];
    }
    for (i = 0; i < RANK; i++) {
        x[i] = 0.0;
        for (j = i; j < RANK; j++)
            x[i] += ISOMETRY[i][j] * difference[j];
        squared += x[i] * x[i];
    }
    return squared;
}

void isotorque_gravity(const double *q, double *tau)
{
    double torque[JOINTS] = {0.0}, y[SUMMED][RANK], nearest[SUMMED], x[RANK];
    double least = HUGE_VAL, home = HUGE_VAL, total = 0.0, squared, limit, weight, value;
    int g, i, j, p, t, near, row[SUMMED];
    for (g = 0; g < SUMMED; g++) {
        row[g] = copy_of(g, q, y[g]);
        nearest[g] = HUGE_VAL;
        for (p = 0; p < PROTOTYPES; p++)
            for (t = 0; t < IMAGES; t++) {
                squared = offset_of(p, t, y[g], x);
                if (squared < least)
                    least = squared;
                if (t == 0 && squared < nearest[g])
                    nearest[g] = squared;
            }
        if (nearest[g] < home)
            home = nearest[g];
    }
    near = least <= REACH;
    if (!near)
        least = home;
    for (g = 0; g < SUMMED; g++) {
        limit = near ? REACH : nearest[g] + REACH;
        for (p = 0; p < PROTOTYPES; p++)
            for (t = 0; t < (near ? IMAGES : 1); t++) {
                squared = offset_of(p, t, y[g], x);
                if (squared > limit)
                    continue;
                weight = exp((least - squared) / KERNEL);
                total += weight;
                for (i = 0; i < JOINTS; i++) {
                    value = 0.0;
                    for (j = 0; j < RANK; j++)
                        value += VALUE[p][i][1 + j] * x[j];
                    value = VALUE[p][i][0] + value / UNIT;
                    torque[i] += SIGN[row[g]][i] * weight * value;
                }
            }
    }
    for (i = 0; i < JOINTS; i++)
        tau[i] = torque[i] / total;
}
"""
