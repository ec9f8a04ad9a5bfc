"""The BCTS of a symmetry group: a convex fundamental domain with one point per orbit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.canonical_representatives import CanonicalMap
from isotorque.symbolic.domains.dirichlet_cell import DirichletCell, dirichlet_cell, tidy_halfspaces
from isotorque.symbolic.domains.generic_center import generic_center
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.groups.torus_action import TorusAction, torus_action


@dataclass(frozen=True, eq=False)
class CanonicalConfigurations:
    """Canonical representatives of configurations: one of each orbit, in the fundamental domain.

    Attributes
    ----------
    q : (..., n) array
        Representatives in the domain [rad]; free components as they were.
    relation : (...) int array
        Number, in the group, of the relation that leads from the given configuration there.
    turns : (..., r) int array
        ``B q = A_sat B q_given + d_sat + 2 pi turns`` with that relation's A_sat and d_sat.
    """

    q: Floats
    relation: Integers
    turns: Integers


class FundamentalDomain:
    """Bijective configuration-torque set (BCTS): one configuration per orbit of a group.

    Parameters
    ----------
    group : SymmetryGroup
        The symmetry relations; closed under composition.
    center : (n,) array, optional
        Configuration [rad] the domain lies around; every relation but the identity must move it.
        By default a point far from all of its images, the same for the same group each time.

    Raises
    ------
    InputError
        If the centre has the wrong length or is fixed (or moved by less than a milliradian) by a
        relation, if the relations are not closed, or are no maps of the torus y = B q.

    Notes
    -----
    In y = B q coordinates (rows of B: basis of the combinations of joints that the torque depends
    on) the group acts with the turns 2 pi Z^r. In the scalar product averaged over the group every
    relation is an isometry, so the points nearer to the centre than to any of its images form a
    convex polytope of volume (2 pi)^r / order that meets every orbit: in exactly one point in the
    interior; boundary points can have several equivalents on the boundary, of which
    `canonicalise` always picks the same one.

    The paper's name promises a bijection with absolute torques. Relations list only primary
    symmetries: where secondary ones exist, the domain holds more than one configuration for some
    absolute torques (2R arm: one or two).

    References
    ----------
    The paper, section 4.3.1 and Fig. 6.

    Examples
    --------
    The domain of the 2R arm is the paper's parallelogram q1 in [0, pi/2], q1 + q2 in [0, pi]:

    >>> from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
    >>> from isotorque.symbolic.groups.symmetry_group import close
    >>> arm = close([
    ...     SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1]),
    ...     SymmetryRelation([[1, 0], [-2, -1]], [0, 0], [1, 1]),
    ...     SymmetryRelation([[1, 0], [0, 1]], [np.pi, 0], [-1, -1]),
    ... ])
    >>> domain = FundamentalDomain(arm, [np.pi / 4, np.pi / 4])
    >>> domain.halfspaces.round(4).tolist()
    [[-1.0, 0.0, 0.0], [1.0, 0.0, 1.5708], [-1.0, -1.0, 0.0], [1.0, 1.0, 3.1416]]
    >>> q0, relation = domain.canonicalise([2.0, 0.3])
    >>> q0.round(4).tolist(), domain.contains(q0), relation.Y.tolist()
    ([1.1416, -0.3], True, [-1.0, -1.0])
    """

    def __init__(self, group: SymmetryGroup, center: ArrayLike | None = None) -> None:
        self.group = group
        self.basis: Integers = np.asarray(group.basis, dtype=np.int64)
        lift = np.linalg.inv(group.completion)[:, : group.rank]
        self._lift: Floats = np.where(np.abs(lift - np.rint(lift)) < 1e-9, np.rint(lift), lift)
        self._action: TorusAction = torus_action(group.A_sat, group.d_sat)
        if center is None:
            w = generic_center(self._action.A, self._action.d)
            self.center: Floats = self._lift @ self._action.scale @ w
        else:
            self.center = self._configurations(center)
            if self.center.shape != (group.n,):
                raise InputError(
                    "fundamental domain", "shape of centre", self.center.shape, f"({group.n},)"
                )
        self._from_y: Floats = np.asarray(np.linalg.inv(self._action.scale), dtype=float)
        self._cell: DirichletCell = dirichlet_cell(
            self._action.A, self._action.d, self._from_y @ self.basis @ self.center
        )
        self._map = CanonicalMap(self._cell, self._action)

    @classmethod
    def near(cls, group: SymmetryGroup, q: ArrayLike) -> FundamentalDomain:
        """Return the default domain, moved by the relation that brings it nearest to ``q``.

        For exploration that starts from a home posture: of the images of the default centre the
        one nearest to ``q`` (n,) [rad] becomes the centre, so ``q`` lies in the domain.
        """
        default = cls(group)
        home = default._configurations(q)
        found = default.representatives(home)
        g = int(found.relation)
        back = default.basis @ default.center - group.d_sat[g] - TURN * found.turns
        nearest = np.linalg.solve(group.A_sat[g], back)
        return cls(group, home + default._lift @ (nearest - default.basis @ home))

    # -- what it is -----------------------------------------------------------------------------

    @property
    def order(self) -> int:
        """Order of the group: the factor by which the domain is smaller than all configurations."""
        return self.group.order

    @property
    def halfspaces(self) -> Floats:
        """Rows ``[a.., b]`` with ``a . y <= b``, y = B q; shape (f, r + 1), none redundant."""
        return tidy_halfspaces(self._cell.normals @ self._from_y, self._cell.offsets)

    @property
    def vertices(self) -> Floats:
        """Corners in y = B q coordinates [rad], shape (v, r)."""
        corners = self._cell.vertices @ self._action.scale.T
        return np.where(np.abs(corners) < 1e-14, 0.0, corners)

    @property
    def volume(self) -> float:
        """Volume in y = B q coordinates, (2 pi)^r / order."""
        return float(TURN ** len(self.basis) / self.group.order)

    @cached_property
    def neighbours(self) -> tuple[SymmetryRelation, ...]:
        """For each half-space, the relation that maps the domain onto its neighbour beyond it."""
        relation, _ = self._relations(self._cell.element, self._cell.turns)
        return tuple(self.group[int(g)] for g in relation)

    # -- what it does ---------------------------------------------------------------------------

    def contains_y(self, y: ArrayLike, tolerance: float = 1e-9) -> NDArray[np.bool_]:
        """Say whether points ``y`` (..., r) satisfy all half-spaces, within ``tolerance`` [rad]."""
        rows = self.halfspaces
        points = np.asarray(y, dtype=float)
        return np.all(points @ rows[:, :-1].T <= rows[:, -1] + tolerance, axis=-1)

    def contains(self, q: ArrayLike) -> Any:
        """Say whether configurations lie in the domain, its boundary included.

        Parameters
        ----------
        q : (..., n) array
            Configurations [rad]; full turns make no difference.

        Returns
        -------
        bool or (...) bool array

        Notes
        -----
        `contains_y` asks the same of the polytope itself, without full turns.
        """
        points = self._configurations(q)
        found = self._map.representatives(self._flat_y(points) @ self._from_y.T)
        closed = found.closed.reshape(points.shape[:-1])
        return closed if points.ndim > 1 else bool(closed)

    def representatives(self, q: ArrayLike) -> CanonicalConfigurations:
        """Fold configurations ``q`` (..., n) [rad] into the domain.

        Returns
        -------
        CanonicalConfigurations
            Representatives, the relations that lead there, and the full turns added.

        Raises
        ------
        InputError
            If a configuration has the wrong length or is not finite.
        """
        points = self._configurations(q)
        y = self._flat_y(points)
        found = self._map.representatives(y @ self._from_y.T)
        relation, turns = self._relations(found.element, found.turns)
        shape = points.shape[:-1]
        step = found.points @ self._action.scale.T - y
        step[(relation == 0) & ~turns.any(axis=1)] = 0.0  # already there: exactly
        return CanonicalConfigurations(
            (points.reshape(-1, self.group.n) + step @ self._lift.T).reshape(points.shape),
            relation.reshape(shape),
            turns.reshape(*shape, y.shape[1]),
        )

    def canonicalise(self, q: ArrayLike) -> tuple[Floats, Any]:
        """Return the representative of each configuration's orbit, and the relation to it.

        Parameters
        ----------
        q : (..., n) array
            Configurations [rad].

        Returns
        -------
        q0 : (..., n) array
            Members of the domain; components along free directions are left alone.
        relation : SymmetryRelation, or (...) object array of them
            ``relation.configuration(q)`` is q0 up to full turns (and free directions), and
            ``relation.torque(g(q))`` is g(q0).

        Notes
        -----
        The same for every member of an orbit, also on the boundary; a representative is its own
        representative. `representatives` returns index arrays and the full turns instead
        of relations.
        """
        found = self.representatives(q)
        if found.relation.ndim == 0:
            return found.q, self.group[int(found.relation)]
        return found.q, self._members[found.relation]

    def sample(self, rng: np.random.Generator, m: int) -> Floats:
        """Draw ``m`` configurations uniformly from the domain, shape (m, n) [rad].

        Uniform in y = B q; components along free directions are those of the centre. (Points are
        drawn from the whole torus and replaced by representatives: relations preserve volume.)
        """
        inside = self._map.representatives(rng.uniform(-np.pi, np.pi, (m, len(self.basis)))).points
        y = inside @ self._action.scale.T
        return np.asarray(self.center + (y - self.basis @ self.center) @ self._lift.T)

    # -- helpers --------------------------------------------------------------------------------

    @cached_property
    def _members(self) -> NDArray[Any]:
        members = np.empty(self.group.order, dtype=object)
        members[:] = list(self.group)
        return members

    def _relations(self, element: Integers, turns: Integers) -> tuple[Integers, Integers]:
        return self._action.relations(self.group.d_sat, element, turns)

    def _configurations(self, q: ArrayLike) -> Floats:
        points = np.asarray(q, dtype=float)
        if points.shape[-1:] != (self.group.n,):
            raise InputError(
                "fundamental domain", "shape of q", points.shape, f"(..., {self.group.n})"
            )
        if not np.isfinite(points).all():
            raise InputError("fundamental domain", "q", "not finite", "finite angles [rad]")
        return points

    def _flat_y(self, points: Floats) -> Floats:
        return np.asarray(points.reshape(-1, self.group.n) @ self.basis.T, dtype=float)
