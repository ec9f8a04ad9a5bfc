"""Relations that may form a group, as arrays; offsets exact or estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symbolic.relations import wrap

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_OFFSET = 0.3
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
        near = np.abs(wrap(self.d)).max(axis=1, initial=0.0) < SAME_OFFSET
        linear = (np.abs(self.A - np.eye(self.d.shape[1])) < 1e-6).all(axis=(1, 2))
        return near & linear & (self.Y == 1.0).all(axis=1)

    def products(self, tolerance: float = SAME_OFFSET) -> tuple[NDArray[np.intp], Array]:
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

    def composed(self, tolerance: float = SAME_OFFSET) -> CandidateGroup | None:
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
