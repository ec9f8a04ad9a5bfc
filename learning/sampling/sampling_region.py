"""A convex region of configurations to be sampled: a fundamental domain or a box."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.symmetry_coordinates import averaged_isometry
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SamplingRegion:
    """Polytope in coordinates w in which distances mean something, and the way back to q.

    Attributes
    ----------
    halfspaces : (f, r + 1) array
        Rows ``[a.., b]``: the region is ``a . w <= b``; the origin lies inside (every b > 0).
    vertices : (v, r) array
        Its corners.
    to_configuration : (n, r) array
        ``q = center + to_configuration @ w`` [rad].
    center : (n,) array
        Configuration [rad] at w = 0; free components stay there.
    volume : float
        Volume in w.

    Examples
    --------
    >>> region = SamplingRegion.of_box([[0.0, 2.0], [-1.0, 1.0]])
    >>> region.configurations(region.vertices).tolist()
    [[0.0, -1.0], [0.0, 1.0], [2.0, -1.0], [2.0, 1.0]]
    """

    halfspaces: Array
    vertices: Array
    to_configuration: Array
    center: Array
    volume: float

    @classmethod
    def of_domain(cls, domain: FundamentalDomain) -> SamplingRegion:
        """The BCTS of a symmetry group, in y = B q scaled such that the group acts by isometries.

        Raises
        ------
        InputError
            If the torque depends on no joint: there is nothing to sample.
        """
        group = domain.group
        if group.rank == 0:
            raise InputError("sampling region", "rank of the group", 0, "at least 1")
        isometry = averaged_isometry(group.A_sat)
        back = np.linalg.inv(isometry)
        offset = domain.basis @ domain.center
        rows = domain.halfspaces
        bounds = rows[:, -1] - rows[:, :-1] @ offset
        lift = np.linalg.inv(group.completion)[:, : group.rank]
        return cls(
            np.column_stack([rows[:, :-1] @ back, bounds]),
            (domain.vertices - offset) @ isometry.T,
            lift @ back,
            np.asarray(domain.center, dtype=float),
            domain.volume,  # the isometry has determinant 1
        )

    @classmethod
    def of_box(cls, limits: ArrayLike) -> SamplingRegion:
        """All configurations within limits (n, 2) [rad].

        Raises
        ------
        InputError
            If a lower limit is not below its upper one, or limits are no finite numbers.
        """
        box = np.asarray(limits, dtype=float)
        if box.ndim != 2 or box.shape[1] != 2 or not len(box):
            raise InputError("box", "shape", box.shape, "(n, 2)")
        if not (np.isfinite(box).all() and (box[:, 0] < box[:, 1]).all()):
            raise InputError("box", "limits", box.tolist(), "finite, the lower below the upper")
        half, identity = np.diff(box, axis=1)[:, 0] / 2, np.eye(len(box))
        rows = np.concatenate([-identity, identity])
        corners = np.array(list(itertools.product((-1.0, 1.0), repeat=len(box)))) * half
        return cls(
            np.column_stack([rows, np.tile(half, 2)]),
            corners,
            identity,
            box.mean(axis=1),
            float(np.prod(2 * half)),
        )

    @property
    def dimension(self) -> int:
        """Number of coordinates r."""
        return self.vertices.shape[1]

    def configurations(self, w: Array) -> Array:
        """Configurations (m, n) [rad] of points w (m, r)."""
        return np.asarray(self.center + w @ self.to_configuration.T)

    def gauge(self, w: Array) -> Array:
        """By how much the region, scaled about its centre, just reaches points (m, r): (m,).

        At most 1 inside.
        """
        return np.asarray((w @ (self.halfspaces[:, :-1] / self.halfspaces[:, -1:]).T).max(axis=1))

    def contains(self, w: Array) -> NDArray[np.bool_]:
        """Whether points (m, r) lie in the region, its boundary included."""
        return np.asarray(self.gauge(w) <= 1.0 + 1e-12)
