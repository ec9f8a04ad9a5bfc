"""Reach and maintain: what the arm does with learned torques at the test targets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot

Array = NDArray[np.float64]


def maintained(robot: Robot, gravity: GravityModel, learner: Any, targets: Array) -> dict[str, Any]:
    """Place the arm at each target, apply the learned torque, and see where it is after 5 s.

    Parameters
    ----------
    robot, gravity
        The arm and its true torque.
    learner
        What was learned.
    targets
        Configurations (m, n) [rad].

    Returns
    -------
    dict
        ``targets`` (m, n), ``observed`` (m, n) [rad] and ``held`` (m,). Where the arm does not
        hold itself (the target is no stable equilibrium) ``observed`` is the equilibrium nearest
        to the target that the learned torque has: where it would stay if it could be balanced.
    """
    arm = SimulatedArm(robot, limits="none", home=SimulatedArm(robot).home)
    torques = np.asarray(learner.predict(targets))
    observed, held = [], []
    for q, torque in zip(targets, torques, strict=True):
        hold = arm.place_and_hold(q, torque)
        held.append(hold.held)
        observed.append(hold.q if hold.held else nearest_equilibrium(gravity, q, torque))
    return {"targets": targets, "observed": np.array(observed), "held": np.array(held)}


def nearest_equilibrium(gravity: GravityModel, q: Array, torque: Array) -> Array:
    """Return the configuration (n,) near ``q`` [rad] whose gravity torque is nearest to a torque.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> q = np.array([0.5, 0.4])
    >>> nearest_equilibrium(gravity, q + 0.01, gravity.torque(q)).round(6).tolist()
    [0.5, 0.4]
    """
    found = least_squares(lambda x: gravity.torque(x) - torque, q, gravity.stiffness)
    return np.asarray(found.x)


def copies_held(
    robot: Robot, gravity: GravityModel, learner: Any, targets: Array, domain: FundamentalDomain
) -> int:
    """Count the targets whose symmetric copy in the explored domain the arm maintains."""
    return int(maintained(robot, gravity, learner, domain.representatives(targets).q)["held"].sum())
