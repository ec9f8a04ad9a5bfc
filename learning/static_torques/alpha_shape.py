"""Region covered by a cloud of points: a Delaunay mesh without its long simplices."""

from __future__ import annotations

from itertools import combinations
from math import factorial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]
MAX_DIMENSION = 3


class AlphaShape:
    """Delaunay triangulation of points from which simplices with a long edge are cut away.

    Parameters
    ----------
    points : (N, r) array
        The cloud, 1 <= r <= 3, in coordinates where distances along all axes mean the same.
    edge_factor : float
        A simplex is kept if its longest edge is at most `edge_factor` times what nearly every point
        (95 %) needs to belong to some simplex.

    Raises
    ------
    InputError
        If r is not 1, 2 or 3.

    Notes
    -----
    The convex hull would admit bays and holes of a set that is not convex. Cutting by edge length
    is the alpha shape of [1]_ with the longest edge instead of the circumradius, which lets the
    flat simplices along a straight border stay. Points that span fewer than r dimensions cover
    nothing: `is_empty` says so.

    References
    ----------
    .. [1] H. Edelsbrunner, D. Kirkpatrick, R. Seidel, "On the shape of a set of points in the
       plane", IEEE Transactions on Information Theory 29 (1983).

    Examples
    --------
    >>> grid = np.stack(np.meshgrid(np.arange(7.0), np.arange(7.0)), axis=-1).reshape(-1, 2)
    >>> ring = grid[np.abs(grid - 3.0).max(axis=1) >= 2.0]
    >>> AlphaShape(ring, edge_factor=1.5).contains(np.array([[0.5, 0.5], [3.0, 3.0]])).tolist()
    [True, False]
    """

    def __init__(self, points: Array, edge_factor: float = 3.0) -> None:
        self.points = np.asarray(points, dtype=float)
        dimension = self.points.shape[1]
        if not 1 <= dimension <= MAX_DIMENSION:
            raise InputError("alpha shape", "dimension", dimension, "1, 2 or 3")
        self._order = np.argsort(self.points[:, 0]) if dimension == 1 else None
        self._mesh: Delaunay | None = None
        simplices = np.empty((0, dimension + 1), dtype=np.intp)
        if self._order is not None:
            simplices = np.stack([self._order[:-1], self._order[1:]], axis=1)
        elif len(self.points) > dimension:
            self._mesh = _mesh(self.points)
            if self._mesh is not None:
                simplices = self._mesh.simplices
        self.edge_limit, self._kept = _short_simplices(self.points, simplices, edge_factor)
        self.simplices = simplices[self._kept]

    @property
    def is_empty(self) -> bool:
        """Whether nothing is covered."""
        return len(self.simplices) == 0

    @property
    def volume(self) -> float:
        """Length, area or volume covered."""
        if self.is_empty:
            return 0.0
        corners = self.points[self.simplices]
        edges = corners[:, 1:] - corners[:, :1]
        return float(np.abs(np.linalg.det(edges)).sum() / factorial(edges.shape[1]))

    def contains(self, queries: Array) -> NDArray[np.bool_]:
        """Whether queries (m, r) lie in the region; shape (m,)."""
        queries = np.asarray(queries, dtype=float)
        if self.is_empty:
            return np.zeros(len(queries), dtype=bool)
        if self._order is not None:
            sorted_points = self.points[self._order, 0]
            right = np.searchsorted(sorted_points, queries[:, 0], side="left")
            at_first = queries[:, 0] == sorted_points[0]
            interval = np.where(at_first, 0, right - 1)
            inside = (interval >= 0) & (interval < len(self._kept))
            return inside & self._kept[np.clip(interval, 0, len(self._kept) - 1)]
        assert self._mesh is not None
        simplex = self._mesh.find_simplex(queries)
        return (simplex >= 0) & self._kept[simplex]


@single_thread()
def _mesh(points: Array) -> Delaunay | None:
    """Triangulation; None where the points span too few dimensions."""
    try:
        mesh = Delaunay(points)
    except QhullError:
        return None
    _ = mesh.transform  # small systems of equations, else solved when a query asks for them
    return mesh


def _short_simplices(
    points: Array, simplices: NDArray[np.intp], edge_factor: float
) -> tuple[float, NDArray[np.bool_]]:
    """Edge limit, and which simplices have no longer edge."""
    if len(simplices) == 0:
        return 0.0, np.zeros(0, dtype=bool)
    corners = points[simplices]
    longest = np.zeros(len(simplices))
    for i, j in combinations(range(simplices.shape[1]), 2):
        longest = np.maximum(longest, np.linalg.norm(corners[:, i] - corners[:, j], axis=1))
    needed = np.full(len(points), np.inf)
    np.minimum.at(needed, simplices, longest[:, None])
    needed = needed[np.isfinite(needed)]
    limit = edge_factor * float(np.quantile(needed, 0.95))
    return limit, longest <= limit
