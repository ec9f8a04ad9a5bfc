"""Time for which a slightly wrong constant torque holds an arm where nothing is stable."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.published import RMSE_66
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.paper_targets import paper_targets

Array = NDArray[np.float64]

TARGETS = 66
ERRORS = (1e-2, 1e-3, 1e-4, 1e-5)
"""Torque errors that the growth is fitted to [N m]; above rounding, below nonlinear terms."""
COARSE, LONGEST, HALVINGS = 0.5, 30.0, 6
"""Seconds between looks at the arm, seconds it is watched, and how often a gap is halved."""


def measure_holding(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Put the arm on each of the 66 targets with the exact torque, and with torques a little off.

    An arm at rest in an unstable equilibrium stays there under the exact torque, for nothing
    disturbs a simulated arm. An error of the torque grows exponentially: the time within 0.05 rad
    is linear in the logarithm of the error, and its slope follows the damping.

    Parameters
    ----------
    robot
        The 2R arm, or one with other masses.
    seed
        Of the directions of the errors.
    effort
        Plays no part: this takes a second.
    """
    gravity = GravityModel(robot)
    [q] = [targets.q for targets in paper_targets(robot) if len(targets.q) == TARGETS]
    exact = gravity.torque(q)
    home = SimulatedArm(robot).home
    arm = SimulatedArm(robot, limits="none", home=home)
    damped = SimulatedArm(
        robot, limits="none", home=home, damping=2.0 * np.array(arm.settings.damping)
    )
    directions = np.random.default_rng(seed).normal(size=q.shape)
    directions /= np.linalg.norm(directions, axis=1)[:, np.newaxis]

    def median_seconds(body: SimulatedArm, error: float) -> float:
        torques = exact + error * directions
        held = [seconds_held(body, *pair) for pair in zip(q, torques, strict=True)]
        return float(np.median(held))

    def slope(body: SimulatedArm) -> float:
        seconds = [median_seconds(body, error) for error in ERRORS]
        return float(np.polyfit(-np.log10(ERRORS), seconds, 1)[0])

    held = [arm.place_and_hold(*pair).held for pair in zip(q, exact, strict=True)]
    return Measured(
        {
            "held_exact": int(np.sum(held)),
            "seconds": median_seconds(arm, RMSE_66),
            "seconds_per_tenfold": slope(arm),
            "seconds_per_tenfold_damped": slope(damped),
        }
    )


def seconds_held(arm: SimulatedArm, q: Array, torque: Array) -> float:
    """Return the seconds that a torque (n,) [N m] keeps an arm within 0.05 rad of q (n,) [rad].

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> arm, q = SimulatedArm(load_robot("pendulum")), np.array([np.pi / 2])
    >>> exact = GravityModel(load_robot("pendulum")).torque(q)
    >>> seconds_held(arm, q, exact + 1e-2) < seconds_held(arm, q, exact + 1e-4)
    True
    """
    last = 0.0
    while last < LONGEST:
        gap = COARSE
        if not arm.place_and_hold(q, torque, seconds=last + gap).held:
            for _ in range(HALVINGS):
                gap /= 2.0
                if arm.place_and_hold(q, torque, seconds=last + gap).held:
                    last += gap
            return last
        last += gap
    return LONGEST
