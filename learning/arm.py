"""Protocol of an arm, as a learner sees it: apply a torque, go home, read the joint angles."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class OutcomeKind(StrEnum):
    """End of the application of a torque."""

    SETTLED = "settled"
    LIMIT = "limit"
    TIMEOUT = "timeout"


@dataclass(frozen=True, eq=False)
class Outcome:
    """Outcome of one applied torque.

    Attributes
    ----------
    q : (n,) array
        Observed joint angles [rad]: where the arm settled, or where it was when the limit was
        hit or the time was up.
    torque : (n,) array
        The torque that was applied, as observed [N m].
    seconds : float
        Time that passed on the arm [s] (simulated time in a simulation).
    """

    q: Vector
    torque: Vector
    seconds: float

    @property
    def kind(self) -> OutcomeKind:
        """Which of the three outcomes this is."""
        raise NotImplementedError


class Settled(Outcome):
    """The arm came to rest: ``torque`` holds ``q``."""

    @property
    def kind(self) -> OutcomeKind:
        """Always ``OutcomeKind.SETTLED``."""
        return OutcomeKind.SETTLED


class LimitHit(Outcome):
    """A joint limit was reached: the torque is inadmissible, the arm went home."""

    @property
    def kind(self) -> OutcomeKind:
        """Always ``OutcomeKind.LIMIT``."""
        return OutcomeKind.LIMIT


class TimedOut(Outcome):
    """The arm did not come to rest in time: the torque is inadmissible, the arm went home."""

    @property
    def kind(self) -> OutcomeKind:
        """Always ``OutcomeKind.TIMEOUT``."""
        return OutcomeKind.TIMEOUT


@dataclass(frozen=True, eq=False)
class Playback:
    """A torque profile played on an arm (Algorithm 1, lines 7-26).

    Attributes
    ----------
    outcome : Outcome
        How it ended: settled under the last torque of the profile, limit hit, or time out.
    times : (T,) array
        Times of the observations [s].
    q : (T, n) array
        Joint angles observed while the profile was played [rad].
    torques : (T, n) array
        Torques applied at those times [N m].
    """

    outcome: Outcome
    times: Vector
    q: Vector
    torques: Vector


@runtime_checkable
class Arm(Protocol):
    """All that learners and exploration may know of an arm.

    A simulation, a recording or a user's own hardware can stand behind it.
    """

    @property
    def q(self) -> Vector:
        """Observed joint angles [rad], shape (n,)."""
        ...

    def apply(self, torque: Vector) -> Outcome:
        """Apply a constant torque (n,) [N m] from the present configuration and wait."""
        ...

    def go_home(self) -> None:
        """Return to the home configuration, at rest."""
        ...


@runtime_checkable
class ProfileArm(Arm, Protocol):
    """An arm that can also follow a torque that changes with time."""

    def play(self, torques: Vector, step_seconds: float) -> Playback:
        """Apply ``torques`` (T, n) [N m] one after the other, then wait under the last one."""
        ...


class GuidedArm(Arm, Protocol):
    """An arm that can be placed and held from outside (``SimulatedArm`` in guided physics)."""

    def place(self, q: Vector) -> None:
        """Place the arm at rest at q (n,) [rad]."""
        ...

    def hold(self) -> Outcome:
        """Measure the torque that holds the arm where it is."""
        ...
