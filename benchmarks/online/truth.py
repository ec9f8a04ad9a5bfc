"""A robot, its true torque, and the sets of configurations on which learners are tested."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.paper_targets import paper_targets
from isotorque.verify.models.target_sets import dense_targets

STABLE = 0.01
"""Least eigenvalue of the stiffness, as a share of the largest, of what counts as stable."""


@dataclass(frozen=True, eq=False)
class Truth:
    """A robot, its torque, its symmetries, and test sets by name.

    Attributes
    ----------
    robot, gravity, group
        The robot and what is true of it.
    sets : dict
        Configurations (m, n) [rad]: "dense" (1,500 of the whole torus), "stable" (those of them
        with a stable member in their orbit) and the paper's sets, named by their size.
    """

    robot: Robot
    gravity: GravityModel
    group: SymmetryGroup
    sets: dict[str, np.ndarray]

    @classmethod
    def of(cls, name: str) -> Truth:
        """A built-in robot with its test sets."""
        robot = load_robot(name)
        gravity = GravityModel(robot)
        group = primary_symmetries(gravity.potential)
        dense = dense_targets(robot.limits, samples=1500).q
        sets = {"dense": dense} | {str(len(t.q)): t.q for t in paper_targets(robot)}
        orbits = np.stack([relation.configuration(dense) for relation in group])
        stiffness = np.linalg.eigvalsh(gravity.stiffness(orbits))
        limit = STABLE * np.abs(stiffness).max()
        sets["stable"] = dense[(stiffness[..., 0] > limit).any(axis=0)]
        return cls(robot, gravity, group, sets)

    @property
    def torque_range(self) -> np.ndarray:
        """Largest torque of each joint on the dense set [N m]."""
        return np.asarray(np.abs(self.gravity.torque(self.sets["dense"])).max(axis=0))

    def error(self, learner: Any, name: str) -> float:
        """RMSE of a learner on one of the sets [N m]."""
        q = self.sets[name]
        return float(np.sqrt(np.mean((learner.predict(q) - self.gravity.torque(q)) ** 2)))
