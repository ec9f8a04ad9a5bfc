"""Direct products of symmetry groups that act on separate joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.groups.symmetry_group import DirectFactor, SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation, lifted
from isotorque.symbolic.lattices.integer_lattice import saturation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.residual_bound import residual_bound

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class ProductGroup(SymmetryGroup):
    """The direct product of groups on disjoint sets of joints, identity on all other joints.

    Parameters
    ----------
    n
        Number of joints.
    blocks : list of (b,) int array
        The joints of each factor, ascending.
    groups : list of SymmetryGroup
        The factors, each on its own joints.
    numeric
        The potential in floats, for the bounds of relations that are not proved; without it the
        bounds of the factors are kept (right where no term of the potential has joints of two).

    Notes
    -----
    The joints of a block share no frequency with others, so both conditions on a relation, and
    the lattices in them, split into those of the blocks: the group is exactly the product, with
    no further choice between blocks (that comes with permutations of equal blocks only).
    Relations are numbered with the last block fastest.

    Examples
    --------
    >>> from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
    >>> U = TrigonometricPolynomial([[1, 0, 0], [0, 1, 0], [0, 1, 1]], [0.0] * 3, [1.0, 2.0, 1.0])
    >>> group = primary_symmetries(U)
    >>> group.order, [factor.order for factor in group.direct_factors]
    (32, [4, 8])
    """

    def __init__(
        self,
        n: int,
        blocks: Sequence[Integers],
        groups: Sequence[SymmetryGroup],
        numeric: TrigonometricPolynomial | None = None,
    ) -> None:
        self.n = n
        self._members = None
        self._blocks, self._groups, self._numeric = list(blocks), list(groups), numeric
        rows, owner = [], []
        for number, (block, group) in enumerate(zip(blocks, groups, strict=True)):
            wide = np.zeros((group.rank, n), dtype=np.int64)
            wide[:, block] = group.basis
            rows.append(wide)
            owner += [number] * group.rank
        stacked = np.concatenate([np.zeros((0, n), dtype=np.int64), *rows])
        order = np.lexsort((np.argmax(stacked != 0, axis=1),))
        self.basis = stacked[order]
        self._owner = np.array(owner, dtype=np.int64)[order]

    @cached_property
    def order(self) -> int:
        """Number of relations."""
        return math.prod(group.order for group in self._groups)

    def relation(self, number: int) -> SymmetryRelation:
        """Return relation number ``number`` (from 0)."""
        digits = []
        for group in reversed(self._groups):
            number, digit = divmod(number, group.order)
            digits.append(digit)
        parts = [g.relation(i) for g, i in zip(self._groups, reversed(digits), strict=True)]
        return self._assembled(parts)

    def _assembled(self, parts: list[SymmetryRelation]) -> SymmetryRelation:
        """Return the relation that acts as given on each block."""
        A, d, Y, bound = np.eye(self.n), np.zeros(self.n), np.ones(self.n), np.zeros(self.n)
        for block, part in zip(self._blocks, parts, strict=True):
            A[np.ix_(block, block)], d[block] = part.A, part.d
            Y[block], bound[block] = part.Y, part.bound
        exact = all(part.exact for part in parts)
        if not exact and self._numeric is not None:
            bound = residual_bound(self._numeric, A, d, Y)
        return SymmetryRelation(A, d, Y, self.basis, exact, bound)

    def find(self, value: SymmetryRelation) -> int | None:
        """Return the number of the relation that equals ``value`` modulo 2 pi, None if none."""
        r = len(self.basis)
        if value.n != self.n or value.A_sat.shape != (r, r):
            return None
        rest, Y, number = value.A_sat.copy(), value.Y.copy(), 0
        for i, (block, group) in enumerate(zip(self._blocks, self._groups, strict=True)):
            rows = np.flatnonzero(self._owner == i)
            square = np.ix_(rows, rows)
            A, d = lifted(saturation(group.basis)[1].astype(float), rest[square], value.d_sat[rows])
            digit = group.find(SymmetryRelation(A, d, Y[block], group.basis))
            if digit is None:
                return None
            number = number * group.order + digit
            rest[square], Y[block] = 0.0, 1.0
        return number if np.all(Y == 1) and np.abs(rest).max(initial=0.0) < 1e-6 else None

    # -- structure ------------------------------------------------------------------------------

    @cached_property
    def exact(self) -> bool:
        """Whether every relation is proved."""
        return all(group.exact for group in self._groups)

    @cached_property
    def generators(self) -> tuple[SymmetryRelation, ...]:
        """The generators of all factors; none for the trivial group."""
        units = [group.relation(0) for group in self._groups]
        return tuple(
            self._assembled([*units[:i], generator, *units[i + 1 :]])
            for i, group in enumerate(self._groups)
            for generator in group.generators
        )

    @cached_property
    def direct_factors(self) -> tuple[DirectFactor, ...]:
        """The groups that this one is the direct product of."""
        return tuple(
            DirectFactor(tuple(block[list(f.joints)].tolist()), f.order, f.factors)
            for block, group in zip(self._blocks, self._groups, strict=True)
            for f in group.direct_factors
        )

    @property
    def is_closed(self) -> bool:
        """Whether the relations form a group."""
        return all(group.is_closed for group in self._groups)
