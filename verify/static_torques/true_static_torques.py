"""The true set of static torques of an arm: which torques some configuration needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.stability import is_stable

Array = NDArray[np.float64]

CONFIGURATIONS = 60_000
"""Random configurations whose torques are searched from."""
STARTS = 4
ITERATIONS = 25
SOLVED = 1e-9
"""Torques this near, relative to the largest there is, are equal."""
SLACK = 1e-9
"""Configurations this little beyond a limit are at it [rad]."""


class TrueStaticTorques:
    """Torques g(q) of the configurations q within joint limits.

    Parameters
    ----------
    gravity
        The gravity torque.
    limits
        Joint limits (n, 2) [rad]; infinite where a joint has none. Along free directions, where
        gravity feels nothing, they are not looked at.
    stable_only
        Whether only configurations count at which an arm rests without a controller.
    rng
        Source of the configurations that are searched from.
    configurations
        Their number.

    Raises
    ------
    InputError
        If the limits have the wrong shape or order.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> arm = load_robot("pendulum")
    >>> truth = TrueStaticTorques(GravityModel(arm), arm.limits, configurations=100)
    >>> largest = float(GravityModel(arm).potential.gradient_bound()[0])
    >>> truth.reached([[0.9 * largest], [1.1 * largest]]), truth.holds([0.9 * largest])
    (array([ True, False]), True)
    >>> print(round(float(truth.distance([[1.1 * largest]])[0] / largest), 3))
    0.1
    """

    def __init__(
        self,
        gravity: GravityModel,
        limits: ArrayLike,
        *,
        stable_only: bool = True,
        rng: np.random.Generator | None = None,
        configurations: int = CONFIGURATIONS,
    ) -> None:
        box = np.asarray(limits, dtype=float)
        if box.shape != (gravity.n, 2) or not (box[:, 0] <= box[:, 1]).all():
            accepted = f"({gravity.n}, 2), lower <= upper [rad]"
            raise InputError("static torques", "limits", box.tolist(), accepted)
        self._gravity, self._stable_only = gravity, stable_only
        self._potential = gravity.potential.to_float()
        self._group = primary_symmetries(gravity.potential)
        free = self._group.free_directions.any(axis=0)
        unlimited = free | (box[:, 1] - box[:, 0] >= 2.0 * np.pi - SLACK)
        self._low = np.where(unlimited, -np.pi, box[:, 0])
        self._high = np.where(unlimited, np.pi, box[:, 1])
        self._size = float(np.abs(self._potential.gradient_bound()).max())
        rng = np.random.default_rng(0) if rng is None else rng
        q = rng.uniform(self._low, self._high, (configurations, gravity.n))
        self._q = q[self._counts(q)]
        self._torques = gravity.torque(self._q)
        self._tree = KDTree(self._torques)

    @property
    def torques(self) -> Array:
        """Torques of random configurations that count, shape (m, n) [N m]."""
        return self._torques

    def reached(self, torques: ArrayLike) -> NDArray[np.bool_]:
        """Say for which torques (m, n) a configuration is found that needs them.

        True is certain. False is not, but rare within the set: Newton's method found none from
        the configurations with the nearest torques; `holds` makes sure.
        """
        wanted = np.asarray(torques, dtype=float)
        found = np.zeros(len(wanted), dtype=bool)
        for start in self._nearest(wanted):
            ask = np.flatnonzero(~found)
            q = self._solved(start[ask], wanted[ask])
            miss = np.abs(self._gravity.torque(q) - wanted[ask]).max(axis=1, initial=0.0)
            found[ask] = (miss <= SOLVED * self._size) & self._counts(q)
        return found

    def holds(self, torque: ArrayLike) -> bool:
        """Say whether any configuration needs a torque (n,), by its level set."""
        wanted = np.asarray(torque, dtype=float)
        found = level_set(self._potential, wanted, group=self._group).with_torque(wanted)
        return bool(self._counts(found.configurations).any())

    def distance(self, torques: ArrayLike) -> Array:
        """Return an upper bound of the distance of torques (m, n) from the set, (m,) [N m].

        The distance from the torque of a configuration that counts, the nearest one found.
        """
        wanted = np.asarray(torques, dtype=float)
        best = np.full(len(wanted), np.inf)
        for start in self._nearest(wanted):
            for q in (start, self._solved(start, wanted)):
                away = np.linalg.norm(self._gravity.torque(q) - wanted, axis=1)
                best = np.where(self._counts(q), np.minimum(best, away), best)
        return best

    def _nearest(self, torques: Array) -> list[Array]:
        """Configurations to start from, STARTS arrays of shape (m, n)."""
        if not len(self._q) or not len(torques):
            return []
        starts = min(STARTS, len(self._q))
        _, index = self._tree.query(torques, k=starts)
        return [self._q[i] for i in np.reshape(index, (len(torques), starts)).T]

    def _solved(self, q: Array, torques: Array) -> Array:
        """Reduce |g(q) - torque| by damped Newton steps within the limits, each row on its own."""
        q = q.copy()
        miss = self._gravity.torque(q) - torques
        damping = np.full(len(q), 1e-6 * self._size**2)
        unit = np.eye(q.shape[1])
        for _ in range(ITERATIONS):
            stiffness = self._gravity.stiffness(q)
            normal = stiffness @ stiffness + damping[:, None, None] * unit
            step = np.linalg.solve(normal, (stiffness @ miss[:, :, None]))[:, :, 0]
            moved = np.clip(q - step, self._low, self._high)
            after = self._gravity.torque(moved) - torques
            better = np.linalg.norm(after, axis=1) < np.linalg.norm(miss, axis=1)
            q[better], miss[better] = moved[better], after[better]
            damping = np.where(better, 0.1 * damping, 10.0 * damping) + 1e-15 * self._size**2
        return q

    def _counts(self, q: Array) -> NDArray[np.bool_]:
        """Which configurations (m, n) are within the limits, and stable where that is asked."""
        middle = 0.5 * (self._low + self._high)
        half = 0.5 * (self._high - self._low)
        inside = np.asarray((np.abs(wrap(q - middle)) <= half + SLACK).all(axis=1))
        return inside & is_stable(q, self._gravity) if self._stable_only else inside
