"""Engine: moves an arm under given torques until something happens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.dynamics.equations import Array, Equations


@dataclass(frozen=True, eq=False)
class Body:
    """Friction, limits and free directions of an arm, beside its equations.

    Attributes
    ----------
    damping : (n,) array
        Viscous damping [N m s/rad].
    coulomb : (n,) array
        Coulomb friction [N m].
    limits : (n, 2) array
        Joint limits [rad]; infinite where there is none.
    anchor : (n, n) array
        From `FreeDirections.anchor`.
    nudge : (n,) array
        From `FreeDirections.nudge` [N m].
    residual : float
        Imbalance allowed at a finished equilibrium [N m].
    """

    damping: Array
    coulomb: Array
    limits: Array
    anchor: Array
    nudge: Array
    residual: float


@dataclass(frozen=True, eq=False)
class Motion:
    """End of a motion under a constant torque.

    Attributes
    ----------
    kind : OutcomeKind
        Settled, limit hit, or time out.
    q, v : (n,) arrays
        Joint angles [rad] and velocities [rad/s] at the end.
    seconds : float
        Time that passed [s].
    steps : int
        Integration steps tried.
    """

    kind: OutcomeKind
    q: Array
    v: Array
    seconds: float
    steps: int


@dataclass(frozen=True, eq=False)
class Motions:
    """Ends of many motions, each from its own start under its own torque.

    Attributes
    ----------
    kinds : tuple of m OutcomeKind
        How each ended.
    q : (m, n) array
        Joint angles at the end [rad].
    seconds : (m,) array
        Time that passed [s].
    steps : (m,) array
        Integration steps tried.
    """

    kinds: tuple[OutcomeKind, ...]
    q: Array
    seconds: Array
    steps: Array


@dataclass(frozen=True, eq=False)
class Path:
    """Path of an arm under a torque profile.

    Attributes
    ----------
    q : (k, n) array
        Joint angles after each torque [rad]; the last row is where a limit was hit, if it was.
    v : (n,) array
        Velocities at the end [rad/s].
    hit_limit : bool
        Whether a limit was hit.
    seconds : float
        Time that passed [s].
    """

    q: Array
    v: Array
    hit_limit: bool
    seconds: float


class Engine(Protocol):
    """Integrates the equations of motion of one arm. Inputs are arrays that it does not change."""

    @property
    def equations(self) -> Equations:
        """The equations of motion."""
        ...

    def settle(self, q: Array, v: Array, torque: Array) -> Motion:
        """Move under a constant torque (n,) until the arm settles, hits a limit or time is up."""
        ...

    def settle_each(self, q: Array, torques: Array) -> Motions:
        """Settle from rest at each row of q (m, n) under the same row of ``torques`` (m, n)."""
        ...

    def wait(self, q: Array, v: Array, torque: Array, seconds: float) -> Motion:
        """Move under a constant torque for a time, settled or not (``kind`` is then TIMEOUT)."""
        ...

    def follow(self, q: Array, v: Array, torques: Array, step_seconds: float) -> Path:
        """Hold each torque (m, n) of a profile for ``step_seconds``."""
        ...

    def acceleration(self, q: Array, v: Array, torque: Array) -> Array:
        """Return the acceleration (n,) [rad/s^2] under a torque (n,)."""
        ...
