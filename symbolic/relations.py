"""Symmetry relations q -> A q + d with torque signs Y, and the groups they form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.integer_lattice import saturation

Array = NDArray[np.float64]

SAME_ANGLE = 1e-6
"""Offsets that differ by less [rad] belong to one relation; distinct ones are far apart."""


def wrap(angle: ArrayLike) -> Array:
    """Return angles modulo 2 pi in (-pi, pi]; values within rounding of -pi are written pi.

    Examples
    --------
    >>> wrap([-np.pi, 3 * np.pi, 0.5])
    array([3.14159265, 3.14159265, 0.5       ])
    """
    x = np.asarray(angle, dtype=float)
    wrapped = x - 2 * np.pi * np.ceil((x - np.pi) / (2 * np.pi) - 1e-12)
    return np.where(wrapped > np.pi, np.pi, wrapped) + 0.0


@dataclass(frozen=True, eq=False)
class SymmetryRelation:
    """A map q -> A q + d under which the static torque only changes signs: g(A q + d) = Y g(q).

    Parameters
    ----------
    A : (n, n) array
        Linear part; integer for exact relations.
    d : (n,) array
        Offset [rad].
    Y : (n,) array
        Signs +1 or -1 of the torques.
    basis : (r, n) int array, optional
        Rows B such that the torque depends on q only through y = B q (theory.md, section 2);
        the identity by default. ``A`` must map y to y: B A = A_sat B.
    exact : bool
        Whether the relation is proved (with an exact d of which ``d`` is the rounding).
    bound : (n,) array, optional
        Bound on |g_i(A q + d) - Y_i g_i(q)| over all q [N m]; NaN where none is known.

    Notes
    -----
    The paper's form (Eq. 5) is ``M q_r + N q_s = rhs`` with ``M = -A_sat B``, ``N = B`` and
    ``rhs = d_sat`` (r rows, modulo 2 pi); at full rank ``-A q_r + q_s = d``.

    Examples
    --------
    >>> flip = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> flip.configuration([0.25, 0.5])
    array([-0.25,  1.  ])
    >>> (flip @ flip).is_identity
    True
    """

    A: Array
    d: Array
    Y: Array
    basis: NDArray[np.int64]
    exact: bool
    bound: Array

    def __init__(
        self,
        A: ArrayLike,
        d: ArrayLike,
        Y: ArrayLike,
        basis: ArrayLike | None = None,
        exact: bool = False,
        bound: ArrayLike | None = None,
    ) -> None:
        matrix = np.array(A, dtype=float)
        if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
            raise InputError("relation", "shape of A", matrix.shape, "(n, n)")
        n = len(matrix)
        offset, signs = np.array(d, dtype=float), np.array(Y, dtype=float)
        for name, vector in (("d", offset), ("Y", signs)):
            if vector.shape != (n,):
                raise InputError("relation", f"shape of {name}", vector.shape, f"({n},)")
        if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(offset))):
            raise InputError("relation", "A or d", "not finite", "finite numbers")
        if not np.all(np.abs(signs) == 1):
            raise InputError("relation", "Y", signs.tolist(), "signs +1 or -1")
        rows = np.eye(n, dtype=np.int64) if basis is None else np.array(basis, dtype=np.int64)
        if rows.ndim != 2 or rows.shape[1] != n:
            raise InputError("relation", "shape of basis", rows.shape, f"(r, {n})")
        limit = np.full(n, np.nan) if bound is None else np.array(bound, dtype=float)
        for name, value in (
            ("A", matrix),
            ("d", wrap(offset)),
            ("Y", signs),
            ("basis", rows),
            ("exact", bool(exact)),
            ("bound", limit),
        ):
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
            object.__setattr__(self, name, value)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.A)

    @cached_property
    def A_sat(self) -> Array:
        """Linear part in y = B q coordinates, shape (r, r)."""
        B = self.basis.astype(float)
        if len(B) == self.n and np.array_equal(self.basis, np.eye(self.n)):
            return self.A
        sat = B @ self.A @ np.linalg.pinv(B) if len(B) else np.zeros((0, 0))
        if len(B) and not np.allclose(sat @ B, B @ self.A, atol=1e-9):
            raise InputError("relation", "A", self.A.tolist(), "a map of y = B q (B A = A_sat B)")
        rounded = np.round(sat)
        return rounded if np.allclose(sat, rounded, atol=1e-9) else sat

    @cached_property
    def d_sat(self) -> Array:
        """Offset in y = B q coordinates, shape (r,), in (-pi, pi]."""
        return wrap(self.basis @ self.d)

    @property
    def M(self) -> Array:
        """Matrix M of the paper's Eq. 5, shape (r, n)."""
        return -self.A_sat @ self.basis + 0.0

    @property
    def N(self) -> Array:
        """Matrix N of the paper's Eq. 5, shape (r, n)."""
        return self.basis.astype(float)

    @property
    def rhs(self) -> Array:
        """Right-hand side d of the paper's Eq. 5, shape (r,) [rad], modulo 2 pi."""
        return self.d_sat

    def configuration(self, q: ArrayLike) -> Array:
        """Return the symmetric configuration A q + d of ``q`` (..., n) [rad], not wrapped."""
        return np.asarray(q, dtype=float) @ self.A.T + self.d

    def torque(self, tau: ArrayLike) -> Array:
        """Return the torque Y tau (..., n) that holds the symmetric configuration."""
        return np.asarray(tau, dtype=float) * self.Y

    def __matmul__(self, other: SymmetryRelation) -> SymmetryRelation:
        return SymmetryRelation(
            self.A @ other.A,
            self.A @ other.d + self.d,
            self.Y * other.Y,
            self.basis,
            self.exact and other.exact,
            self.bound + other.bound,
        )

    def inverse(self) -> SymmetryRelation:
        """Return the relation that leads back."""
        back = np.linalg.inv(self.A)
        rounded = np.round(back)
        if np.allclose(back, rounded, atol=1e-9):
            back = rounded + 0.0
        return SymmetryRelation(back, -back @ self.d, self.Y, self.basis, self.exact, self.bound)

    def same_as(self, other: SymmetryRelation, tolerance: float = SAME_ANGLE) -> bool:
        """Say whether both are one relation: equal Y and A_sat, d_sat equal modulo 2 pi."""
        return (
            np.array_equal(self.Y, other.Y)
            and self.A_sat.shape == other.A_sat.shape
            and bool(np.allclose(self.A_sat, other.A_sat, atol=1e-6))
            and bool(np.all(np.abs(wrap(self.d_sat - other.d_sat)) <= tolerance))
        )

    @property
    def is_identity(self) -> bool:
        """Whether the relation leaves y = B q and all torques as they are."""
        return (
            bool(np.all(self.Y == 1))
            and bool(np.allclose(self.A_sat, np.eye(len(self.basis)), atol=1e-9))
            and bool(np.all(np.abs(wrap(self.d_sat)) <= SAME_ANGLE))
        )

    def __str__(self) -> str:
        lines = []
        for i in range(self.n):
            row = " ".join(f"{x:+g} q{j + 1}" for j, x in enumerate(self.A[i]) if x) or "0"
            shift = f" {self.d[i]:+.6g}" if abs(self.d[i]) > 1e-12 else ""
            lines.append(f"q{i + 1}' = {row.removeprefix('+')}{shift}")
        signs = ", ".join(f"{int(y):+d}" for y in self.Y)
        return f"{'; '.join(lines)}; Y = diag({signs})"


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


def identity(n: int, basis: ArrayLike | None = None) -> SymmetryRelation:
    """Return the relation q -> q."""
    return SymmetryRelation(
        np.eye(n), np.zeros(n), np.ones(n), basis, exact=True, bound=np.zeros(n)
    )


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
