"""Share of a domain that has been explored so far."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.symbolic.common.compiled import compiled
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


class ExploredShare:
    """Share of a domain's points that some observation, or a symmetric copy of it, came near.

    Parameters
    ----------
    points : (m, n) array
        Points spread over the domain to be explored [rad], e.g. ``FundamentalDomain.sample``.
    radius : float
        A point is explored when an observation lies within this distance (in the metric of
        ``SymmetryCoordinates``) [rad].
    group : SymmetryGroup or None
        Relations; observations count with all their copies.

    Examples
    --------
    >>> share = ExploredShare(np.array([[0.0, 0.0], [2.0, 0.0]]), 0.3)
    >>> share.add(np.array([0.1, 0.1]))
    >>> share.value
    0.5
    """

    def __init__(self, points: Array, radius: float, group: GroupArrays | None = None) -> None:
        points = np.atleast_2d(np.asarray(points, dtype=float))
        if not radius > 0:
            raise InputError("explored share", "radius", radius, "a number > 0 [rad]")
        self._coordinates = SymmetryCoordinates.of(group, points.shape[1])
        self._points = np.ascontiguousarray(self._coordinates.coordinates(points))
        self._remaining = len(points)
        self._radius = float(radius)

    @property
    def value(self) -> float:
        """Share explored so far, 0 to 1."""
        return 1.0 - self._remaining / len(self._points)

    def add(self, q: Array) -> None:
        """Count the observed configuration (n,) [rad]."""
        if self._remaining:
            basis, A_sat, d_sat = (
                self._coordinates.basis,
                self._coordinates.A_sat,
                self._coordinates.d_sat,
            )
            images = A_sat @ (basis @ q) + d_sat
            self._remaining = _strike(
                self._points, self._remaining, images, self._coordinates.isometry, self._radius
            )


@compiled
def _strike(points, remaining, images, isometry, radius):
    """Swap the points near an image behind the first ``remaining`` ones; how many remain."""
    rank = points.shape[1]
    difference = np.empty(rank)
    number = 0
    while number < remaining:
        near = False
        for g in range(len(images)):
            for k in range(rank):
                turn = points[number, k] - images[g, k]
                difference[k] = turn - 2 * np.pi * np.floor(turn / (2 * np.pi) + 0.5)
            total = 0.0
            for i in range(rank):
                step = 0.0
                for j in range(i, rank):
                    step += isometry[i, j] * difference[j]
                total += step * step
            if total <= radius * radius:
                near = True
                break
        if near:
            remaining -= 1
            for k in range(rank):
                points[number, k], points[remaining, k] = (
                    points[remaining, k],
                    points[number, k],
                )
        else:
            number += 1
    return remaining
