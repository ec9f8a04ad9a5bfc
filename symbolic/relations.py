"""Symmetry relations q -> A q + d with torque signs Y, and the groups they form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.integer_lattice import saturation
from symbolic.symmetry_relation import SAME_ANGLE as SAME_ANGLE
from symbolic.symmetry_relation import SymmetryRelation as SymmetryRelation
from symbolic.symmetry_relation import identity as identity
from symbolic.symmetry_relation import wrap as wrap

Array = NDArray[np.float64]


class SymmetryGroup(Sequence[SymmetryRelation]):
    """A finite group of symmetry relations, the identity first.

    Parameters
    ----------
    relations
        All members; they share one basis. The identity is put first.
    basis : (r, n) int array, optional
        Needed where it cannot be read off the relations.

    Raises
    ------
    InputError
        If the list is empty or the relations have different bases.

    Examples
    --------
    >>> flip = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> group = close([flip])
    >>> group.order, group.orbit([0.25, 0.5]).tolist()
    (2, [[0.25, 0.5], [-0.25, 1.0]])
    """

    def __init__(self, relations: Iterable[SymmetryRelation]) -> None:
        members = list(relations)
        if not members:
            raise InputError("symmetry group", "relations", "empty", "at least the identity")
        for relation in members:
            if not np.array_equal(relation.basis, members[0].basis):
                raise InputError("symmetry group", "bases", "different", "one basis for all")
        members.sort(key=lambda relation: not relation.is_identity)
        self._relations = tuple(members)
        self.basis: NDArray[np.int64] = members[0].basis
        self.n: int = members[0].n
        self.Y: Array = np.array([r.Y for r in members])
        self.A: Array = np.array([r.A for r in members])
        self.d: Array = np.array([r.d for r in members])
        rank = len(self.basis)
        self.A_sat: Array = np.array([r.A_sat for r in members]).reshape(len(members), rank, rank)
        self.d_sat: Array = np.array([r.d_sat for r in members]).reshape(len(members), rank)

    def __len__(self) -> int:
        return len(self._relations)

    def __iter__(self) -> Iterator[SymmetryRelation]:
        return iter(self._relations)

    def __getitem__(self, index: Any) -> Any:
        return self._relations[index]

    @property
    def order(self) -> int:
        """Number of relations, the identity included."""
        return len(self._relations)

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

    @property
    def exact(self) -> bool:
        """Whether every relation is proved."""
        return all(relation.exact for relation in self._relations)

    def orbit(self, q: ArrayLike) -> Array:
        """Return the images of ``q`` (..., n) under all relations, shape (order, ..., n)."""
        points = np.asarray(q, dtype=float)
        offsets = self.d.reshape(len(self), *[1] * (points.ndim - 1), self.n)
        return np.einsum("gij,...j->g...i", self.A, points) + offsets

    def torques(self, tau: ArrayLike) -> Array:
        """Return the torques of the images for ``tau`` (..., n), shape (order, ..., n)."""
        values = np.asarray(tau, dtype=float)
        return self.Y.reshape(len(self), *[1] * (values.ndim - 1), self.n) * values

    def index(self, value: Any, start: int = 0, stop: int | None = None) -> int:
        """Return the position of the relation that equals ``value`` modulo 2 pi."""
        for i, relation in enumerate(self._relations[start:stop], start):
            if relation.same_as(value):
                return i
        raise ValueError("relation is not in the group")

    def __contains__(self, value: object) -> bool:
        return isinstance(value, SymmetryRelation) and any(r.same_as(value) for r in self)

    @cached_property
    def multiplication_table(self) -> NDArray[np.int64]:
        """Return indices of ``self[i] @ self[j]``, shape (order, order).

        Raises
        ------
        InputError
            If a product is not among the relations: they do not form a group.
        """
        linear = np.einsum("gij,hjk->ghik", self.A_sat, self.A_sat)
        offset = np.einsum("gij,hj->ghi", self.A_sat, self.d_sat) + self.d_sat[:, None]
        signs = self.Y[:, None] * self.Y[None]
        table = np.full((self.order, self.order), -1, dtype=np.int64)
        for index, relation in enumerate(self._relations):
            match = np.all(signs == relation.Y, axis=-1)
            match &= np.all(np.abs(linear - relation.A_sat) < 1e-6, axis=(-2, -1))
            match &= np.all(np.abs(wrap(offset - relation.d_sat)) < SAME_ANGLE, axis=-1)
            table[match] = index
        if np.any(table < 0):
            raise InputError("symmetry group", "products", "outside the list", "a closed list")
        return table

    @property
    def is_closed(self) -> bool:
        """Whether the relations form a group: all products are among them."""
        try:
            return bool(np.all(self.multiplication_table >= 0))
        except InputError:
            return False

    def level_set_symmetries(self) -> SymmetryGroup:
        """Return the subgroup with Y = I: same torque, not only the same up to signs."""
        return SymmetryGroup(r for r in self if np.all(r.Y == 1))


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
