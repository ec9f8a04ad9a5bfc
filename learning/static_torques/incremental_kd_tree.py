"""Points that come and go one by one, with nearest-neighbour queries in between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from isotorque.symbolic.common.compiled import compiled
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

SCANNED = 40_000
"""Coordinates that are compared one by one, in compiled code: some 20 us, as a tree takes."""


class GrowingPoints:
    """A k-d tree whose points can be added and removed.

    Parameters
    ----------
    dimension : int
        Number of coordinates of a point.

    Notes
    -----
    Few points are compared with a query one by one. For many there is a k-d tree. It is built once
    and cannot change, so the newest points wait in a list that is searched by brute force, and
    removed ones are skipped; when either exceeds an eighth of the tree, it is built anew. N changes
    therefore cost O(N log N) in total: some microseconds each.

    Examples
    --------
    >>> points = GrowingPoints(2)
    >>> left, right = points.append(np.array([0.0, 0.0])), points.append(np.array([1.0, 0.0]))
    >>> distance, index = points.nearest(np.array([[0.9, 0.0]]))
    >>> int(index[0]) == right
    True
    >>> points.remove(right)
    >>> int(points.nearest(np.array([[0.9, 0.0]]))[1][0]) == left
    True
    """

    def __init__(self, dimension: int) -> None:
        self._dimension = dimension
        self._store = np.empty((32, dimension))
        self._present = np.zeros(32, dtype=bool)
        self._end = 0
        self._count = 0
        self._tree: cKDTree | None = None
        self._tree_indices = np.empty(0, dtype=np.intp)
        self._tree_end = 0
        self._removed_from_tree = 0

    def __len__(self) -> int:
        """How many points there are."""
        return self._count

    def __getitem__(self, index: int) -> Array:
        """Point at an index given by `append`."""
        return self._store[index]

    @property
    def indices(self) -> NDArray[np.intp]:
        """Indices of the points present, oldest first."""
        return np.flatnonzero(self._present[: self._end])

    @property
    def points(self) -> Array:
        """All points present, oldest first, shape (N, dimension)."""
        return self._store[self.indices]

    def append(self, point: Array) -> int:
        """Add one point (dimension,); returns its index."""
        if self._end == len(self._store):
            self._store = np.concatenate([self._store, np.empty_like(self._store)])
            self._present = np.concatenate([self._present, np.zeros_like(self._present)])
        self._store[self._end] = point
        self._present[self._end] = True
        self._end += 1
        self._count += 1
        return self._end - 1

    def remove(self, index: int) -> None:
        """Remove a point by the index that `append` gave."""
        self._removed_from_tree += bool(self._present[index] and index < self._tree_end)
        self._count -= bool(self._present[index])
        self._present[index] = False

    def scale(self, factors: Array) -> None:
        """Multiply all points by `factors` (dimension,)."""
        self._store[: self._end] *= factors
        self._tree, self._tree_end, self._removed_from_tree = None, 0, 0

    def nearest(self, queries: Array) -> tuple[Array, NDArray[np.intp]]:
        """Nearest point of each query.

        Parameters
        ----------
        queries : (m, dimension) array

        Returns
        -------
        distances : (m,) array
            Euclidean distances; infinite where there are no points.
        indices : (m,) array of int
            Indices of the points; -1 where there are none.

        Raises
        ------
        InputError
            If the queries do not have the points' dimension.
        """
        queries = np.asarray(queries, dtype=float)
        if queries.ndim != 2 or queries.shape[1] != self._dimension:
            accepted = f"(m, {self._dimension})"
            raise InputError("nearest point", "shape of queries", queries.shape, accepted)
        if queries.size * self._end <= SCANNED:
            return _scan(self._store, self._present, self._end, queries)
        changes = max(self._end - self._tree_end, self._removed_from_tree)
        if changes > max(32, len(self._tree_indices) // 8):
            self._build_tree()
        distances, indices = self._nearest_in_tree(queries)
        if self._tree_end == self._end:
            return distances, indices
        waiting = self._tree_end + np.flatnonzero(self._present[self._tree_end : self._end])
        if len(waiting):
            difference = queries[:, None, :] - self._store[waiting][None, :, :]
            squared = np.einsum("mwi,mwi->mw", difference, difference)
            best = squared.argmin(axis=1)
            found = np.sqrt(squared[np.arange(len(queries)), best])
            closer = found < distances
            distances = np.where(closer, found, distances)
            indices = np.where(closer, waiting[best], indices)
        return distances, indices

    def _build_tree(self) -> None:
        self._tree_indices = self.indices
        self._tree = cKDTree(self.points) if len(self._tree_indices) else None
        self._tree_end = self._end
        self._removed_from_tree = 0

    def _nearest_in_tree(self, queries: Array) -> tuple[Array, NDArray[np.intp]]:
        distances = np.full(len(queries), np.inf)
        indices = np.full(len(queries), -1, dtype=np.intp)
        if self._tree is None:
            return distances, indices
        if not self._removed_from_tree:
            distances, position = self._tree.query(queries)
            return np.asarray(distances), self._tree_indices[position]
        left = np.arange(len(queries))  # queries that met removed points only so far
        size, k = len(self._tree_indices), 1
        while len(left):
            answer = self._tree.query(queries[left], k=np.arange(1, k + 1))
            found, position = np.asarray(answer[0]), np.asarray(answer[1])
            index = self._tree_indices[position]
            present = self._present[index]
            first = present.argmax(axis=1)
            done = present.any(axis=1)
            rows = np.flatnonzero(done)
            distances[left[rows]] = found[rows, first[rows]]
            indices[left[rows]] = index[rows, first[rows]]
            if k == size:
                break
            left, k = left[~done], min(4 * k, size)
        return distances, indices


@compiled
def _scan(store, present, end, queries):
    """Compare each query with every point present among the first ``end``."""
    distances = np.full(len(queries), np.inf)
    indices = np.full(len(queries), -1, dtype=np.intp)
    for row in range(len(queries)):
        least = np.inf
        for index in range(end):
            if present[index]:
                squared = 0.0
                for axis in range(queries.shape[1]):
                    difference = queries[row, axis] - store[index, axis]
                    squared += difference * difference
                if squared < least:
                    least = squared
                    indices[row] = index
        distances[row] = np.sqrt(least)
    return distances, indices
