"""Instantaneous Topological Map: nodes and edges that grow with correlated stimuli."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

FIRST_ROOM = 64


class TopologicalMap:
    """Nodes spread over what was visited, with edges between neighbours (ITM).

    Parameters
    ----------
    spacing : float
        e_max: a stimulus farther than this from the nearest node can become a node [rad].
    adaptation : float
        Share of the way to the stimulus that the nearest node moves; 0 keeps nodes where they
        appeared, as prototypes of a local linear map must.
    group : SymmetryGroup or None
        Distances are those the group leaves invariant, in the coordinates y = B q.

    Notes
    -----
    For every stimulus with nearest node n and second nearest s (Jockusch and Ritter):

    1. n moves towards the stimulus by the share ``adaptation``.
    2. n and s are joined by an edge. Every edge from n to an m such that s lies inside the Thales
       sphere over n and m is removed: s is between them. A node without edges is removed.
    3. A stimulus outside the Thales sphere over n and s, and farther than ``spacing`` from n,
       becomes a node, joined to n. If n and s are less than half of ``spacing`` apart, s goes.

    The paper organises the prototypes of its local linear map in this way (section 5.3.1). Prefer
    it to look at what has been explored, or for neighbours where a cell list would be too large
    (many dimensions); the local linear map here uses a cell list, which is exact and faster.

    References
    ----------
    Jockusch, Ritter (1999), "An instantaneous topological mapping model for correlated stimuli",
    IJCNN.

    Examples
    --------
    >>> path = TopologicalMap(0.25)
    >>> for angle in np.arange(0.0, 1.01, 0.1):
    ...     node = path.adapt([angle])
    >>> path.nodes.ravel().round(1).tolist(), path.edges.tolist()
    ([0.0, 0.3, 0.6, 0.9], [[0, 1], [1, 2], [2, 3]])
    """

    def __init__(
        self, spacing: float, *, adaptation: float = 0.0, group: GroupArrays | None = None
    ) -> None:
        if not (np.isfinite(spacing) and spacing > 0):
            raise InputError("topological map", "spacing", spacing, "a number > 0 [rad]")
        if not 0 <= adaptation <= 1:
            raise InputError("topological map", "adaptation", adaptation, "0 to 1")
        self.spacing = float(spacing)
        self.adaptation = float(adaptation)
        self._group = group
        self._coordinates: SymmetryCoordinates | None = None
        self._count = 0
        self._neighbours: list[set[int]] = []

    def __len__(self) -> int:
        """Number of nodes."""
        return self._count

    @property
    def nodes(self) -> Array:
        """Coordinates of the nodes [rad], shape (M, r)."""
        return self._y[: self._count].copy() if self._count else np.zeros((0, 0))

    @property
    def edges(self) -> NDArray[np.int64]:
        """Pairs of joined nodes, each once and in order, shape (E, 2)."""
        pairs = [(i, j) for i, joined in enumerate(self._neighbours) for j in joined if i < j]
        return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)

    def neighbours(self, node: int) -> tuple[int, ...]:
        """Nodes joined to ``node``, in order."""
        return tuple(sorted(self._neighbours[node]))

    def adapt(self, q: Any) -> int:
        """Take in a stimulus, a configuration (n,) [rad]; the node now nearest to it.

        Raises
        ------
        InputError
            If the configuration has another length than before or is not finite.
        """
        y = self._checked(q)
        if self._count == 0:
            return self._add(y)
        away = self._away(y)
        squared = np.einsum("ij,ij->i", away, away)
        if self._count == 1:
            if squared[0] <= self.spacing**2:
                self._move(0, y)
                return 0
            new = self._add(y)
            self._join(0, new)
            return new
        first, second = (int(i) for i in np.argpartition(squared, 1)[:2])
        if squared[second] < squared[first]:
            first, second = second, first
        self._move(first, y)
        away[first] *= 1.0 - self.adaptation
        squared[first] *= (1.0 - self.adaptation) ** 2
        self._join(first, second)
        lonely = self._cut_behind(first, away - away[second], second)
        outside = float(away[first] @ away[second]) > 0.0
        gap = away[first] - away[second]
        nearest = first
        if outside and squared[first] > self.spacing**2:
            nearest = self._add(y)
            self._join(first, nearest)
        if float(gap @ gap) < (0.5 * self.spacing) ** 2:
            lonely.append(second)
        for node in sorted(set(lonely), reverse=True):
            nearest = self._remove(node, nearest)
        return nearest

    def nearest(self, q: Any, start: int | None = None) -> int:
        """The node nearest to a configuration (n,) [rad].

        Parameters
        ----------
        q
            Configuration.
        start
            Walk from this node along edges to ever nearer ones, which may end at a local minimum;
            without it all nodes are compared.
        """
        y = self._checked(q)
        if not self._count:
            raise InputError("topological map", "number of nodes", 0, "at least one stimulus")
        if start is None:
            away = self._away(y)
            return int(np.argmin(np.einsum("ij,ij->i", away, away)))
        here, best = start, self._distance(start, y)
        while True:
            steps = [(self._distance(j, y), j) for j in self.neighbours(here)]
            if not steps or min(steps)[0] >= best:
                return here
            best, here = min(steps)

    def near(self, q: Any, radius: float) -> tuple[int, ...]:
        """Nodes within ``radius`` [rad] of a configuration that edges join to the nearest one."""
        y = self._checked(q)
        first = self.nearest(q)
        if self._distance(first, y) > radius:
            return ()
        seen, queue = {first}, deque([first])
        while queue:
            for node in self._neighbours[queue.popleft()]:
                if node not in seen and self._distance(node, y) <= radius:
                    seen.add(node)
                    queue.append(node)
        return tuple(sorted(seen))

    def _checked(self, q: Any) -> Array:
        angles = np.asarray(q, dtype=float)
        if self._coordinates is None:
            if angles.ndim != 1 or not len(angles):
                raise InputError("topological map", "shape of a stimulus", angles.shape, "(n,)")
            self._coordinates = SymmetryCoordinates.of(self._group, len(angles))
            self._y = np.zeros((FIRST_ROOM, self._coordinates.rank))
        joints = self._coordinates.basis.shape[1]
        if angles.shape != (joints,) or not np.isfinite(angles).all():
            raise InputError("topological map", "stimulus", angles, f"{joints} finite angles")
        return self._coordinates.coordinates(angles)

    def _away(self, y: Array) -> Array:
        """Offsets (M, r) of all nodes from y, in isometric coordinates."""
        assert self._coordinates is not None
        return np.asarray(wrap(self._y[: self._count] - y) @ self._coordinates.isometry.T)

    def _distance(self, node: int, y: Array) -> float:
        assert self._coordinates is not None
        return float(self._coordinates.distance(self._y[node], y))

    def _cut_behind(self, node: int, from_second: Array, second: int) -> list[int]:
        """Cut the node's edges that have ``second`` in their Thales sphere; nodes left alone."""
        lonely = []
        for other in self.neighbours(node):
            if other != second and float(from_second[node] @ from_second[other]) < 0.0:
                self._neighbours[node].discard(other)
                self._neighbours[other].discard(node)
                if not self._neighbours[other]:
                    lonely.append(other)
        return lonely

    def _move(self, node: int, y: Array) -> None:
        if self.adaptation:
            step = self.adaptation * wrap(y - self._y[node])
            self._y[node] = wrap(self._y[node] + step)

    def _add(self, y: Array) -> int:
        if self._count == len(self._y):
            self._y = np.concatenate([self._y, np.zeros_like(self._y)])
        self._y[self._count] = y
        self._neighbours.append(set())
        self._count += 1
        return self._count - 1

    def _join(self, a: int, b: int) -> None:
        self._neighbours[a].add(b)
        self._neighbours[b].add(a)

    def _remove(self, node: int, follow: int) -> int:
        """Remove a node; the last one takes its number. The new number of node ``follow``."""
        for other in self._neighbours[node]:
            self._neighbours[other].discard(node)
        last = self._count - 1
        self._y[node] = self._y[last]
        self._neighbours[node] = self._neighbours[last]
        self._neighbours.pop()
        for other in self._neighbours[node] if node != last else ():
            self._neighbours[other].discard(last)
            self._neighbours[other].add(node)
        self._count = last
        return node if follow == last else follow
