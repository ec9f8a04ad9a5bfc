"""Canonical representatives: the point of each orbit in a Dirichlet cell, and the way there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.domains.dirichlet_cell import DirichletCell
from isotorque.symbolic.groups.affine_map_index import RelationLookup
from isotorque.symbolic.groups.torus_action import TorusAction
from isotorque.symbolic.lattices.integer_lattice import integer_inverse

ON_FACET = 1e-9
"""Points within this of a facet [rad] count as on it."""
SAME_COORDINATE = 1e-7
"""Representatives on the boundary whose coordinates differ by less [rad] are compared further."""


@dataclass(frozen=True, eq=False)
class Representatives:
    """Representatives of m points in a fundamental domain.

    Attributes
    ----------
    points : (m, r) array
        The representatives, ``A[element] w + d[element] + 2 pi turns`` [rad].
    element : (m,) int array
        Which map of the group leads there.
    turns : (m, r) int array
        Full turns added.
    closed : (m,) bool array
        Whether the point itself lies in the closed cell, up to full turns of y = scale w.
    """

    points: Floats
    element: Integers
    turns: Integers
    closed: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Crossings:
    """The maps that carry the neighbour cell beyond facet f onto the cell, as a lookup table.

    After relation g and ``turns``, crossing facet f gives relation ``element[f, g]`` and turns
    ``linear[f] turns + turns[f, g]``.
    """

    element: Integers  # (f, G)
    turns: Integers  # (f, G, r)
    linear: Integers  # (f, r, r)


class CanonicalMap:
    """Map of the points of R^r into the Dirichlet cell of a group modulo 2 pi.

    Parameters
    ----------
    cell
        The cell.
    action
        The group it belongs to.

    Raises
    ------
    InputError
        If the relations are not closed under composition.

    Notes
    -----
    A point is first brought near the centre by full turns (Babai rounding). While it lies beyond
    facets, the one that brings it nearest to the centre is crossed backwards; every crossing
    lowers the distance to the centre, so this ends, inside the cell. Relations and turns are
    tracked in integers and applied once to the original point: no rounding errors pile up.
    """

    def __init__(self, cell: DirichletCell, action: TorusAction) -> None:
        self._cell = cell
        self._A, self._d, self._scale = action.A, action.d, action.scale
        r = self._d.shape[1]
        lookup = RelationLookup(self._A.astype(np.int64), self._d)
        self._identity = int(lookup.find(np.eye(r, dtype=np.int64)[None], np.zeros((1, r)))[0])
        self._crossings = _crossing_table(cell, lookup, action)
        self._to_basis = np.linalg.inv(cell.basis.astype(float)) / TURN
        self._facet_length = np.sqrt(np.einsum("fi,fi->f", cell.normals, cell.normals))

    def representatives(self, w: Floats) -> Representatives:
        """Find the representatives of the points ``w`` (m, r)."""
        m, r = w.shape
        element = np.full(m, self._identity)
        turns = -np.rint((w - self._cell.center) @ self._to_basis).astype(np.int64)
        turns = turns @ self._cell.basis
        point = w + TURN * turns
        if r == 0 or m == 0:
            return Representatives(point, element, turns, np.ones(m, dtype=bool))
        excess = self._excess(point)
        active = np.flatnonzero((excess > ON_FACET * self._facet_length).any(axis=1))
        while len(active):
            facet = np.argmax(excess[active], axis=1)
            new_element, new_turns = self._cross(facet, element[active], turns[active])
            new_point = self._apply(w[active], new_element, new_turns)
            # offsets of learned relations may fit together only nearly: never go round in circles
            nearer = self._distance(new_point) < self._distance(point[active])
            active = active[nearer]
            element[active], turns[active] = new_element[nearer], new_turns[nearer]
            point[active] = new_point[nearer]
            excess[active] = self._excess(point[active])
            beyond = excess[active] > ON_FACET * self._facet_length
            active = active[beyond.any(axis=1)]
        closed = self._goes_nowhere(element, turns)
        edge = np.flatnonzero((np.abs(excess) <= ON_FACET * self._facet_length).any(axis=1))
        if len(edge):
            element[edge], turns[edge], closed[edge] = self._on_boundary(
                w[edge], element[edge], turns[edge]
            )
            point[edge] = self._apply(w[edge], element[edge], turns[edge])
        return Representatives(point, element, turns, closed)

    def _excess(self, point: Floats) -> Floats:
        return np.asarray(point @ self._cell.normals.T - self._cell.offsets)

    def _distance(self, point: Floats) -> Floats:
        away = point - self._cell.center
        return np.einsum("mi,ij,mj->m", away, self._cell.metric, away)

    def _goes_nowhere(self, element: Integers, turns: Integers) -> NDArray[np.bool_]:
        step = turns @ self._scale.T
        whole = (np.abs(step - np.rint(step)) < 1e-9).all(axis=1)
        return np.asarray((element == self._identity) & whole)

    def _apply(self, w: Floats, element: Integers, turns: Integers) -> Floats:
        still = element == self._identity
        moved = np.einsum("mij,mj->mi", self._A[element], w) + self._d[element]
        return np.where(still[:, None], w, moved) + TURN * turns

    def _cross(
        self, facet: Integers, element: Integers, turns: Integers
    ) -> tuple[Integers, Integers]:
        table = self._crossings
        onward = np.einsum("mij,mj->mi", table.linear[facet], turns)
        return table.element[facet, element], onward + table.turns[facet, element]

    def _on_boundary(
        self, w: Floats, element: Integers, turns: Integers
    ) -> tuple[Integers, Integers, NDArray[np.bool_]]:
        """Choose one of the equivalent boundary points: the last in lexicographic order.

        All members of the orbit in the closed cell are reached by crossing facets that the point
        lies on (the cells around a point hang together by facets).
        """
        owner = np.arange(len(w))
        ways = np.column_stack([owner, element, turns])
        points = self._apply(w, element, turns)
        fresh, fresh_points = ways, points
        while len(fresh):
            touching = np.abs(self._excess(fresh_points)) <= 2 * ON_FACET * self._facet_length
            row, facet = np.nonzero(touching)
            new_element, new_turns = self._cross(facet, fresh[row, 1], fresh[row, 2:])
            reached = np.unique(np.column_stack([fresh[row, 0], new_element, new_turns]), axis=0)
            fresh = _rows_not_in(reached, ways)
            fresh_points = self._apply(w[fresh[:, 0]], fresh[:, 1], fresh[:, 2:])
            inside = (self._excess(fresh_points) <= 2 * ON_FACET * self._facet_length).all(axis=1)
            fresh, fresh_points = fresh[inside], fresh_points[inside]
            ways = np.concatenate([ways, fresh])
            points = np.concatenate([points, fresh_points])
        closed = np.zeros(len(w), dtype=bool)
        closed[ways[self._goes_nowhere(ways[:, 1], ways[:, 2:]), 0]] = True
        # the identity first, so that a representative is its own representative
        rank = np.lexsort((ways[:, 1] != self._identity, ways[:, 0]))
        ways, points = ways[rank], points[rank]
        for coordinate in range(w.shape[1]):
            best = np.full(len(w), -np.inf)
            np.maximum.at(best, ways[:, 0], points[:, coordinate])
            keep = points[:, coordinate] >= best[ways[:, 0]] - SAME_COORDINATE
            ways, points = ways[keep], points[keep]
        first = np.searchsorted(ways[:, 0], owner)
        return ways[first, 1], ways[first, 2:], closed


def _rows_not_in(rows: Integers, known: Integers) -> Integers:
    """Return those of the distinct ``rows`` that are not rows of ``known``."""
    both = np.concatenate([known, rows])
    _, number = np.unique(both, axis=0, return_inverse=True)
    return rows[~np.isin(number[len(known) :], number[: len(known)])]


def _crossing_table(cell: DirichletCell, lookup: RelationLookup, action: TorusAction) -> _Crossings:
    """Tabulate the inverse of each facet's map, composed with every map of the group."""
    linear, d = action.A.astype(np.int64), action.d
    facets, (order, r) = len(cell.element), d.shape
    element = np.zeros((facets, order), dtype=np.int64)
    turns = np.zeros((facets, order, r), dtype=np.int64)
    back = np.zeros((facets, r, r), dtype=np.int64)
    for f, (g, z) in enumerate(zip(cell.element, cell.turns, strict=True)):
        back[f] = integer_inverse(linear[g])
        offsets = (d - d[g] - TURN * z) @ back[f].T
        element[f] = lookup.find(np.einsum("ij,gjk->gik", back[f], linear), offsets)
        turns[f] = np.rint((offsets - d[element[f]]) / TURN).astype(np.int64)
    return _Crossings(element, turns, back)
