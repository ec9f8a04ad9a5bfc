"""Coordinates of the representatives of configurations, with the signs of their torques."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.symmetry_coordinates import GroupArrays
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]


class CanonicalCoordinates:
    """One representative per orbit: what is learned there answers everywhere.

    Parameters
    ----------
    group : GroupArrays
        A symmetry group, or its arrays as read back from a saved model.

    Raises
    ------
    InputError
        If the relations do not form a group.

    Notes
    -----
    Exactly equivariant in the interior of the domain and, as boundary points have one
    representative too, everywhere. The coordinates are continuous, but what a learner makes of them
    need not be: across the faces of the domain the estimate may jump by its error there.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> turn = SimpleNamespace(
    ...     basis=np.eye(1), A_sat=np.ones((2, 1, 1)), d_sat=np.array([[0.0], [np.pi]]),
    ...     Y=np.array([[1.0], [-1.0]]),
    ... )
    >>> y, signs, _ = CanonicalCoordinates(turn).of(np.array([[0.5], [0.5 + np.pi]]))
    >>> bool(abs(y[0] - y[1]) < 1e-12), bool(signs[0] == -signs[1])
    (True, True)
    """

    def __init__(self, group: GroupArrays) -> None:
        self._group = symmetry_group(group)
        self._domain = FundamentalDomain(self._group)

    @property
    def domain(self) -> FundamentalDomain:
        """The fundamental domain."""
        return self._domain

    def of(self, q: Array) -> tuple[Array, Array, Array]:
        """Find the representatives of configurations (m, n) [rad].

        Returns
        -------
        y : (m, r) array
            Coordinates of the representatives, relative to the centre of the domain [rad].
        signs : (m, n) array
            The torque of the configuration is ``signs`` times that of its representative.
        linear : (m, r, r) array
            Derivative of y by the coordinates of the configuration.
        """
        representatives = self._domain.representatives(q)
        y = (representatives.q - self._domain.center) @ self._domain.basis.T
        return (
            y,
            self._group.Y[representatives.relation],
            self._group.A_sat[representatives.relation],
        )


def symmetry_group(group: GroupArrays) -> SymmetryGroup:
    """The group as relations, given its arrays only.

    Of the maps of q that do what A_sat and d_sat do to y = B q, the ones that leave the
    complement of B's rows alone are taken.
    """
    if isinstance(group, SymmetryGroup):
        return group
    basis = np.asarray(group.basis, dtype=float)
    back = np.linalg.pinv(basis)
    rest = np.eye(basis.shape[1]) - back @ basis
    return SymmetryGroup(
        SymmetryRelation(back @ A @ basis + rest, back @ d, Y, np.rint(basis).astype(np.int64))
        for A, d, Y in zip(group.A_sat, group.d_sat, group.Y, strict=True)
    )
