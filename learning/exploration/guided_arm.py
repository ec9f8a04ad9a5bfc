"""Joint limits of a guided arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.arm import GuidedArm, Outcome, Playback
from isotorque.learning.sampling.reachable_lattice import MARGIN, turned_into
from isotorque.symbolic.common.joint_limits import one_turn

Array = NDArray[np.float64]


class LimitedGuidedArm:
    """Guided arm that stays within its joint limits: it is placed at the nearest place before them.

    Parameters
    ----------
    arm
        The arm.
    limits : (n, 2) array
        Its joint limits [rad].

    Notes
    -----
    As with a person who guides the arm: joints stop where they can go no farther, and what is
    measured is what holds the arm there. Angles are first turned by full turns to where their
    limits are.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> arm = SimpleNamespace(place=lambda q: print(q.round(3)))
    >>> LimitedGuidedArm(arm, [[-1.0, 1.0], [0.0, 6.0]]).place([2.0, -1.0])
    [1.    5.283]
    """

    def __init__(self, arm: GuidedArm, limits: ArrayLike) -> None:
        self._arm = arm
        self._limits: Array = np.asarray(limits, dtype=float)

    @property
    def q(self) -> Array:
        """Joint angles as observed [rad], (n,)."""
        return self._arm.q

    def apply(self, torque: Array) -> Outcome:
        """Apply a constant torque (n,) [N m] and wait."""
        return self._arm.apply(torque)

    def go_home(self) -> None:
        """Return to the home configuration."""
        self._arm.go_home()

    def play(self, torques: Array, step_seconds: float) -> Playback:
        """Apply torques (T, n) [N m] one after the other, then wait under the last one."""
        played: Playback = self._arm.play(torques, step_seconds)  # type: ignore[attr-defined]
        return played

    @property
    def reach(self) -> Array:
        """Angles (n, 2) to which the arm may be guided, a turn per joint at most [rad]."""
        return one_turn(self._limits)

    def place(self, q: ArrayLike) -> None:
        """Guide the arm towards q (n,) [rad], as far as its limits allow."""
        low, high = self._limits.T
        turned = turned_into(np.asarray(q, dtype=float), self._limits)
        self._arm.place(np.clip(turned, low + MARGIN, high - MARGIN))

    def hold(self) -> Outcome:
        """Measure the torque that holds the arm where it is."""
        return self._arm.hold()
