"""A simulated arm: the robot that knows nothing but what its joints do under torques."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.arm import LimitHit, Outcome, OutcomeKind, Playback, Settled, TimedOut
from isotorque.learning.simulator.checks import positive, vector
from isotorque.learning.simulator.dynamics.equations import Array
from isotorque.learning.simulator.results import ArmState
from isotorque.learning.simulator.settings import (
    EngineName,
    PhysicsMode,
    SensorNoise,
    SettleMode,
    SettleRule,
)
from isotorque.learning.simulator.simulated_body import SimulatedBody
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import Robot

_OUTCOMES: dict[OutcomeKind, type[Outcome]] = {
    OutcomeKind.SETTLED: Settled,
    OutcomeKind.LIMIT: LimitHit,
    OutcomeKind.TIMEOUT: TimedOut,
}


class SimulatedArm(SimulatedBody):
    """A robot arm in simulation, behind the protocols `Arm` and `ProfileArm`.

    Parameters
    ----------
    robot
        The robot, of revolute joints.
    physics
        ``"open_loop"`` (default), ``"geared"`` or ``"guided"``: see `PhysicsMode`.
    engine
        ``"compiled"`` (default) or ``"pinocchio"``: same physics, other code.
    damping
        Viscous damping per joint (n,), or one number for all [N m s/rad]. By default the robot
        file's, and where that has none ``1.8 sqrt(M K)``.
    coulomb
        Coulomb friction per joint [N m], in ``geared`` physics alone. By default the robot file's,
        and where that has none 1 % of the joint's largest gravity stiffness.
    limits
        Joint limits (n, 2) [rad], ``"file"`` (default: those of the robot file, none where
        it has none) or ``"none"``. Entries may be infinite.
    home
        Home configuration (n,) [rad], strictly within the limits and where a constant torque can
        hold the arm. By default the most stable one is found.
    settle
        ``"finished"`` (default) or ``"raw"``: see `SettleMode`. Ignored when a rule is given.
    rule
        When the arm counts as settled.
    noise
        Errors of the sensors; none by default.
    rng
        Generator of the measurement noise; needed only where there is random noise.
    q0
        Where the arm is at first, at rest; by default at home.

    Raises
    ------
    InputError
        For settings that cannot be used: a singular mass matrix, negative damping, limits that
        exclude home.

    Notes
    -----
    Each command goes on from where the last one left the arm. When a joint limit is hit or the
    time is up, the torque is inadmissible and the arm goes home. Along directions that gravity
    does not feel (a vertical first axis) nothing has stiffness: the torque commanded there is
    replaced by zero, and noise is left out.

    Without Coulomb friction a settled arm is always near a stable equilibrium (at it, in
    ``finished`` mode); where the settle rule is met near an unstable one, the arm is waited for
    until it has left.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> arm = SimulatedArm(load_robot("2r"))
    >>> outcome = arm.apply([5.0, -1.0])
    >>> print(outcome.kind, outcome.q.round(4))
    settled [-1.2385 -0.4961]
    """

    def __init__(
        self,
        robot: Robot,
        physics: str | PhysicsMode = PhysicsMode.OPEN_LOOP,
        engine: str | EngineName = EngineName.COMPILED,
        *,
        damping: ArrayLike | None = None,
        coulomb: ArrayLike | None = None,
        limits: ArrayLike | str | None = None,
        home: ArrayLike | None = None,
        settle: str | SettleMode = SettleMode.FINISHED,
        rule: SettleRule | None = None,
        noise: SensorNoise | None = None,
        rng: np.random.Generator | None = None,
        q0: ArrayLike | None = None,
    ) -> None:
        super().__init__(
            robot,
            physics,
            engine,
            damping=damping,
            coulomb=coulomb,
            limits=limits,
            home=home,
            settle=settle,
            rule=rule,
            noise=noise,
            rng=rng,
        )
        self._q = self._home.copy()
        self._v = np.zeros(robot.n)
        if q0 is not None:
            self._q = self._inside("q0", q0)
        self._observed = self._sensors.angles(self._q)

    @property
    def q(self) -> Array:
        """Joint angles as last observed [rad], shape (n,)."""
        return self._observed.copy()

    def apply(self, torque: ArrayLike) -> Outcome:
        """Apply a constant torque (n,) [N m] from the present configuration and wait.

        Returns
        -------
        Outcome
            `Settled`, `LimitHit` or `TimedOut`; after the last two the arm is at home.

        Raises
        ------
        InputError
            For a torque of the wrong length or with a number that is not finite.
        """
        command = self._command(torque)
        motion = self._engine.settle(self._q, self._v, command)
        return self._arrive(motion.kind, motion.q, motion.v, command, motion.seconds)

    def go_home(self) -> None:
        """Return to the home configuration, at rest."""
        self._rest_at(self._home)

    def play(self, torques: ArrayLike, step_seconds: float) -> Playback:
        """Apply torques (T, n) [N m] one after the other, then wait under the last one.

        Parameters
        ----------
        torques
            The profile; each row is held for ``step_seconds``.
        step_seconds
            Time for each row [s], positive.

        Returns
        -------
        Playback
            Angles observed at the end of each row's time, up to a limit hit if there was one.

        Raises
        ------
        InputError
            For torques of the wrong shape or not finite, or a time that is not positive.
        """
        commands = self._commands(torques)
        step_seconds = positive(self.robot.name, "step_seconds", step_seconds, " [s]")
        path = self._engine.follow(self._q, self._v, commands, step_seconds)
        count = len(path.q)
        times = step_seconds * np.arange(1, count + 1, dtype=float)
        times[-1] = path.seconds
        q = self._sensors.angles(path.q)
        observed = self._sensors.torque(commands[:count])
        last = commands[count - 1]
        if path.hit_limit:
            kind = OutcomeKind.LIMIT
            outcome = self._arrive(kind, path.q[-1], path.v, last, path.seconds)
        else:
            motion = self._engine.settle(path.q[-1], path.v, last)
            seconds = path.seconds + motion.seconds
            outcome = self._arrive(motion.kind, motion.q, motion.v, last, seconds)
        return Playback(outcome, times, q, observed)

    def place(self, q: ArrayLike) -> None:
        """Place the arm at rest at joint angles q (n,) [rad] and hold it there; ``guided`` only.

        Raises
        ------
        InputError
            In another physics mode, or for angles outside the limits.
        """
        self._require_guided("place")
        self._rest_at(self._inside("q", q))

    def hold(self) -> Settled:
        """Measure the torque that holds the arm where it is; ``guided`` only.

        Returns
        -------
        Settled
            Observed angles and holding torque, whose error is bounded by
            ``noise.holding_torque`` (0 by default).

        Raises
        ------
        InputError
            In another physics mode.
        """
        self._require_guided("hold")
        torque = self._engine.equations.gravity_torque(self._q)
        return Settled(self._observed.copy(), self._sensors.holding_torque(torque), 0.0)

    def state(self) -> ArmState:
        """Return the full state of the arm, from which `restore` goes on bit for bit."""
        return ArmState(
            tuple(self._q.tolist()),
            tuple(self._v.tolist()),
            tuple(self._observed.tolist()),
            self._sensors.generator_state(),
        )

    def restore(self, state: ArmState) -> None:
        """Put the arm, and its random generator, into a state that `state` returned.

        Raises
        ------
        InputError
            For a state of an arm with another number of joints.
        """
        where, n = "state", self.n
        self._q = vector(where, "q", state.q, n, " [rad]")
        self._v = vector(where, "v", state.v, n, " [rad/s]")
        self._observed = vector(where, "observed", state.observed, n, " [rad]")
        self._sensors.restore_generator(state.generator)

    def _arrive(
        self, kind: OutcomeKind, q: Array, v: Array, command: Array, seconds: float
    ) -> Outcome:
        """Observe the end of a motion, and go home unless the arm settled."""
        outcome = _OUTCOMES[kind](self._sensors.angles(q), self._sensors.torque(command), seconds)
        if kind is OutcomeKind.SETTLED:
            self._q, self._v, self._observed = q, v, outcome.q
        else:
            self.go_home()
        return outcome

    def _rest_at(self, q: Array) -> None:
        self._q = q.copy()
        self._v = np.zeros(self.n)
        self._observed = self._sensors.angles(self._q)

    def _require_guided(self, what: str) -> None:
        if self.physics is not PhysicsMode.GUIDED:
            raise InputError(self.robot.name, f"physics for {what}()", self.physics.value, "guided")
