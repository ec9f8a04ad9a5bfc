"""Relations that may form a group, as arrays; offsets exact or estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.lattices.integer_lattice import saturation

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_ESTIMATED_OFFSET = 0.3
"""Offsets of one A and Y that differ by less [rad] are estimates of one offset."""


@dataclass(frozen=True, eq=False)
class CandidateGroup:
    """Relations y -> A y + d in y = B q coordinates that may form a group.

    Attributes
    ----------
    basis : (r, n) int array
        B.
    A : (G, r, r) array
        Linear parts.
    d : (G, r) array
        Offsets [rad], exact or estimated.
    Y : (G, n) array
        Torque signs.
    """

    basis: Ints
    A: Array
    d: Array
    Y: Array

    def __len__(self) -> int:
        """Order."""
        return len(self.Y)

    def take(self, keep: NDArray[np.bool_] | NDArray[np.intp]) -> CandidateGroup:
        """Some of the relations."""
        return CandidateGroup(self.basis, self.A[keep], self.d[keep], self.Y[keep])

    def is_identity(self) -> NDArray[np.bool_]:
        """Which of the relations are the identity, shape (G,)."""
        near = np.abs(wrap(self.d)).max(axis=1, initial=0.0) < SAME_ESTIMATED_OFFSET
        linear = (np.abs(self.A - np.eye(self.d.shape[1])) < 1e-6).all(axis=(1, 2))
        return near & linear & (self.Y == 1.0).all(axis=1)

    def products(self, tolerance: float = SAME_ESTIMATED_OFFSET) -> tuple[NDArray[np.intp], Array]:
        """Multiplication table (G, G), -1 where a product is missing, and its defects.

        The defect of (i, j), shape (G, G, r), is A_i d_j + d_i - d_ij [rad]: how far the estimated
        offsets miss the composition law.
        """
        A = np.einsum("gij,hjk->ghik", self.A, self.A)
        d = np.einsum("gij,hj->ghi", self.A, self.d) + self.d[:, None]
        Y = self.Y[:, None] * self.Y[None]
        table = np.full((len(self), len(self)), -1, dtype=np.intp)
        defects = np.zeros(d.shape)
        nearest = np.full(table.shape, tolerance)
        for index in range(len(self)):
            defect = wrap(d - self.d[index])
            size = np.abs(defect).max(axis=-1, initial=0.0)
            match = (self.Y[index] == Y).all(axis=-1) & (size < nearest)
            match &= (np.abs(A - self.A[index]) < 1e-6).all(axis=(-2, -1))
            table[match], nearest[match] = index, size[match]
            defects[match] = defect[match]
        return table, defects

    def composed(self, tolerance: float = SAME_ESTIMATED_OFFSET) -> CandidateGroup | None:
        """Same relations with offsets that obey the composition law, or None if not closed.

        `tolerance` is how far the given offsets may miss it [rad].

        Notes
        -----
        The defects c(i, j) are a 2-cocycle; d_i - mean over j of c(i, j) composes exactly. Small
        errors of the offsets are averaged over the group, which is the joint refinement under
        d_ij = A_i d_j + d_i.
        """
        table, defects = self.products(tolerance)
        if (table < 0).any():
            return None
        return CandidateGroup(self.basis, self.A, wrap(self.d - defects.mean(axis=1)), self.Y)


MAX_ORDER = 256


def completed(group: CandidateGroup, same: float = SAME_ESTIMATED_OFFSET) -> CandidateGroup | None:
    """Add all products.

    Parameters
    ----------
    group : CandidateGroup
        Some relations.
    same : float
        Offsets that differ by less are estimates of one [rad].

    Returns
    -------
    CandidateGroup or None
        The identity first, offsets composing exactly. None if the products never end or give one
        configuration two torques (Y is not a homomorphism): the relations do not belong together.

    Examples
    --------
    >>> half_turn = CandidateGroup(np.eye(1, dtype=np.int64), np.eye(1)[None],
    ...                            np.array([[3.14]]), np.array([[-1.0]]))
    >>> whole = completed(half_turn)
    >>> len(whole), (whole.d / np.pi).round(12).ravel().tolist()
    (2, [0.0, 1.0])
    """
    n, joints = group.d.shape[1], group.Y.shape[1]
    A, d, Y = np.eye(n)[None], np.zeros((1, n)), np.ones((1, joints))
    position = 0
    while position < len(A):
        products = group.A @ A[position]
        shifts = wrap(group.A @ d[position] + group.d)
        flips = group.Y * Y[position]
        for linear, offset, signs in zip(products, shifts, flips, strict=True):
            alike = (linear == A).all(axis=(1, 2))
            alike &= (np.abs(wrap(d - offset)) < same).all(axis=1)
            if (Y[alike] != signs).any():
                return None
            if not alike.any():
                A = np.concatenate([A, linear[None]])
                d = np.concatenate([d, offset[None]])
                Y = np.concatenate([Y, signs[None]])
                if len(A) > MAX_ORDER:
                    return None
        position += 1
    return CandidateGroup(group.basis, A, d, Y).composed(same)


def lifted_relations(group: CandidateGroup, bounds: Array | None = None) -> list[SymmetryRelation]:
    """Relations q -> A q + d that act as the group on y = B q and leave free directions alone.

    Parameters
    ----------
    group : CandidateGroup
    bounds : (G, n) array, optional
        Bounds on the torque error of each relation [N m].

    Examples
    --------
    >>> one = CandidateGroup(np.array([[0, 1]]), -np.eye(1)[None], np.ones((1, 1)), np.ones((1, 2)))
    >>> print(lifted_relations(one)[0])
    q1' = 1 q1; q2' = -1 q2 +1; Y = diag(+1, +1)
    """
    rank, n = group.basis.shape
    _, completion = saturation(group.basis)
    V = completion.astype(float)
    V[:rank] = group.basis
    inverse = np.round(np.linalg.inv(V))
    relations = []
    for i in range(len(group)):
        block = np.eye(n)
        block[:rank, :rank] = group.A[i]
        A = np.round(inverse @ block @ V)
        d = inverse[:, :rank] @ group.d[i]
        bound = None if bounds is None else bounds[i]
        relations.append(SymmetryRelation(A, d, group.Y[i], group.basis, False, bound))
    return relations
