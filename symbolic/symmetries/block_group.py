"""The symmetry group of one block of joints: its relations by number, stored as generators."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.connected_components import connected_components
from isotorque.symbolic.groups.symmetry_group import DirectFactor, SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SAME_ANGLE, SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport
from isotorque.symbolic.symmetries.phase_proof import PhaseProof
from isotorque.symbolic.symmetries.sign_components import sign_components
from isotorque.symbolic.symmetries.torque_signs import TorqueSigns

Integers = NDArray[np.int64]


class BlockGroup(SymmetryGroup):
    """All exact symmetries of a potential whose joints hang together by shared frequencies.

    Parameters
    ----------
    support
        Its frequencies.
    classes, tolerance
        See `TorqueSigns`.
    proof
        Proof of relations; None where the coefficients are floats.
    numeric
        The potential in floats, for the bounds of what is not proved.

    Notes
    -----
    Every relation is (Y, s, d): Y is a product of ``torque_signs`` (a vector space over the field
    of two elements), s may be turned on each of the ``mirrored`` components, and to each (Y, s)
    there is one d per coset of the lattice of frequencies in its saturation. Relations are
    numbered in that order: Y with + before - and the first joint slowest, then s with the first
    component fastest, then cosets.
    """

    def __init__(
        self,
        support: FrequencySupport,
        classes: Integers,
        tolerance: float,
        proof: PhaseProof | None,
        numeric: TrigonometricPolynomial,
    ) -> None:
        self._support, self._proof, self._numeric = support, proof, numeric
        self._search = TorqueSigns(support, classes, sign_components(support), tolerance)
        self._members = None
        self._first: dict[int, Integers] = {}
        self.basis = support.B
        self.n = support.K.shape[1]
        self.torque_signs: Integers = np.array(self._search.generators(), dtype=np.int64).reshape(
            -1, self.n
        )
        self.mirrored: Integers = np.flatnonzero(
            self._search.admitted(np.ones(self.n, dtype=np.int64))[1]
        )

    @cached_property
    def _shifts(self) -> Integers:
        return self._support.lattice.cosets()

    @property
    def order(self) -> int:
        """Number of relations."""
        return 2 ** (len(self.torque_signs) + len(self.mirrored)) * self._support.lattice.index

    # -- relations by number --------------------------------------------------------------------

    def relation(self, number: int) -> SymmetryRelation:
        """Return relation number ``number`` (from 0)."""
        Y, s, shift = self._parts(number)
        d_sat = self._support.offset(Y, s, self._shifts[shift])
        exact = number == 0 or self.exact or self._proved(Y, s, d_sat)
        relation = self._support.relation(self._numeric, Y, s, d_sat, exact)
        if exact and self._proof is not None:
            relation = self._proof.rounded(relation, Y, s)
        return relation

    def _parts(self, number: int) -> tuple[Integers, Integers, int]:
        rest, shift = divmod(number, self._support.lattice.index)
        signs, mirrors = divmod(rest, 2 ** len(self.mirrored))
        last = len(self.torque_signs) - 1
        turned = [i for i in range(last + 1) if signs >> (last - i) & 1]
        Y = np.asarray(self.torque_signs[turned].prod(axis=0), dtype=np.int64)
        pattern = self._first_pattern(signs, Y).copy()
        pattern[[c for i, c in enumerate(self.mirrored.tolist()) if mirrors >> i & 1]] = -1
        return Y, pattern[self._support.components], shift

    def _first_pattern(self, signs: int, Y: Integers) -> Integers:
        """Return the sign of each component for a Y: + where both are admitted."""
        if signs not in self._first:
            self._first[signs] = np.where(self._search.misfits(Y).argmin(axis=0) == 1, -1, 1)
            self._first[signs][self.mirrored] = 1
        return self._first[signs]

    def find(self, value: SymmetryRelation) -> int | None:
        """Return the number of the relation that equals ``value`` modulo 2 pi, None if none."""
        if value.A_sat.shape != (self.rank, self.rank) or value.n != self.n:
            return None
        signs = 0
        for row in self.torque_signs:
            signs = 2 * signs + int(value.Y[int(np.argmin(row))] < 0)
        Y = self._parts(signs * 2 ** len(self.mirrored) * self._support.lattice.index)[0]
        if not np.array_equal(Y, value.Y):
            return None
        mirrors = 0
        for i, c in enumerate(self.mirrored.tolist()):
            k = int(np.argmax(self._support.components == c))
            kept = self._support.coordinates[k] @ value.A_sat @ self.basis
            mirrors += int(np.abs(kept + Y * self._support.K[k]).max() < 1e-3) << i
        start = (signs * 2 ** len(self.mirrored) + mirrors) * self._support.lattice.index
        _, s, _ = self._parts(start)
        if np.abs(self._support.linear_part(Y, s) - value.A_sat).max(initial=0.0) > 1e-6:
            return None
        for shift, z in enumerate(self._shifts):
            off = wrap(self._support.offset(Y, s, z) - value.d_sat)
            if np.abs(off).max(initial=0.0) <= SAME_ANGLE:
                return start + shift
        return None

    # -- structure ------------------------------------------------------------------------------

    @cached_property
    def _generator_numbers(self) -> list[int]:
        index = self._support.lattice.index
        mirrored, count = len(self.mirrored), len(self.torque_signs)
        units = [i for i, z in enumerate(self._shifts) if z.sum() == 1]
        numbers = [2 ** (mirrored + count - 1 - i) * index for i in range(count)]
        return numbers + [2**i * index for i in range(mirrored)] + units

    @cached_property
    def generators(self) -> tuple[SymmetryRelation, ...]:
        """A few relations whose products are all relations; none for the trivial group."""
        return tuple(self.relation(i) for i in self._generator_numbers)

    @cached_property
    def exact(self) -> bool:
        """Whether every relation is proved: then the generators are, and only then."""
        for number in self._generator_numbers:
            Y, s, shift = self._parts(number)
            if not self._proved(Y, s, self._support.offset(Y, s, self._shifts[shift])):
                return False
        return True

    def _proved(self, Y: Integers, s: Integers, d_sat: NDArray[np.float64]) -> bool:
        return self._proof is not None and self._proof.holds(Y, s, d_sat)

    @property
    def is_closed(self) -> bool:
        """Whether the relations form a group, as they do."""
        return True

    @cached_property
    def direct_factors(self) -> tuple[DirectFactor, ...]:
        """The group itself, with the direct factors that its generators show."""
        joints = tuple(range(self.n))
        return (DirectFactor(joints, self.order, _commuting_orders(self.generators, self.order)),)


LARGEST_CLOSURE = 64
"""Generators that do not commute are only multiplied out as far as this."""


def _commuting_orders(generators: tuple[SymmetryRelation, ...], order: int) -> tuple[int, ...]:
    """Return the orders of commuting subgroups whose product is the group, largest first.

    Generators that do not commute belong to one subgroup. Commuting subgroups that generate a
    group are its direct factors exactly if their orders multiply to its order.
    """
    count = len(generators)
    tied = np.array([[not (g @ h).same_as(h @ g) for h in generators] for g in generators])
    if not count:
        return (order,)
    label = connected_components(tied)
    orders = []
    for part in np.unique(label):
        own = [g for g, here in zip(generators, label, strict=True) if here == part]
        size = _closure_order(own)
        if size is None:
            return (order,)
        orders.append(size)
    product = math.prod(orders)
    return tuple(sorted(orders, reverse=True)) if product == order else (order,)


def _closure_order(generators: list[SymmetryRelation]) -> int | None:
    """Return how many relations there are among all products; None beyond the limit."""
    members = [generators[0] @ generators[0].inverse()]
    for member in members:
        for generator in generators:
            product = generator @ member
            if not any(product.same_as(m) for m in members):
                members.append(product)
                if len(members) > LARGEST_CLOSURE:
                    return None
    return len(members)
