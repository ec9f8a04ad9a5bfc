"""The one symmetric copy in the fundamental domain, found without loops of unknown length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.export.forms.symmetric_copies import TURN, Copies, wrap
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain

Array = NDArray[np.float64]
SLACK = 1e-6  # copies that miss the domain by no more are kept as candidates


@dataclass(frozen=True, eq=False)
class CanonicalCopy:
    """Candidates ``y = A_c w + d_c``, w = B q wrapped; the one that lies deepest in the domain.

    Attributes
    ----------
    basis : (r, n) array
        B.
    linear, offset, signs : (C, r, r), (C, r), (C, n) arrays
        Every copy, full turns included, that can lie in the domain when w is in [-pi, pi);
        relative to the centre of the domain.
    halfspaces : (f, r + 1) array
        Rows [a.., b]: the domain is ``a.y <= b``, relative to its centre.

    Notes
    -----
    `canonical_representatives` walks from cell to cell; here all images of the box of wrapped
    coordinates that touch the domain are listed once, so a controller does the same work for every
    q. On the boundary of the domain, where several copies are in it, another one may be taken than
    there.
    """

    basis: Array
    linear: Array
    offset: Array
    signs: Array
    halfspaces: Array

    @classmethod
    def of_domain(cls, domain: FundamentalDomain) -> CanonicalCopy:
        """Candidates for a domain."""
        group, center = domain.group, domain.basis @ domain.center
        rows = np.array(domain.halfspaces, dtype=float)
        rows[:, -1] -= rows[:, :-1] @ center
        corners = domain.vertices - center
        chosen: list[tuple[Array, Array, Array]] = []
        for A, d, Y in zip(group.A_sat, group.d_sat, group.Y, strict=True):
            # the box is mapped into |y_i - d_i| <= pi sum_j |A_ij|, and a.y varies by |a A|
            half = np.pi * np.abs(A).sum(axis=1) + SLACK
            low = np.ceil((corners.min(axis=0) - half - d + center) / TURN).astype(int)
            high = np.floor((corners.max(axis=0) + half - d + center) / TURN).astype(int)
            axes = [np.arange(a, b + 1) for a, b in zip(low, high, strict=True)]
            turns = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(center))
            moved = d + TURN * turns - center
            reach = np.pi * np.abs(rows[:, :-1] @ A).sum(axis=1)
            near = (moved @ rows[:, :-1].T - reach <= rows[:, -1] + SLACK).all(axis=1)
            chosen += [(A, shift, Y) for shift in moved[near]]
        linear, offset, signs = (np.array(part) for part in zip(*chosen, strict=True))
        return cls(np.asarray(domain.basis, dtype=float), linear, offset, signs, rows)

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.basis.shape[1]

    @property
    def outputs(self) -> int:
        """Number of torques."""
        return self.signs.shape[1]

    @property
    def rank(self) -> int:
        """Number of coordinates r."""
        return len(self.basis)

    def of(self, space: Space, q: Any) -> list[tuple[Any, Any]]:
        """The copy (r, 1) of a configuration (n, 1), and its signs (n, 1)."""
        start = wrap(space, space.constant(self.basis) @ q)
        rows = space.constant(self.halfspaces[:, :-1])
        bounds = space.constant(self.halfspaces[:, -1])
        best: list[Any] = []
        for A, d, signs in zip(self.linear, self.offset, self.signs, strict=True):
            y = space.constant(A) @ start + space.constant(d)
            new = [space.smallest(bounds - rows @ y), y, space.constant(signs)]
            if best:
                keep = space.at_most(new[0], best[0])
                new = [space.choose(keep, a, b) for a, b in zip(best, new, strict=True)]
            best = new
        return [(best[1], best[2])]

    def c_source(self, tables: Tables) -> str:
        """A function ``copy_of(0, q, y)`` that returns the row of SIGN."""
        tables.number("SUMMED", 1)
        tables.number("CANDIDATES", len(self.linear))
        tables.number("RANK", self.rank)
        tables.number("FACETS", len(self.halfspaces))
        tables.value("TURN", TURN)
        tables.add("BASIS", self.basis)
        tables.add("LINEAR", self.linear)
        tables.add("OFFSET", self.offset)
        tables.add("SIGN", self.signs)
        tables.add("HALFSPACE", self.halfspaces)
        return C_SOURCE


C_SOURCE = """
/* The copy of q in the fundamental domain: coordinates y from its centre [rad]; returns the row of
   SIGN. Of all candidates it is the one that lies deepest behind the half-spaces. */
static int copy_of(int first, const double *q, double *y)
{
    double start[RANK], moved[RANK], slack, least, best = 0.0;
    int chosen = first, c, f, i, j;
    for (i = 0; i < RANK; i++) {
        start[i] = y[i] = 0.0;
        for (j = 0; j < JOINTS; j++)
            start[i] += BASIS[i][j] * q[j];
        start[i] -= TURN * floor(start[i] / TURN + 0.5);
    }
    for (c = 0; c < CANDIDATES; c++) {
        for (i = 0; i < RANK; i++) {
            moved[i] = OFFSET[c][i];
            for (j = 0; j < RANK; j++)
                moved[i] += LINEAR[c][i][j] * start[j];
        }
        least = 0.0;
        for (f = 0; f < FACETS; f++) {
            slack = HALFSPACE[f][RANK];
            for (i = 0; i < RANK; i++)
                slack -= HALFSPACE[f][i] * moved[i];
            if (f == 0 || slack < least)
                least = slack;
        }
        if (c == 0 || least > best) {
            chosen = c;
            best = least;
            for (i = 0; i < RANK; i++)
                y[i] = moved[i];
        }
    }
    return chosen;
}
"""


def copies_to_arrays(copies: Copies | CanonicalCopy) -> dict[str, NDArray]:
    """Arrays by name, each name beginning with ``copy_``."""
    arrays = {"linear": copies.linear, "offset": copies.offset, "signs": copies.signs}
    if isinstance(copies, CanonicalCopy):
        arrays |= {"basis": copies.basis, "halfspaces": copies.halfspaces}
    else:
        arrays["wrapped"] = np.array(copies.wrapped)
    return {f"copy_{name}": array for name, array in arrays.items()}


def copies_from_arrays(arrays: dict[str, NDArray]) -> Copies | CanonicalCopy:
    """Inverse of `copies_to_arrays`."""
    linear, offset, signs = (arrays[f"copy_{name}"] for name in ("linear", "offset", "signs"))
    if "copy_halfspaces" in arrays:
        basis, halfspaces = arrays["copy_basis"], arrays["copy_halfspaces"]
        return CanonicalCopy(basis, linear, offset, signs, halfspaces)
    return Copies(linear, offset, signs, bool(arrays["copy_wrapped"]))
