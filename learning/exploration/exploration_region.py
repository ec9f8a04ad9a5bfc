"""Convex region to explore: quick membership, and the nearest point of the region."""

from __future__ import annotations

import itertools
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.symbolic.common.compiled import compiled

Array = NDArray[np.float64]

TOLERANCE = 1e-9
"""Points this far outside [rad] still count as inside."""

SWEEPS = 200
"""Most rounds of projections; each costs one step per half-space."""


class Polytope(Protocol):
    """Domain as exploration needs it (``FundamentalDomain``)."""

    @property
    def halfspaces(self) -> Any:
        """Rows ``[a.., b]``: ``a . y <= b`` with y = B q."""
        ...

    @property
    def group(self) -> Any:
        """The symmetry group, for its coordinates and its distance."""
        ...

    @property
    def center(self) -> Any:
        """A configuration inside (n,) [rad]."""
        ...


class ExplorationRegion:
    """A fundamental domain as exploration uses it.

    Parameters
    ----------
    domain : Polytope
        The BCTS with its half-spaces.

    Notes
    -----
    Same set as ``domain.contains`` up to ``TOLERANCE``, an order of magnitude faster, as nothing
    is folded. Full turns make no difference.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> group = SimpleNamespace(
    ...     basis=np.eye(2), A_sat=np.eye(2)[None], d_sat=np.zeros((1, 2)), Y=np.ones((1, 2))
    ... )
    >>> square = np.array([[1.0, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1]])
    >>> region = ExplorationRegion(
    ...     SimpleNamespace(halfspaces=square, group=group, center=np.zeros(2))
    ... )
    >>> region.contains(np.array([0.5, 2 * np.pi])), region.nearest(np.array([3.0, 0.5])).tolist()
    (True, [1.0, 0.5])
    """

    def __init__(self, domain: Polytope) -> None:
        rows = np.asarray(domain.halfspaces, dtype=float)
        basis = np.asarray(domain.group.basis, dtype=float)
        coordinates = SymmetryCoordinates.of(domain.group, basis.shape[1])
        self._basis = basis
        self._lift = np.linalg.pinv(basis)
        self._center = basis @ np.asarray(domain.center, dtype=float)
        self._isometry = coordinates.isometry
        back = np.linalg.inv(self._isometry)
        normals = rows[:, :-1] @ back
        lengths = np.linalg.norm(normals, axis=1)
        self._back = back
        self._normals = np.ascontiguousarray(normals / lengths[:, None])
        self._bounds = rows[:, -1] / lengths
        rank = len(basis)
        turns = np.array(list(itertools.product((0, 1, -1), repeat=rank)), dtype=float)
        order = np.argsort(np.abs(turns).sum(axis=1), kind="stable")
        self._turns = 2 * np.pi * turns[order] @ self._isometry.T

    def contains(self, q: Array) -> bool:
        """Whether q (n,) [rad] lies in the region, up to full turns."""
        return bool(self._excess(self._point(q)).max(axis=1).min() <= TOLERANCE)

    def nearest(self, q: Array) -> Array:
        """The configuration (n,) [rad] of the region nearest to q in the group's distance."""
        z = self._point(q)
        worst = self._excess(z).max(axis=1)
        turn = self._turns[int(np.argmin(worst))]
        if worst.min() <= TOLERANCE:
            return np.array(q, dtype=float)
        moved = _project(self._normals, self._bounds, z + turn) - (z + turn)
        return np.asarray(q + self._lift @ (self._back @ moved))

    def _point(self, q: Array) -> Array:
        """Isometric coordinates of q in the turn of the region's centre."""
        y = self._basis @ q
        y = y - 2 * np.pi * np.round((y - self._center) / (2 * np.pi))
        return np.asarray(self._isometry @ y)

    def _excess(self, z: Array) -> Array:
        """By how much each half-space is violated, for z and its neighbouring turns."""
        return np.asarray((z + self._turns) @ self._normals.T - self._bounds)


@compiled
def _project(normals, bounds, point):
    """Nearest point of a polytope by Dykstra's cyclic projections (for half-spaces: Hildreth's)."""
    faces, rank = normals.shape
    result = point.copy()
    pushed = np.zeros(faces)
    for _ in range(SWEEPS):
        change = 0.0
        for f in range(faces):
            excess = pushed[f] - bounds[f]
            for k in range(rank):
                excess += normals[f, k] * result[k]
            push = max(excess, 0.0)
            step = pushed[f] - push
            for k in range(rank):
                result[k] += step * normals[f, k]
            change = max(change, abs(step))
            pushed[f] = push
        if change < 1e-12:
            break
    return result
