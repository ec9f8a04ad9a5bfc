"""Body of a simulated arm, and tests that leave its state alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.assembly import assemble
from isotorque.learning.simulator.checks import positive, table, vector, within
from isotorque.learning.simulator.dynamics.engine import Motions
from isotorque.learning.simulator.dynamics.equations import Array, Equations
from isotorque.learning.simulator.engines import new_engine, new_equations
from isotorque.learning.simulator.results import Hold, Release, SimulationSettings
from isotorque.learning.simulator.sensors import Sensors
from isotorque.learning.simulator.settings import (
    EngineName,
    PhysicsMode,
    SensorNoise,
    SettleMode,
    SettleRule,
    choice,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import Robot


class SimulatedBody:
    """A robot with friction, limits, sensors and an engine that moves it.

    Parameters as of `SimulatedArm`, which adds where the arm is.
    """

    def __init__(
        self,
        robot: Robot,
        physics: str | PhysicsMode,
        engine: str | EngineName,
        *,
        damping: ArrayLike | None,
        coulomb: ArrayLike | None,
        limits: ArrayLike | str | None,
        home: ArrayLike | None,
        settle: str | SettleMode,
        rule: SettleRule | None,
        noise: SensorNoise | None,
        rng: np.random.Generator | None,
    ) -> None:
        self.robot = robot
        self.physics = choice(PhysicsMode, robot.name, "physics", physics)
        self.engine = choice(EngineName, robot.name, "engine", engine)
        self.rule = rule or SettleRule(mode=choice(SettleMode, robot.name, "settle", settle))
        self.noise = noise or SensorNoise()
        equations = new_equations(self.engine, robot.model)
        assembly = assemble(robot, equations, self.physics, damping, coulomb, limits, home)
        self._body = assembly.body
        self._home = assembly.home
        self._projector = assembly.free.projector if assembly.free.any else None
        self._sensors = Sensors(robot.name, self.noise, assembly.free.projector, rng)
        self._engine = new_engine(self.engine, robot.model, self._body, self.rule)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.robot.n

    @property
    def equations(self) -> Equations:
        """Equations of motion of the arm, for tests and judges: no learner may ask them."""
        return self._engine.equations

    @property
    def damping(self) -> Array:
        """Viscous damping (n,) [N m s/rad]."""
        return self._body.damping.copy()

    @property
    def limits(self) -> Array:
        """Joint limits (n, 2) [rad]."""
        return self._body.limits.copy()

    @property
    def home(self) -> Array:
        """Home configuration (n,) [rad]."""
        return self._home.copy()

    @property
    def settings(self) -> SimulationSettings:
        """Everything beside the robot that decides what this arm does."""
        return SimulationSettings(
            self.physics,
            self.engine,
            tuple(self._body.damping.tolist()),
            tuple(self._body.coulomb.tolist()),
            tuple((low, high) for low, high in self._body.limits.tolist()),
            tuple(self._home.tolist()),
            self.rule,
            self.noise,
        )

    def place_and_hold(
        self, q: ArrayLike, torque: ArrayLike, seconds: float = 5.0, tolerance: float = 0.05
    ) -> Hold:
        """Test whether a torque reaches and maintains a configuration.

        The arm starts at rest at q (n,) [rad], the torque (n,) [N m] is applied for ``seconds``,
        and the arm must then be within ``tolerance`` [rad] of q. A test made on the side, in every
        physics mode: the arm's own state is not touched.

        Raises
        ------
        InputError
            For angles outside the limits or a torque that cannot be used.
        """
        start = self._inside("q", q)
        command = self._command(torque)
        seconds = positive(self.robot.name, "seconds", seconds, " [s]")
        motion = self._engine.wait(start, np.zeros(self.n), command, seconds)
        distance = float(np.linalg.norm(motion.q - start))
        if motion.kind is OutcomeKind.LIMIT:
            distance = np.inf
        return Hold(distance < tolerance, distance, motion.q)

    def release_test(
        self, q: ArrayLike, torque: ArrayLike, acceleration: float | None = None
    ) -> Release:
        """Test whether a torque balances a configuration, stable or not.

        The arm is placed at rest at q (n,) [rad], the torque (n,) [N m] is applied, and no joint
        may at first accelerate faster than ``acceleration`` [rad/s^2] (by default the settle
        rule's). A test made on the side: the arm's own state is not touched.

        Raises
        ------
        InputError
            For angles or a torque that cannot be used.
        """
        start = vector(self.robot.name, "q", q, self.n, " [rad]")
        bound = self.rule.acceleration if acceleration is None else acceleration
        first = self._engine.acceleration(start, np.zeros(self.n), self._command(torque))
        return Release(first, bool((abs(first) <= bound).all()))

    def settle_each(self, starts: ArrayLike, torques: ArrayLike) -> Motions:
        """Settle from rest at many starts (m, n) [rad], each under its own torque (m, n) [N m].

        One compiled call, for tests and evaluations: no noise, the arm's own state is not touched.

        Raises
        ------
        InputError
            For arrays of the wrong shape or not finite.
        """
        commands = self._commands(torques)
        q = table(self.robot.name, "starts", starts, self.n, " [rad]")
        if len(q) != len(commands):
            counts = f"{len(q)} rows beside {len(commands)} torques"
            raise InputError(self.robot.name, "starts", counts, "as many starts as torques")
        return self._engine.settle_each(q, commands)

    def _command(self, torque: ArrayLike) -> Array:
        """Return a torque as it is applied: nothing where gravity feels nothing."""
        command = vector(self.robot.name, "torque", torque, self.n, " [N m]")
        return command if self._projector is None else self._projector @ command

    def _commands(self, torques: ArrayLike) -> Array:
        commands = table(self.robot.name, "torques", torques, self.n, " [N m]")
        return commands if self._projector is None else commands @ self._projector

    def _inside(self, field: str, q: ArrayLike) -> Array:
        """Return joint angles that lie within the limits."""
        return within(self.robot.name, field, q, self._body.limits, self.robot.joint_names)
