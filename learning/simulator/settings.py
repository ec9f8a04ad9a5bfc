"""Settings of a simulated arm: physics mode, when it counts as settled, measurement noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any, TypeVar

from isotorque.symbolic.common.errors import InputError

_Choice = TypeVar("_Choice", bound=StrEnum)


class PhysicsMode(StrEnum):
    """Physics that moves and holds the arm."""

    OPEN_LOOP = "open_loop"
    """Constant torques and viscous damping alone: only stable equilibria can be held."""
    GEARED = "geared"
    """Coulomb friction besides: the arm sticks, and labels are off by up to that friction."""
    GUIDED = "guided"
    """As open loop; besides, the arm can be placed and held from outside (brakes, a person, a
    position controller) and the holding torque be measured. A departure from "no controller"."""


class EngineName(StrEnum):
    """Engine that integrates the equations of motion."""

    COMPILED = "compiled"
    """Compiled equations of this project: fast, the default."""
    PINOCCHIO = "pinocchio"
    """Calls of Pinocchio: slow, the reference."""


class SettleMode(StrEnum):
    """Configuration that is the sample of a settled arm."""

    FINISHED = "finished"
    """The equilibrium the arm is converging to, to 1e-11 of its largest torque."""
    RAW = "raw"
    """Where the arm was when the settle rule was met; its torque is off by some mN m."""


def _check_not_negative(settings: Any, names: tuple[str, ...]) -> None:
    for name in names:
        value = getattr(settings, name)
        if not (isinstance(value, int | float) and 0.0 <= value < math.inf):
            raise InputError(type(settings).__name__, name, value, "a finite number >= 0")


@dataclass(frozen=True)
class SettleRule:
    """Rule by which a moving arm counts as settled.

    Attributes
    ----------
    velocity : float
        Largest joint velocity [rad/s].
    acceleration : float
        Largest joint acceleration [rad/s^2]; velocity alone catches turning points.
    dwell : float
        How long both must hold without a break [s].
    time_limit : float
        After this time the arm counts as not settling [s].
    mode : SettleMode
        Which configuration becomes the sample.
    tolerance : float
        Local error allowed per integration step [rad].
    time_tolerance : float
        The same expressed as time [s]; the smaller of both counts. It makes the simulated times
        right to about a per cent, and costs about half of the work.

    Raises
    ------
    InputError
        For a number that is negative, infinite or not a number.
    """

    velocity: float = 1e-3
    acceleration: float = 1e-2
    dwell: float = 0.05
    time_limit: float = 60.0
    mode: SettleMode = SettleMode.FINISHED
    tolerance: float = 3e-4
    time_tolerance: float = 5e-3

    def __post_init__(self) -> None:
        numbers = tuple(f.name for f in fields(self) if f.name != "mode")
        _check_not_negative(self, numbers)
        for name in ("tolerance", "time_tolerance"):
            if getattr(self, name) == 0.0:
                raise InputError("SettleRule", name, 0.0, "a number > 0")
        object.__setattr__(self, "mode", choice(SettleMode, "SettleRule", "mode", self.mode))


SMALLEST_STEP = 1e-15
"""Smallest step of an encoder [rad]: an angle has no more digits."""


@dataclass(frozen=True)
class SensorNoise:
    """Errors of the sensors; none by default.

    Attributes
    ----------
    angle : float
        Standard deviation of the measured joint angles [rad].
    torque : float
        Standard deviation of the measured joint torques [N m].
    encoder_step : float
        Angles are rounded to multiples of this, after the noise [rad]; 0 for no rounding.
    holding_torque : float
        Bound of the error of a holding torque measured on a guided arm [N m]; uniform.

    Raises
    ------
    InputError
        For a number that is negative, infinite or not a number.
    """

    angle: float = 0.0
    torque: float = 0.0
    encoder_step: float = 0.0
    holding_torque: float = 0.0

    def __post_init__(self) -> None:
        _check_not_negative(self, tuple(f.name for f in fields(self)))
        if 0.0 < self.encoder_step < SMALLEST_STEP:
            accepted = f"0, or a number >= {SMALLEST_STEP:g} [rad]"
            raise InputError("SensorNoise", "encoder_step", self.encoder_step, accepted)

    @property
    def is_random(self) -> bool:
        """Whether measurements draw random numbers."""
        return self.angle > 0.0 or self.torque > 0.0 or self.holding_torque > 0.0


def choice(kind: type[_Choice], where: str, field: str, value: object) -> _Choice:
    """Return the member of an enumeration that a word names.

    Raises
    ------
    InputError
        For a word that names none, with those that do.

    Examples
    --------
    >>> choice(PhysicsMode, "--physics", "physics", "guided")
    <PhysicsMode.GUIDED: 'guided'>
    """
    try:
        return kind(str(value))
    except ValueError:
        words = ", ".join(member.value for member in kind)
        raise InputError(where, field, value, words) from None
