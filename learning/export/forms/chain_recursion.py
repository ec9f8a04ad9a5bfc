"""The torque of a rigid chain as a walk along it, out and back."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

NAME = re.compile(r"[a-z]+\d+")
NEGLIGIBLE = 1e-15
"""Sines, cosines and relative levers below are rounding."""


@dataclass(frozen=True, eq=False)
class ChainRecursion:
    """Upward direction v and moment h, link by link.

    Attributes
    ----------
    parents : (n,) int array
        Joint that carries each joint, -1 for the base.
    shifts : (n,) array
        Added to the joint angles [rad].
    offsets, twists : (n,) arrays
        Constant rotation between a link and the next, ``Rz(offset) Rx(twist)`` [rad].
    levers : (n, 2) array
        Weight times lever of every link, along x and y of its frame [N m].
    gains, biases : (n,) arrays
        Measured torque is ``gain torque + bias``.
    """

    parents: Integers
    shifts: Array
    offsets: Array
    twists: Array
    levers: Array
    gains: Array
    biases: Array

    KIND: ClassVar[str] = "rigid chain"
    FORMULA: ClassVar[str] = (
        "v_j = Rz(q_j + shift_j)^T Rx(twist_j)^T Rz(offset_j)^T v_parent, v = e_z at the base; "
        "h_j = lever_j + sum over children c of Rz(offset_c) Rx(twist_c) Rz(q_c + shift_c) h_c; "
        "tau_j = gain_j (h_jx v_jy - h_jy v_jx) + bias_j"
    )

    @classmethod
    def of(
        cls,
        parents: Integers,
        offsets: Array,
        twists: Array,
        levers: Array,
        gains: Array,
        biases: Array,
    ) -> ChainRecursion:
        """Fold the offset of each first child into the angle of its parent: fewer products."""
        shifts, left = np.zeros(len(parents)), offsets.copy()
        for j in range(len(parents)):
            children = np.flatnonzero(parents == j)
            if len(children):
                shifts[j] = offsets[children[0]]
                left[children] -= shifts[j]
        c, s = np.cos(shifts), np.sin(shifts)
        x, y = levers.T
        turned = np.stack([c * x + s * y, c * y - s * x], axis=1)
        turned[np.abs(turned) < NEGLIGIBLE * np.abs(turned).max(initial=0.0)] = 0.0
        return cls(parents, shifts, left, twists, turned, gains, biases)

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return len(self.parents)

    @property
    def outputs(self) -> int:
        """Number of torques."""
        return len(self.parents)

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (n, 1) [N m] at a configuration (n, 1) [rad]."""
        angle = q + space.constant(self.shifts)
        cos, sin = space.cos(angle), space.sin(angle)
        three = space.constant(np.ones(3))
        along = space.constant(np.diag([0.0, 0.0, 1.0]))
        across = space.constant(np.diag([1.0, 1.0, 0.0]))
        quarter = space.constant([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        row = np.eye(self.joints)
        turns = [
            (three @ (space.constant(e[None]) @ cos), three @ (space.constant(e[None]) @ sin))
            for e in row
        ]
        fixed = [self._fixed(j) for j in range(self.joints)]
        upward: list[Any] = []
        for j, p in enumerate(self.parents):
            v = space.constant([0.0, 0.0, 1.0]) if p < 0 else upward[p]
            v = space.constant(fixed[j].T) @ v
            c, s = turns[j]
            upward.append(along @ v + c * (across @ v) - s * (quarter @ v))
        moments = [space.constant([x, y, 0.0]) for x, y in self.levers]
        for j in range(self.joints - 1, -1, -1):
            p = self.parents[j]
            if p >= 0:
                h, (c, s) = moments[j], turns[j]
                h = along @ h + c * (across @ h) + s * (quarter @ h)
                moments[p] = moments[p] + space.constant(fixed[j]) @ h
        torques = []
        pick = [space.constant(np.eye(3)[a : a + 1]) for a in range(2)]
        for v, h in zip(upward, moments, strict=True):
            torques.append((pick[0] @ h) * (pick[1] @ v) - (pick[1] @ h) * (pick[0] @ v))
        return space.above(torques) * space.constant(self.gains) + space.constant(self.biases)

    def _fixed(self, j: int) -> Array:
        (a, b), (c, s) = _unit(self.offsets[j]), _unit(self.twists[j])
        turn = np.array([[a, -b, 0.0], [b, a, 0.0], [0.0, 0.0, 1.0]])
        return turn @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        function = self.c_function(tables, "isotorque_gravity", "SHIFT", static=False)
        turn = C_TURN if "turn(" in function else ""
        return f"{tables.source()}\n{turn}\n{function}"

    def c_function(self, tables: Tables, name: str, shift: str, static: bool = True) -> str:
        """C99 of ``name(q, tau)``; calls ``turn`` (`C_TURN`), its table of shifts in ``tables``."""
        code = Statements()
        used = self._used()
        cos, sin = ({int(j): f"{f}{j}" for j in np.flatnonzero(used)} for f in "cs")
        for j in cos:
            code.define(cos[j], f"c[{j}]")
            code.define(sin[j], f"s[{j}]")
        upward: dict[int, tuple[str, str, str]] = {}
        for j in cos:
            p = int(self.parents[j])
            (a, b), (c, s) = _unit(self.offsets[j]), _unit(self.twists[j])
            x, y, z = ("0.0", "0.0", "1.0") if p < 0 else upward[p]
            if p >= 0:
                x, y = (
                    code.sum(f"ox{j}", (a, x), (b, y)),
                    code.sum(f"oy{j}", (a, y), (-b, x)),
                )
            t = code.sum(f"ty{j}", (c, y), (s, z))
            upward[j] = (
                code.sum(f"vx{j}", (1.0, cos[j], x), (1.0, sin[j], t)),
                code.sum(f"vy{j}", (1.0, cos[j], t), (-1.0, sin[j], x)),
                code.sum(f"vz{j}", (c, z), (-s, y)),
            )
        handed: dict[int, tuple[str, str, str]] = {}
        torques = ["0.0"] * self.joints
        for j in list(cos)[::-1]:
            children = [handed[k] for k in cos if self.parents[k] == j]
            lever = (*self.levers[j].tolist(), 0.0)
            x, y, z = (
                code.sum(f"h{axis}{j}", *((1.0, child[i]) for child in children), (lever[i],))
                for i, axis in enumerate("xyz")
            )
            vx, vy, _ = upward[j]
            torques[j] = code.sum(f"g{j}", (1.0, x, vy), (-1.0, y, vx))
            if self.parents[j] >= 0:
                (a, b), (c, s) = _unit(self.offsets[j]), _unit(self.twists[j])
                x, y = (
                    code.sum(f"rx{j}", (1.0, cos[j], x), (-1.0, sin[j], y)),
                    code.sum(f"ry{j}", (1.0, sin[j], x), (1.0, cos[j], y)),
                )
                y, z = (
                    code.sum(f"uy{j}", (c, y), (-s, z)),
                    code.sum(f"kz{j}", (s, y), (c, z)),
                )
                x, y = (
                    code.sum(f"kx{j}", (a, x), (-b, y)),
                    code.sum(f"ky{j}", (b, x), (a, y)),
                )
                handed[j] = (x, y, z)
        results = [
            _total((g, t), (b,)) for g, t, b in zip(self.gains, torques, self.biases, strict=True)
        ]
        body = code.needed_for(results)
        turned = [j for j in cos if any(f" = {x}[{j}];" in line for line in body for x in "cs")]
        if turned:
            tables.add(shift, self.shifts)
            n, first, end = self.joints, turned[0], turned[-1] + 1  # others: gravity sees no angle
            turns = [
                f"for (j = {first}; j < {end}; j++)",
                f"    turn(q[j] + {shift}[j], c + j, s + j);",
            ]
            body[:0] = [f"double c[{n}], s[{n}];", "int j;", *turns]
        else:
            body = ["(void)q;", *body]
        body += [f"tau[{j}] = {result};" for j, result in enumerate(results)]
        text = "\n".join(f"    {line}" for line in body)
        head = f"{'static ' if static else ''}void {name}(const double *q, double *tau)"
        return f"{head}\n{{\n{text}\n}}\n"

    def _used(self) -> NDArray[np.bool_]:
        """Which joints carry something: they, and no others, have torques."""
        used = np.any(self.levers != 0.0, axis=1)
        for j in range(self.joints - 1, -1, -1):
            if used[j] and self.parents[j] >= 0:
                used[self.parents[j]] = True
        return np.asarray(used)

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        return {
            "parents": self.parents,
            "shifts": self.shifts,
            "offsets": self.offsets,
            "twists": self.twists,
            "levers": self.levers,
            "gains": self.gains,
            "biases": self.biases,
        }

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> ChainRecursion:
        """The form with these tables."""
        names = ("shifts", "offsets", "twists", "levers", "gains", "biases")
        return cls(arrays["parents"].astype(np.int64), *(arrays[name] for name in names))


C_TURN = """
/* Cosine and sine of x [rad]: quarter turns are taken off, the rest is a polynomial (fdlibm's). */
static void turn(double x, double *c, double *s)
{
    double quarters, r, z, even, odd;
    int quadrant;
    if (!(fabs(x) < 1e5)) {
        *c = cos(x);
        *s = sin(x);
        return;
    }
    quarters = (double)(int)(x * 0.63661977236758134308 + (x < 0.0 ? -0.5 : 0.5));
    quadrant = (int)quarters & 3;
    r = x - quarters * 1.57079632673412561417;
    r -= quarters * 6.07710050650619224932e-11;
    z = r * r;
    odd = r + r * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03
        + z * (-1.98412698298579493134e-04 + z * (2.75573137070700676789e-06
        + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    even = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02
        + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05
        + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09
        - z * 1.13596475577881948265e-11)))));
    z = quadrant & 1 ? odd : even;
    r = quadrant & 1 ? even : odd;
    *c = (quadrant + 1) & 2 ? -z : z;
    *s = quadrant & 2 ? -r : r;
}
"""


def _unit(angle: float) -> tuple[float, float]:
    """Cosine and sine, exact at multiples of a right angle."""
    c, s = float(np.cos(angle)), float(np.sin(angle))
    if abs(c) < NEGLIGIBLE:
        return 0.0, float(np.sign(s))
    if abs(s) < NEGLIGIBLE:
        return float(np.sign(c)), 0.0
    return c, s


class Statements:
    """C statements that define names; zeros and copies are carried through instead."""

    def __init__(self) -> None:
        self._defined: dict[str, str] = {}

    def define(self, name: str, expression: str) -> None:
        """``name = expression``."""
        self._defined[name] = expression

    def sum(self, name: str, *terms: tuple[Any, ...]) -> str:
        """A sum of products (factor, names..): its name, or what stands for it."""
        expression = _total(*terms)
        if NAME.fullmatch(expression.removeprefix("-")) or expression in ("0.0", "1.0"):
            return expression
        self.define(name, expression)
        return name

    def needed_for(self, results: list[str]) -> list[str]:
        """The statements that results depend on, in order."""
        needed = set(NAME.findall(" ".join(results)))
        lines = []
        for name, expression in reversed(self._defined.items()):
            if name in needed:
                needed.update(NAME.findall(expression))
                lines.append(f"const double {name} = {expression};")
        return lines[::-1]


def _total(*terms: tuple[Any, ...]) -> str:
    """A sum of products (factor, names..), what is zero left out."""
    text = ""
    for factor, *names in terms:
        negative = (factor < 0) != (sum(name.startswith("-") for name in names) % 2 == 1)
        rest = [name.removeprefix("-") for name in names]
        if factor == 0.0 or "0.0" in rest:
            continue
        size = [] if abs(factor) == 1.0 and set(rest) - {"1.0"} else [repr(abs(float(factor)))]
        product = " * ".join([*size, *(name for name in rest if name != "1.0")])
        if text:
            text += (" - " if negative else " + ") + product
        else:
            text = ("-" if negative else "") + product
    return text or "0.0"
