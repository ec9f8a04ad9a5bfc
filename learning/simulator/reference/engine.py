"""The reference engine: the same motion, on calls of Pinocchio alone."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.dynamics.crossing import first_crossing
from isotorque.learning.simulator.dynamics.engine import Body, Motion, Motions, Path
from isotorque.learning.simulator.dynamics.equations import Array
from isotorque.learning.simulator.dynamics.step_control import (
    CONTRACTION,
    FIRST_STEP,
    FLOOR,
    GROWTH,
    LONGEST_STEP,
    NEWTON_STEPS,
    SAFETY,
    SHORTEST_STEP,
    SHRINKAGE,
    TIME_ROUNDING,
)
from isotorque.learning.simulator.reference.equations import PinocchioEquations
from isotorque.learning.simulator.reference.step import Stepper, Terms, largest
from isotorque.learning.simulator.settings import SettleMode, SettleRule


class PinocchioEngine:
    """`Engine` that calls Pinocchio for every evaluation and steps in Python.

    Parameters
    ----------
    model
        Pinocchio model with one coordinate per joint.
    body
        Friction, limits and free directions.
    rule
        When the arm counts as settled.

    Notes
    -----
    Written apart from the compiled engine, whose outcomes it must share. About a hundred times
    slower than that, and some twenty times faster than a plain loop of small Euler steps.
    """

    def __init__(self, model: pin.Model, body: Body, rule: SettleRule) -> None:
        self.equations = PinocchioEquations(model)
        self._stepper = Stepper(self.equations, body)
        self._limits = body.limits
        self._anchor = body.anchor
        self._anchored = body.anchor * body.damping
        self._nudge = body.nudge
        self._residual = body.residual
        self._rule = rule
        self._converges = not body.coulomb.any()

    def settle(self, q: Array, v: Array, torque: Array) -> Motion:
        """Move under a constant torque (n,) until the arm settles, hits a limit or time is up."""
        return self._move(q, v, torque, self._rule.time_limit, True)

    def settle_each(self, q: Array, torques: Array) -> Motions:
        """Settle from rest at each row of q (m, n) under the same row of ``torques`` (m, n)."""
        still = np.zeros(self.equations.n)
        ends = [self.settle(a, still, b) for a, b in zip(q, torques, strict=True)]
        return Motions(
            tuple(end.kind for end in ends),
            np.array([end.q for end in ends]),
            np.array([end.seconds for end in ends]),
            np.array([float(end.steps) for end in ends]),
        )

    def wait(self, q: Array, v: Array, torque: Array, seconds: float) -> Motion:
        """Move under a constant torque for a time, settled or not (``kind`` is then TIMEOUT)."""
        return self._move(q, v, torque, seconds, False)

    def follow(self, q: Array, v: Array, torques: Array, step_seconds: float) -> Path:
        """Hold each torque (m, n) of a profile for ``step_seconds``."""
        path = []
        for k, torque in enumerate(torques):
            motion = self.wait(q, v, torque, step_seconds)
            q, v = motion.q, motion.v
            path.append(q)
            if motion.kind is OutcomeKind.LIMIT:
                return Path(np.array(path), v, True, k * step_seconds + motion.seconds)
        return Path(np.array(path), v, False, len(path) * step_seconds)

    def acceleration(self, q: Array, v: Array, torque: Array) -> Array:
        """Return the acceleration (n,) [rad/s^2] under a torque (n,)."""
        return self._stepper.acceleration(self.equations.terms(q, v), v, torque)

    @np.errstate(over="ignore", invalid="ignore")
    def _move(self, q: Array, v: Array, torque: Array, duration: float, may_rest: bool) -> Motion:
        rule = self._rule
        stepper = self._stepper
        applied = torque + self._nudge
        terms = self.equations.terms(q, v)
        fastest = largest(stepper.acceleration(terms, v, applied))
        h = math.sqrt(2.0 * rule.tolerance / (fastest + 1e-9))
        h = max(SHORTEST_STEP, min(FIRST_STEP, h))
        quiet_since = None
        if may_rest and largest(v) <= rule.velocity and fastest <= rule.acceleration:
            quiet_since = 0.0
        t = 0.0
        steps = 0
        while duration - t > TIME_ROUNDING:
            left = duration - t
            if quiet_since is not None and t - quiet_since < rule.dwell - TIME_ROUNDING:
                left = min(left, quiet_since + rule.dwell - t)
            length = min(h, left)
            steps += 1
            step = stepper.try_step(terms, q, v, applied, length)
            if not step.error < math.inf:
                # Numbers overflow: the arm flies off.
                if length <= SHORTEST_STEP:
                    break
                h = max(SHORTEST_STEP, length * SHRINKAGE)
                continue
            speed = max(largest(v), largest(step.v))
            allowed = min(rule.tolerance, max(rule.time_tolerance * speed, FLOOR * rule.tolerance))
            scale = math.sqrt(allowed / (step.error + 1e-300))
            if not step.error <= allowed and length > SHORTEST_STEP:
                h = max(SHORTEST_STEP, length * max(SHRINKAGE, SAFETY * scale))
                continue
            hit = first_crossing(self._limits, q, v, step.q, step.v, length)
            if hit is not None:
                fraction, where = hit
                return Motion(OutcomeKind.LIMIT, where, v, t + fraction * length, steps)
            q, v = step.q, step.v
            t += length
            grown = length * min(GROWTH, SAFETY * scale)
            grown = max(SHORTEST_STEP, min(LONGEST_STEP, grown))
            h = grown if length == h else max(h, grown)
            terms = self.equations.terms(q, v)
            if not (may_rest and self._is_quiet(terms, v, applied)):
                quiet_since = None
                continue
            if quiet_since is None:
                quiet_since = t
            if t - quiet_since >= rule.dwell - TIME_ROUNDING:
                if not self._converges:
                    return Motion(OutcomeKind.SETTLED, q, v, t, steps)
                end = self._equilibrium(terms, q, v, torque)
                if end is not None:
                    if rule.mode is SettleMode.FINISHED:
                        q, v = end, np.zeros_like(v)
                    return Motion(OutcomeKind.SETTLED, q, v, t, steps)
                # At rest for now, but not near a stable equilibrium: it will move on.
        return Motion(OutcomeKind.TIMEOUT, q, v, duration, steps)

    def _is_quiet(self, terms: Terms, v: Array, torque: Array) -> bool:
        """Tell whether velocity and acceleration meet the settle rule."""
        if largest(v) > self._rule.velocity:
            return False
        return largest(self._stepper.acceleration(terms, v, torque)) <= self._rule.acceleration

    def _equilibrium(self, terms: Terms, q: Array, v: Array, torque: Array) -> Array | None:
        """Return the equilibrium that the nearly finished motion converges to, or None.

        The conditions are those of `finish`.
        """
        mass, bias, stiffness = terms
        missing = torque - bias
        step_goal = missing + self._anchor @ (mass @ v)
        allowed = math.inf
        for _ in range(NEWTON_STEPS):
            _, step, failed = dposv(stiffness + self._anchored, step_goal)
            length = largest(step)
            if failed or not length <= allowed:
                return None
            allowed = CONTRACTION * length
            q = q + step
            missing = step_goal = torque - self.equations.gravity_torque(q)
            stiffness = self.equations.stiffness(q)
            if largest(missing) <= self._residual:
                definite = dposv(stiffness + self._anchored, missing)[2] == 0
                inside = (self._limits[:, 0] <= q) & (q <= self._limits[:, 1])
                return q if definite and inside.all() else None
        return None
