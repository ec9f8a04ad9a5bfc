"""Symmetry relations q -> A q + d with torque signs Y, and the groups they form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_relation import SAME_ANGLE, SymmetryRelation, identity
from isotorque.symbolic.lattices.integer_lattice import saturation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DirectFactor:
    """One of the groups that a group is the direct product of.

    Attributes
    ----------
    joints : tuple of int
        The joints that it moves.
    order : int
        Its order.
    factors : tuple of int
        Orders of direct factors that move all of these joints; ``(order,)`` where none is known.
    """

    joints: tuple[int, ...]
    order: int
    factors: tuple[int, ...] = ()


LARGEST_LIST = 4096
"""Groups beyond this order are known by their generators and structure, and are not listed."""


class SymmetryGroup(Sequence[SymmetryRelation]):
    """A finite group of symmetry relations, the identity first.

    Parameters
    ----------
    relations
        All members; they share one basis. The identity is put first.

    Raises
    ------
    InputError
        If the list is empty or the relations have different bases.

    Notes
    -----
    Groups that `primary_symmetries` finds are not lists: order, generators, structure, single
    members and membership cost next to nothing at any order. What needs every member at once
    (the arrays, orbits, the multiplication table, domains) is refused beyond ``LARGEST_LIST``.

    Examples
    --------
    >>> flip = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> group = close([flip])
    >>> group.order, group.orbit([0.25, 0.5]).tolist()
    (2, [[0.25, 0.5], [-0.25, 1.0]])
    """

    basis: NDArray[np.int64]
    n: int

    def __init__(self, relations: Iterable[SymmetryRelation]) -> None:
        members = list(relations)
        if not members:
            raise InputError("symmetry group", "relations", "empty", "at least the identity")
        for relation in members:
            if not np.array_equal(relation.basis, members[0].basis):
                raise InputError("symmetry group", "bases", "different", "one basis for all")
            if relation.correction is not None:  # members are applied to arrays of torques
                accepted = "relations of torques less it: of_measured(None)"
                raise InputError("symmetry group", "relation", "has a correction", accepted)
        members.sort(key=lambda relation: not relation.is_identity)
        self._members: tuple[SymmetryRelation, ...] | None = tuple(members)
        self.basis = members[0].basis
        self.n = members[0].n

    # -- members --------------------------------------------------------------------------------

    @property
    def order(self) -> int:
        """Number of relations, the identity included."""
        return len(self.listed())

    def listed(self) -> tuple[SymmetryRelation, ...]:
        """Return all relations.

        Raises
        ------
        InputError
            If there are more than ``LARGEST_LIST`` and the group is not a list anyway.
        """
        if self._members is None:
            if self.order > LARGEST_LIST:
                accepted = f"at most {LARGEST_LIST} where every relation is needed"
                raise InputError("symmetry group", "order", self.order, accepted)
            self._members = tuple(self.relation(i) for i in range(self.order))
        return self._members

    def relation(self, number: int) -> SymmetryRelation:
        """Return relation number ``number`` (from 0), the same as ``self[number]``."""
        return self.listed()[number]

    def __len__(self) -> int:
        return self.order

    def __iter__(self) -> Iterator[SymmetryRelation]:
        if self.order <= LARGEST_LIST:
            return iter(self.listed())
        return (self.relation(i) for i in range(self.order))

    def __getitem__(self, index: Any) -> Any:
        numbers = range(self.order)[index]
        if self._members is not None:
            return self._members[index]
        if isinstance(numbers, range):
            return tuple(self.relation(i) for i in numbers)
        return self.relation(numbers)

    def find(self, value: SymmetryRelation) -> int | None:
        """Return the number of the relation that equals ``value`` modulo 2 pi, None if none."""
        if value.A_sat.shape != self.A_sat.shape[1:] or value.Y.shape != self.Y.shape[1:]:
            return None
        match = np.all(self.Y == value.Y, axis=1)
        match &= np.isclose(self.A_sat, value.A_sat, atol=1e-6).all(axis=(1, 2))
        match &= np.all(np.abs(wrap(self.d_sat - value.d_sat)) <= SAME_ANGLE, axis=1)
        return int(np.argmax(match)) if match.any() else None

    def index(self, value: Any, start: int = 0, stop: int | None = None) -> int:
        """Return the position of the relation that equals ``value`` modulo 2 pi."""
        number = self.find(value)
        if number is None or number not in range(self.order)[start:stop]:
            raise ValueError("relation is not in the group")
        return number

    def __contains__(self, value: object) -> bool:
        return isinstance(value, SymmetryRelation) and self.find(value) is not None

    # -- arrays of all members ------------------------------------------------------------------

    @cached_property
    def Y(self) -> Array:
        """Signs of all relations, shape (order, n)."""
        return np.array([r.Y for r in self.listed()])

    @cached_property
    def A(self) -> Array:
        """Linear parts of all relations, shape (order, n, n)."""
        return np.array([r.A for r in self.listed()])

    @cached_property
    def d(self) -> Array:
        """Offsets of all relations [rad], shape (order, n)."""
        return np.array([r.d for r in self.listed()])

    @cached_property
    def A_sat(self) -> Array:
        """Linear parts in y = B q coordinates, shape (order, r, r)."""
        stack = np.array([r.A_sat for r in self.listed()])
        return stack.reshape(self.order, self.rank, self.rank)

    @cached_property
    def d_sat(self) -> Array:
        """Offsets in y = B q coordinates [rad], shape (order, r)."""
        return np.array([r.d_sat for r in self.listed()]).reshape(self.order, self.rank)

    # -- what it acts on ------------------------------------------------------------------------

    @property
    def rank(self) -> int:
        """Rank r: number of independent combinations y = B q that the torque depends on."""
        return len(self.basis)

    @cached_property
    def completion(self) -> Array:
        """An invertible (n, n) matrix V whose first r rows are the basis B."""
        B, V = saturation(self.basis)
        if len(B) and not np.array_equal(B, self.basis):
            V = np.concatenate([self.basis, V[self.rank :]])
        return V.astype(float)

    @cached_property
    def free_directions(self) -> Array:
        """Directions v with B v = 0, along which no torque changes, as rows (n - r, n)."""
        return np.asarray(np.linalg.inv(self.completion).T[self.rank :].round(12) + 0.0)

    def orbit(self, q: ArrayLike) -> Array:
        """Return the images of ``q`` (..., n) under all relations, shape (order, ..., n)."""
        points = np.asarray(q, dtype=float)
        offsets = self.d.reshape(len(self), *[1] * (points.ndim - 1), self.n)
        return np.einsum("gij,...j->g...i", self.A, points) + offsets

    def torques(self, tau: ArrayLike) -> Array:
        """Return the torques of the images for ``tau`` (..., n), shape (order, ..., n)."""
        values = np.asarray(tau, dtype=float)
        return self.Y.reshape(len(self), *[1] * (values.ndim - 1), self.n) * values

    # -- structure ------------------------------------------------------------------------------

    @property
    def exact(self) -> bool:
        """Whether every relation is proved."""
        return all(relation.exact for relation in self.listed())

    @cached_property
    def generators(self) -> tuple[SymmetryRelation, ...]:
        """A few relations whose products are all relations; none for the trivial group."""
        table = self.multiplication_table
        chosen: list[int] = []
        reached = np.zeros(self.order, dtype=bool)
        reached[0] = True
        while not reached.all():
            chosen.append(int(np.flatnonzero(~reached)[0]))
            fresh = np.flatnonzero(reached)
            while len(fresh):  # products of finitely many generators are the whole subgroup
                images = np.unique(table[chosen][:, fresh])
                fresh = images[~reached[images]]
                reached[fresh] = True
        return tuple(self.listed()[i] for i in chosen)

    @property
    def direct_factors(self) -> tuple[DirectFactor, ...]:
        """Groups of which this one is the direct product; itself where no others are known."""
        joints = np.flatnonzero(np.any(self.basis, axis=0)).tolist()
        return (DirectFactor(tuple(joints), self.order),)

    @cached_property
    def multiplication_table(self) -> NDArray[np.int64]:
        """Return indices of ``self[i] @ self[j]``, shape (order, order).

        Raises
        ------
        InputError
            If a product is not among the relations: they do not form a group.
        """
        if self.order > LARGEST_LIST:
            accepted = f"at most {LARGEST_LIST} for a multiplication table"
            raise InputError("symmetry group", "order", self.order, accepted)
        table = np.full((self.order, self.order), -1, dtype=np.int64)
        nobody = np.zeros(0, dtype=np.int64)
        for i in range(self.order):
            linear = self.A_sat[i] @ self.A_sat
            offset = self.d_sat @ self.A_sat[i].T + self.d_sat[i]
            for j, key in enumerate(_keys(self.Y[i] * self.Y, linear, self._whole)):
                alike = self._by_key.get(key, nobody)
                match = np.abs(linear[j] - self.A_sat[alike]).max(axis=(1, 2), initial=0.0) < 1e-6
                off = np.abs(wrap(offset[j] - self.d_sat[alike])).max(axis=1, initial=0.0)
                match &= off < SAME_ANGLE
                if match.any():
                    table[i, j] = alike[match][-1]
        if np.any(table < 0):
            raise InputError("symmetry group", "products", "outside the list", "a closed list")
        return table

    @cached_property
    def _whole(self) -> bool:
        return bool(np.all(np.abs(self.A_sat - np.round(self.A_sat)) < 1e-9))

    @cached_property
    def _by_key(self) -> dict[bytes, NDArray[np.int64]]:
        members: dict[bytes, list[int]] = {}
        for i, key in enumerate(_keys(self.Y, self.A_sat, self._whole)):
            members.setdefault(key, []).append(i)
        return {key: np.array(numbers) for key, numbers in members.items()}

    @property
    def is_closed(self) -> bool:
        """Whether the relations form a group: all products are among them."""
        try:
            return bool(np.all(self.multiplication_table >= 0))
        except InputError:
            if self.order > LARGEST_LIST:
                raise
            return False

    def level_set_symmetries(self) -> SymmetryGroup:
        """Return the subgroup with Y = I: same torque, not only the same up to signs."""
        return SymmetryGroup(r for r in self.listed() if np.all(r.Y == 1))


def check_listable(group: SymmetryGroup, where: str, joint_names: Sequence[str]) -> None:
    """Refuse a group too large to be listed, before any work that needs every relation.

    Raises
    ------
    InputError
        Naming joints that would be few enough, by the option that chooses them.

    Examples
    --------
    >>> from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
    >>> from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
    >>> U = TrigonometricPolynomial(np.eye(7, dtype=int), [0.0] * 7, [1.0] * 7)
    >>> check_listable(primary_symmetries(U), "seven", "abcdefg")
    Traceback (most recent call last):
    isotorque.InputError: seven: number of symmetries is 16384; accepted: at most 4096, as with some
        of the joints: --joints a,b,c,d,e,f
    """
    if group.order <= LARGEST_LIST:
        return
    chosen: list[int] = []
    order = 1
    for factor in group.direct_factors:
        if order * factor.order <= LARGEST_LIST and factor.joints:
            order *= factor.order
            chosen += factor.joints
    names = ",".join(joint_names[j] for j in sorted(chosen))
    few = f", as with some of the joints: --joints {names}" if chosen else " (--lock some joints)"
    raise InputError(where, "number of symmetries", group.order, f"at most {LARGEST_LIST}{few}")


def group_structure(group: SymmetryGroup) -> str:
    """Return in words how a group is a direct product of those of blocks of joints.

    Examples
    --------
    >>> from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
    >>> from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
    >>> legs = TrigonometricPolynomial(np.eye(3, dtype=int), [0.0] * 3, [1.0, 1.0, 2.0])
    >>> group_structure(primary_symmetries(legs))
    '64 = 4^3: 3 blocks of 4'
    """
    count = Counter(factor.order for factor in group.direct_factors)
    orders = sorted(order for order in count if order > 1)
    if not orders:
        return "1"
    powers = " x ".join(_power(order, count[order]) for order in orders)
    blocks = ", ".join(
        f"{count[order]} block{'s' if count[order] > 1 else ''} of {order}" for order in orders
    )
    return f"{group.order} = {powers}: {blocks}" if powers != str(group.order) else powers


def _power(order: int, exponent: int) -> str:
    return str(order) if exponent == 1 else f"{order}^{exponent}"


def factor_structure(factor: DirectFactor) -> str:
    """Return the order of a factor, as a product where it is known to be one.

    Examples
    --------
    >>> factor_structure(DirectFactor((0, 1), 8, (2, 2, 2)))
    '8 = 2^3'
    """
    count = Counter(factor.factors)
    if len(factor.factors) < 2:
        return str(factor.order)
    powers = " x ".join(_power(order, count[order]) for order in sorted(count, reverse=True))
    return f"{factor.order} = {powers}"


def _keys(Y: Array, A_sat: Array, whole: bool) -> list[bytes]:
    """Return what equal relations share: Y, and A_sat where it is integer."""
    rows = [Y.astype(np.int8)]
    if whole:
        whole_numbers = np.round(A_sat).reshape(len(A_sat), A_sat.shape[1] * A_sat.shape[2]) + 0.0
        rows.append(np.ascontiguousarray(whole_numbers).view(np.int8))
    return [row.tobytes() for row in np.ascontiguousarray(np.concatenate(rows, axis=1))]


def close(
    relations: Iterable[SymmetryRelation], max_order: int = 4096, tolerance: float = SAME_ANGLE
) -> SymmetryGroup:
    """Return the smallest group that contains the given relations.

    Parameters
    ----------
    relations
        Generators with one common basis.
    max_order
        Give up beyond this order.
    tolerance
        Offsets that differ by less [rad] are taken as equal.

    Raises
    ------
    InputError
        If there is none given, or if the products exceed ``max_order`` (offsets that do not fit
        together generate ever new relations).
    """
    generators = list(relations)
    if not generators:
        raise InputError("symmetry group", "generators", "none", "at least one relation")
    members = [identity(generators[0].n, generators[0].basis)]
    position = 0
    while position < len(members):
        for generator in generators:
            product = generator @ members[position]
            if not any(product.same_as(m, tolerance) for m in members):
                members.append(product)
                if len(members) > max_order:
                    raise InputError(
                        "symmetry group",
                        "order generated by the relations",
                        f"above {max_order}",
                        "relations whose products come back",
                    )
        position += 1
    return SymmetryGroup(members)
