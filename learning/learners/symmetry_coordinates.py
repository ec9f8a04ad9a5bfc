"""Coordinates of a symmetry group for learners: copies of a sample, the invariant distance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


class GroupArrays(Protocol):
    """The arrays of a symmetry group that learners use (``SymmetryGroup``).

    Attributes
    ----------
    basis : (r, n) array
        Integer matrix B; the torque depends on q only through y = B q.
    A_sat, d_sat : (G, r, r) and (G, r) arrays
        Every relation as ``y' = A_sat y + d_sat`` [rad].
    Y : (G, n) array
        Signs of the torques: the torque at y' is ``Y * tau``.
    """

    @property
    def basis(self) -> Any:
        """See above."""
        ...

    @property
    def A_sat(self) -> Any:
        """See above."""
        ...

    @property
    def d_sat(self) -> Any:
        """See above."""
        ...

    @property
    def Y(self) -> Any:
        """See above."""
        ...


@dataclass(frozen=True, eq=False)
class SymmetryCoordinates:
    """Coordinates in which a symmetry group acts by isometries.

    A configuration q becomes ``y = B q`` on the torus (free directions drop out), and distances
    are measured as ``|L dy|`` where ``L^T L`` is the average of ``A_sat^T A_sat`` over the group,
    scaled to determinant 1: every relation keeps this distance, so a symmetric copy of a sample
    is as far from its neighbours as the sample itself (docs/theory.md).

    Attributes
    ----------
    basis : (r, n) array
        Integer matrix B.
    A_sat, d_sat, Y : (G, r, r), (G, r), (G, n) arrays
        The relations; without symmetries the identity alone (G = 1).
    isometry : (r, r) array
        Upper triangular L, determinant 1.

    Examples
    --------
    >>> plain = SymmetryCoordinates.of(None, 2)
    >>> plain.copies(np.array([[0.1, 4.0]]), np.array([[1.0, 2.0]]))[0].round(3).tolist()
    [[[0.1, -2.283]]]
    """

    basis: Array
    A_sat: Array
    d_sat: Array
    Y: Array
    isometry: Array

    @classmethod
    def of(cls, group: GroupArrays | None, joints: int) -> SymmetryCoordinates:
        """Coordinates of ``group`` (None: no symmetries) for an arm with ``joints`` joints.

        Raises
        ------
        InputError
            If the group belongs to another number of joints.
        """
        if group is None:
            identity = np.eye(joints)
            return cls(
                identity, identity[None], np.zeros((1, joints)), np.ones((1, joints)), identity
            )
        basis = np.ascontiguousarray(group.basis, dtype=float)
        if basis.ndim != 2 or basis.shape[1] != joints:
            raise InputError(
                "symmetry group", "number of joints", basis.shape[-1], f"{joints}, as in the data"
            )
        A_sat = np.ascontiguousarray(group.A_sat, dtype=float)
        return cls(
            basis,
            A_sat,
            np.ascontiguousarray(group.d_sat, dtype=float),
            np.ascontiguousarray(group.Y, dtype=float),
            averaged_isometry(A_sat),
        )

    @property
    def order(self) -> int:
        """How many samples one sample becomes."""
        return len(self.A_sat)

    @property
    def rank(self) -> int:
        """Number of coordinates r."""
        return len(self.basis)

    def coordinates(self, q: Array) -> Array:
        """``y = B q`` of configurations (..., n) [rad], wrapped, shape (..., r)."""
        return wrap(np.asarray(q, dtype=float) @ self.basis.T)

    def copies(self, q: Array, torque: Array) -> tuple[Array, Array]:
        """All symmetric copies of samples.

        Parameters
        ----------
        q : (m, n) array
            Configurations [rad].
        torque : (m, n) array
            Torques [N m].

        Returns
        -------
        y : (G, m, r) array
            Coordinates of the copies [rad], wrapped.
        torque : (G, m, n) array
            Torques of the copies [N m].
        """
        y = np.asarray(q, dtype=float) @ self.basis.T
        images = np.einsum("gij,mj->gmi", self.A_sat, y) + self.d_sat[:, None]
        return wrap(images), self.Y[:, None] * np.asarray(torque, dtype=float)

    def distance(self, y1: Array, y2: Array) -> Array:
        """Invariant distance of coordinates (..., r), the difference wrapped by components."""
        difference = wrap(np.asarray(y1) - np.asarray(y2)) @ self.isometry.T
        return np.asarray(np.linalg.norm(difference, axis=-1))

    def to_arrays(self) -> dict[str, Array]:
        """The group as arrays, to be saved with a model."""
        return {
            "group_basis": self.basis,
            "group_A_sat": self.A_sat,
            "group_d_sat": self.d_sat,
            "group_Y": self.Y,
        }


@dataclass(frozen=True, eq=False)
class SavedGroup:
    """A symmetry group as read back from a saved model: nothing but its arrays."""

    basis: Array
    A_sat: Array
    d_sat: Array
    Y: Array

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Array]) -> SavedGroup:
        """Inverse of ``SymmetryCoordinates.to_arrays``."""
        return cls(*(np.asarray(arrays[f"group_{k}"]) for k in ("basis", "A_sat", "d_sat", "Y")))


def averaged_isometry(A_sat: Array) -> Array:
    """Upper triangular L, det L = 1, with ``|L A y| = |L y|`` for every A of the group.

    Parameters
    ----------
    A_sat : (G, r, r) array
        Linear parts of a finite group (closed under composition).

    Returns
    -------
    (r, r) array

    Notes
    -----
    ``L^T L`` is proportional to ``sum A^T A``: replacing A by A A' permutes the terms, hence
    every A' leaves the sum invariant. Learned groups whose A are not exactly closed give a
    distance that is invariant to the same accuracy.
    """
    metric = np.einsum("gki,gkj->ij", A_sat, A_sat) / len(A_sat)
    rank = len(metric)
    metric = metric / np.linalg.det(metric) ** (1.0 / rank)
    return np.ascontiguousarray(np.linalg.cholesky(metric).T)
