"""The compiled engine."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.compiled.chain import CompiledEquations
from isotorque.learning.simulator.compiled.motion import follow, move, move_each
from isotorque.learning.simulator.compiled.step import (
    ACCELERATION,
    acceleration_here,
    evaluate_here,
)
from isotorque.learning.simulator.dynamics.engine import Body, Motion, Motions, Path
from isotorque.learning.simulator.dynamics.equations import Array
from isotorque.learning.simulator.dynamics.plant import (
    AT_EQUILIBRIUM,
    CONVERGING,
    ELAPSED,
    LIMIT,
    RESTED,
    WHERE_IT_IS,
    Rest,
    new_plant,
    new_scratch,
)
from isotorque.learning.simulator.settings import SettleMode, SettleRule

_KINDS = {
    RESTED: OutcomeKind.SETTLED,
    LIMIT: OutcomeKind.LIMIT,
    ELAPSED: OutcomeKind.TIMEOUT,
}
_ENDINGS = {SettleMode.FINISHED: AT_EQUILIBRIUM, SettleMode.RAW: CONVERGING}


class CompiledEngine:
    """`Engine` whose whole motion, from command to outcome, is compiled code.

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
    Not to be used from two threads at once: it has one workspace.
    """

    def __init__(self, model: pin.Model, body: Body, rule: SettleRule) -> None:
        self.equations = CompiledEquations(model)
        self._plant = new_plant(self.equations.chain, body)
        self._rest = Rest(
            rule.velocity,
            rule.acceleration,
            rule.dwell,
            WHERE_IT_IS if body.coulomb.any() else _ENDINGS[rule.mode],
            rule.tolerance,
            rule.time_tolerance,
        )
        self._never = self._rest._replace(velocity=-1.0)
        self._time_limit = rule.time_limit
        self._scratch = new_scratch(self.equations.chain)

    def settle(self, q: Array, v: Array, torque: Array) -> Motion:
        """Move under a constant torque (n,) until the arm settles, hits a limit or time is up."""
        return self._move(self._rest, q, v, torque, self._time_limit)

    def settle_each(self, q: Array, torques: Array) -> Motions:
        """Settle from rest at each row of q (m, n) under the same row of ``torques`` (m, n)."""
        ends = np.array(q, dtype=float, order="C")
        codes = np.zeros(len(ends), dtype=np.int64)
        seconds = np.zeros(len(ends))
        steps = np.zeros(len(ends))
        torques = np.array(torques, dtype=float, order="C")
        move_each(
            self._plant,
            self._rest,
            ends,
            torques,
            self._time_limit,
            self._scratch,
            codes,
            seconds,
            steps,
        )
        kinds = tuple(_KINDS[code] for code in codes.tolist())
        return Motions(kinds, ends, seconds, steps)

    def wait(self, q: Array, v: Array, torque: Array, seconds: float) -> Motion:
        """Move under a constant torque for a time, settled or not (``kind`` is then TIMEOUT)."""
        return self._move(self._never, q, v, torque, seconds)

    def follow(self, q: Array, v: Array, torques: Array, step_seconds: float) -> Path:
        """Hold each torque (m, n) of a profile for ``step_seconds``."""
        torques = np.array(torques, dtype=float, order="C")
        path = np.empty_like(torques)
        v = v.copy()
        code, count, seconds = follow(
            self._plant,
            self._never,
            q.copy(),
            v,
            torques,
            step_seconds,
            self._scratch,
            path,
        )
        return Path(path[:count], v, code == LIMIT, seconds)

    def acceleration(self, q: Array, v: Array, torque: Array) -> Array:
        """Return the acceleration (n,) [rad/s^2] under a torque (n,)."""
        evaluate_here(self._plant, q, v, self._scratch)
        acceleration_here(self._plant, v, torque, self._scratch)
        return self._scratch.vectors[ACCELERATION].copy()

    def _move(self, rest: Rest, q: Array, v: Array, torque: Array, seconds: float) -> Motion:
        q = q.copy()
        v = v.copy()
        code, passed, steps = move(self._plant, rest, q, v, torque, seconds, self._scratch)
        return Motion(_KINDS[code], q, v, passed, steps)
