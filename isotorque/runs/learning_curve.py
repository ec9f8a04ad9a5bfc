"""Learning curves: the error of a model while samples come in, on the dense test set."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.registry import ONLINE_LEARNERS
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.target_sets import dense_targets
from isotorque.verify.models.verify_model import torque_rmse

Array = NDArray[np.float64]

CURVE_POINTS = 40
"""Points of the learning curve of an online learner."""
FIRST_FIT = 8
"""First point of the curve of a batch learner; the next ones double it: each costs a fit."""


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """The model after some samples: torque error on the dense set, and share of BCTS explored.

    Attributes
    ----------
    samples : int
        Samples learned from.
    rmse, largest : float
        Torque RMSE, and largest error of any joint, on the dense set [N m].
    explored : float or None
        Share of the BCTS within the exploration's radius of what was learned from.
    """

    samples: int
    rmse: float
    largest: float
    explored: float | None = None


class DenseTest:
    """The dense test set of a robot with its true torques.

    Parameters
    ----------
    robot, gravity
        The robot and the truth about it.
    """

    def __init__(self, robot: Robot, gravity: GravityModel) -> None:
        self._q: Array = dense_targets(robot.limits).q
        self._torque = gravity.torque(self._q)
        self._active = [name not in gravity.free_joints for name in robot.joint_names]

    def point(self, samples: int, learner: Any, explored: float | None = None) -> CurvePoint:
        """Test a learner that has seen so many samples, at every joint."""
        error = learner.predict(self._q) - self._torque
        largest = float(np.abs(error).max())
        return CurvePoint(samples, torque_rmse(error, self._active), largest, explored)


def curve_counts(learner: str, total: int) -> frozenset[int]:
    """Return the numbers of samples at which a learner of that name is tested.

    Examples
    --------
    >>> sorted(curve_counts("network", 50))
    [8, 16, 32, 50]
    >>> sorted(curve_counts("local-linear-map", 81))[:3]
    [2, 4, 6]
    """
    if learner in ONLINE_LEARNERS:
        every = max(1, total // CURVE_POINTS)
        return frozenset({*range(every, total + 1, every), total})
    counts, count = {total}, FIRST_FIT
    while count < total:
        counts.add(count)
        count *= 2
    return frozenset(counts)
