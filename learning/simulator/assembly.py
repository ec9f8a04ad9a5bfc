"""Friction, limits and home of a simulated arm: as asked for, as in the robot file, or found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.simulator.checks import not_negative, vector
from isotorque.learning.simulator.default_damping import default_damping
from isotorque.learning.simulator.dynamics.engine import Body
from isotorque.learning.simulator.dynamics.equations import Array, Equations
from isotorque.learning.simulator.dynamics.free_directions import (
    FreeDirections,
    find_free_directions,
)
from isotorque.learning.simulator.dynamics.home import STABLE, find_home
from isotorque.learning.simulator.dynamics.mass_matrix_check import check_mass_matrix
from isotorque.learning.simulator.dynamics.step_control import RESIDUAL
from isotorque.learning.simulator.settings import PhysicsMode
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import check_limits
from isotorque.symbolic.robots.load_robot import Robot

_COULOMB_SHARE = 0.01  # of each joint's stiffness scale, which is about its largest gravity torque


@dataclass(frozen=True, eq=False)
class Assembly:
    """A robot made ready to move.

    Attributes
    ----------
    body : Body
        Friction, limits and free directions.
    free : FreeDirections
        What gravity does not feel.
    home : (n,) array
        Home configuration [rad].
    """

    body: Body
    free: FreeDirections
    home: Array


def assemble(
    robot: Robot,
    equations: Equations,
    physics: PhysicsMode,
    damping: ArrayLike | None,
    coulomb: ArrayLike | None,
    limits: ArrayLike | str | None,
    home: ArrayLike | None,
) -> Assembly:
    """Make a robot ready to move.

    Parameters
    ----------
    robot
        The robot.
    equations
        Its equations of motion.
    physics
        Physics mode.
    damping, coulomb, limits, home
        As in `SimulatedArm`.

    Raises
    ------
    InputError
        For numbers that cannot be used, a singular mass matrix, limits that exclude home, a home
        that the arm cannot hold.
    """
    check_mass_matrix(equations, robot.name, robot.joint_names)
    free = find_free_directions(equations)
    chosen_damping = _damping(robot, equations, free, damping)
    chosen_limits = _limits(robot, limits)
    body = Body(
        damping=chosen_damping,
        coulomb=_coulomb(robot, free, physics, coulomb),
        limits=chosen_limits,
        anchor=free.anchor(chosen_damping),
        nudge=free.nudge(),
        residual=RESIDUAL * free.torque_scale,
    )
    return Assembly(body, free, _home(robot, equations, free, chosen_limits, physics, home))


def _damping(
    robot: Robot, equations: Equations, free: FreeDirections, damping: ArrayLike | None
) -> Array:
    if damping is not None:
        return not_negative(robot.name, "damping", damping, robot.n, " [N m s/rad]")
    computed = default_damping(equations, free.stiffness_scale)
    return np.where(robot.damping > 0.0, robot.damping, computed)


def _coulomb(
    robot: Robot, free: FreeDirections, physics: PhysicsMode, coulomb: ArrayLike | None
) -> Array:
    if physics is not PhysicsMode.GEARED:
        if coulomb is not None and np.any(np.asarray(coulomb) != 0):
            raise InputError(robot.name, "coulomb", coulomb, "no Coulomb friction but in 'geared'")
        return np.zeros(robot.n)
    if coulomb is not None:
        return not_negative(robot.name, "coulomb", coulomb, robot.n, " [N m]")
    named = np.array(robot.model.upperDryFrictionLimit, dtype=float)
    return np.where(
        np.isfinite(named) & (named > 0.0), named, _COULOMB_SHARE * free.stiffness_scale
    )


def _limits(robot: Robot, limits: ArrayLike | str | None) -> Array:
    n = robot.n
    if limits is None or (isinstance(limits, str) and limits == "file"):
        check_limits(robot.limits, robot.joint_names, robot.name, "to move the arm")
        return np.array(robot.limits, dtype=float)
    if isinstance(limits, str):
        if limits == "none":
            return np.tile([-np.inf, np.inf], (n, 1))
        raise InputError(robot.name, "limits", limits, "'file', 'none' or an array (n, 2) [rad]")
    array = np.array(limits, dtype=float)
    accepted = f"{n} rows of a lower and a greater upper joint limit [rad]"
    if array.shape != (n, 2):
        raise InputError(robot.name, "limits", f"of shape {array.shape}", accepted)
    wrong = np.flatnonzero(~(array[:, 0] < array[:, 1]))
    if len(wrong):
        j = wrong[0]
        field = f"limits of joint '{robot.joint_names[j]}'"
        raise InputError(robot.name, field, array[j].tolist(), accepted)
    return array


def _home(
    robot: Robot,
    equations: Equations,
    free: FreeDirections,
    limits: Array,
    physics: PhysicsMode,
    home: ArrayLike | None,
) -> Array:
    must_hold = physics is not PhysicsMode.GUIDED
    if home is None:
        found, stiffness = find_home(equations, free, limits)
        if must_hold and stiffness < STABLE:
            raise InputError(
                robot.name,
                "limits",
                limits.tolist(),
                "limits with a home that a constant torque can hold, or guided physics",
            )
        return found
    chosen = vector(robot.name, "home", home, robot.n, " [rad]")
    outside = np.flatnonzero(~((limits[:, 0] < chosen) & (chosen < limits[:, 1])))
    if len(outside):
        j = outside[0]
        raise InputError(
            robot.name,
            f"home of joint '{robot.joint_names[j]}'",
            chosen[j],
            f"an angle strictly between its limits {limits[j].tolist()} [rad]",
        )
    if must_hold and free.active_stiffness(equations.stiffness(chosen)) < STABLE:
        raise InputError(
            robot.name,
            "home",
            chosen.tolist(),
            "a configuration that a constant torque can hold (positive-definite stiffness)",
        )
    return chosen
