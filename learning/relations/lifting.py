"""Relations in y = B q coordinates written as maps of all joint angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from learning.relations.candidate_group import CandidateGroup
from symbolic.integer_lattice import saturation
from symbolic.relations import SymmetryRelation

Array = NDArray[np.float64]


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
