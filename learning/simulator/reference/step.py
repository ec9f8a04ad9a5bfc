"""Adaptive step of the linearly implicit method, on Pinocchio's equations of motion."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv

from isotorque.learning.simulator.dynamics.engine import Body
from isotorque.learning.simulator.dynamics.equations import Array
from isotorque.learning.simulator.dynamics.friction import solve_with_friction
from isotorque.learning.simulator.dynamics.step_control import VELOCITY_WEIGHT
from isotorque.learning.simulator.reference.equations import PinocchioEquations

Terms = tuple[Array, Array, Array]


def largest(x: Array) -> float:
    """Return the largest absolute entry; for the short vectors here faster than NumPy's."""
    return max(map(abs, x.tolist()))


class Step(NamedTuple):
    """A step that was tried.

    Attributes
    ----------
    q, v : (n,) arrays
        State after it.
    error : float
        Estimated local error before extrapolation [rad], infinite where numbers overflow.
    """

    q: Array
    v: Array
    error: float


class Stepper:
    """Steps of a linearly implicit Euler method with extrapolation.

    Parameters
    ----------
    equations
        Equations of motion.
    body
        Friction of the arm.

    Notes
    -----
    The method of `step`, where it is described, written apart from it.
    """

    def __init__(self, equations: PinocchioEquations, body: Body) -> None:
        self._equations = equations
        self._damping = np.diag(body.damping)
        self._viscous = body.damping
        self._coulomb = body.coulomb
        self._dry = bool(body.coulomb.any())

    def try_step(self, terms: Terms, q: Array, v: Array, torque: Array, h: float) -> Step:
        """Step once with h and twice with h / 2 from (q, v), where the terms were taken."""
        mass, bias, stiffness = terms
        half = 0.5 * h
        momentum = mass @ v
        drive = torque - bias
        elastic = True
        v_full = self._next(mass, stiffness, momentum, drive, h, v)
        if v_full is None:
            elastic = False
            v_full = self._next_inelastic(mass, momentum, drive, h, v)
        v_half = self._next(mass, stiffness, momentum, drive, half, v) if elastic else None
        if v_half is None:
            v_half = self._next_inelastic(mass, momentum, drive, half, v)
        q_half = q + half * v_half
        mass, bias, stiffness = self._equations.terms(q_half, v_half)
        momentum = mass @ v_half
        drive = torque - bias
        v_end = self._next(mass, stiffness, momentum, drive, half, v) if elastic else None
        if v_end is None:
            v_end = self._next_inelastic(mass, momentum, drive, half, v)
        q_full = q + h * v_full
        q_end = q_half + half * v_end
        dq = q_end - q_full
        dv = v_end - v_full
        error = max(largest(dq), VELOCITY_WEIGHT * largest(dv))
        if not math.isfinite(sum(q_end.tolist()) + sum(v_end.tolist())):
            error = math.inf
        if not self._dry:
            return Step(q_end + dq, v_end + dv, error)
        # A joint that stuck or turned round during the step has nothing to extrapolate.
        smooth = (v_full * v_end > 0.0) & (v_full * v > 0.0)
        v_next = v_end + np.where(smooth, dv, 0.0)
        v_next = np.where(v_next * v_end > 0.0, v_next, v_end)
        return Step(q_end + np.where(smooth, dq, 0.0), v_next, error)

    def acceleration(self, terms: Terms, v: Array, torque: Array) -> Array:
        """Return the acceleration where the terms were taken; a joint at rest may stick."""
        mass, bias, _ = terms
        force = torque - bias - self._viscous * v
        if self._dry:
            moving = v != 0.0
            force = force - np.where(moving, self._coulomb * np.sign(v), 0.0)
            sticking = np.where(moving, 0.0, self._coulomb)
            return solve_with_friction(mass, force, sticking, np.zeros_like(v))
        return dposv(mass, force)[1]

    def _next(
        self, mass: Array, stiffness: Array, momentum: Array, drive: Array, h: float, guess: Array
    ) -> Array | None:
        """Solve for the next velocity with stiffness; None if that system is not definite."""
        system = stiffness * h
        system += self._damping
        system *= h
        system += mass
        _, x, failed = dposv(system, momentum + h * drive)
        if failed:
            return None
        if self._dry:
            return solve_with_friction(system, momentum + h * drive, h * self._coulomb, guess)
        return x

    def _next_inelastic(
        self, mass: Array, momentum: Array, drive: Array, h: float, guess: Array
    ) -> Array:
        """Solve for the next velocity without stiffness."""
        system = mass + h * self._damping
        if self._dry:
            return solve_with_friction(system, momentum + h * drive, h * self._coulomb, guess)
        return dposv(system, momentum + h * drive)[1]
