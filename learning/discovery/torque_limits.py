"""An arm whose motors give no more than so much torque."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.arm import Outcome, Playback
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


def check_torque(
    where: str, field: str, torque: ArrayLike, largest: ArrayLike, joint_names: tuple[str, ...]
) -> None:
    """Refuse a torque (n,) beyond the largest (n,) of its joints [N m].

    Raises
    ------
    InputError
        Naming the joint.

    Examples
    --------
    >>> check_torque("arm.urdf", "torque", [1.0, -7.0], [5.0, 5.0], ("a", "b"))
    Traceback (most recent call last):
    isotorque.InputError: arm.urdf: torque of joint 'b' is -7.0; accepted: -5 to 5 [N m], the
        effort limit of the robot file
    """
    for name, value, most in zip(
        joint_names, np.asarray(torque, float), np.asarray(largest, float), strict=True
    ):
        if abs(value) > most:
            accepted = f"{-most:g} to {most:g} [N m], the effort limit of the robot file"
            raise InputError(where, f"{field} of joint '{name}'", value, accepted)


class TorqueLimitedArm:
    """An arm that is never commanded more than its torque limits: what is beyond is cut off.

    Parameters
    ----------
    arm
        The arm; what it is commanded, and tells of, is the torque that is left.
    largest : (n,) array
        Largest torque of each joint [N m]; infinite where there is no limit.

    Attributes
    ----------
    cut : int
        Commands (torques, torque profiles) of which some torque was cut off.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> arm = TorqueLimitedArm(SimpleNamespace(apply=print), [10.0, np.inf])
    >>> arm.apply([-12.0, 40.0])
    [-10.  40.]
    >>> arm.cut
    1
    """

    def __init__(self, arm: Any, largest: ArrayLike) -> None:
        self._arm = arm
        self._largest: Array = np.asarray(largest, dtype=float)
        self.cut = 0

    @property
    def q(self) -> Array:
        """Joint angles as observed [rad], (n,)."""
        return np.asarray(self._arm.q)

    def apply(self, torque: ArrayLike) -> Outcome:
        """Apply a constant torque (n,) [N m], as far as the limits allow, and wait."""
        outcome: Outcome = self._arm.apply(self._within(torque))
        return outcome

    def play(self, torques: ArrayLike, step_seconds: float) -> Playback:
        """Apply torques (T, n) [N m] one after the other, then wait under the last one."""
        played: Playback = self._arm.play(self._within(torques), step_seconds)
        return played

    def go_home(self) -> None:
        """Return to the home configuration."""
        self._arm.go_home()

    def place(self, q: ArrayLike) -> None:
        """Lead a guided arm to q (n,) [rad]: who leads it is not limited by its motors."""
        self._arm.place(q)

    def hold(self) -> Outcome:
        """Measure the torque that holds a guided arm where it is."""
        outcome: Outcome = self._arm.hold()
        return outcome

    def _within(self, torque: ArrayLike) -> Array:
        wanted = np.asarray(torque, dtype=float)
        allowed = np.clip(wanted, -self._largest, self._largest)
        self.cut += bool((allowed != wanted).any())
        return allowed
