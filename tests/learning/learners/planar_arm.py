"""The 2R arm of the paper, written out by hand: torque, group and an ideal arm for the tests."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from isotorque.learning.arm import LimitHit, Settled

UPPER = 18.39
LOWER = 6.13


def torque(q):
    """Static torque (m, 2) [N m] of configurations (m, 2) [rad]."""
    q = np.atleast_2d(q)
    lower = LOWER * np.cos(q[:, 0] + q[:, 1])
    return np.stack([UPPER * np.cos(q[:, 0]) + lower, lower], axis=1)


def group():
    """The eight primary symmetries: (q1, q1 + q2) -> (+-q1, +-(q1 + q2)) + (a pi, a pi)."""
    to_sums = np.array([[1.0, 0.0], [1.0, 1.0]])
    from_sums = np.linalg.inv(to_sums)
    A, d, Y = [], [], []
    for half_turn in (0, 1):
        for first in (1, -1):
            for second in (1, -1):
                A.append(from_sums @ np.diag([first, second]) @ to_sums)
                d.append(from_sums @ np.full(2, half_turn * np.pi))
                Y.append(np.full(2, 1.0 - 2.0 * half_turn))
    return SimpleNamespace(basis=np.eye(2), A_sat=np.array(A), d_sat=np.array(d), Y=np.array(Y))


class IdealArm:
    """Settles at the stable configuration of the torque, at once; offers what ``Arm`` demands."""

    def __init__(self, home=(-np.pi / 4, -np.pi / 4)):
        self._home = np.array(home, dtype=float)
        self.q = self._home.copy()

    def go_home(self):
        """Return to the home configuration."""
        self.q = self._home.copy()

    def apply(self, applied):
        """Settle where both links hang below the horizontal, or fall to a limit."""
        applied = np.array(applied, dtype=float)
        ratios = np.array([(applied[0] - applied[1]) / UPPER, applied[1] / LOWER])
        if np.abs(ratios).max() > 1:
            hit = LimitHit(self.q.copy(), applied, 1.0)
            self.go_home()
            return hit
        first, both = -np.arccos(ratios)
        self.q = np.array([first, both - first])
        return Settled(self.q.copy(), applied, 1.0)
