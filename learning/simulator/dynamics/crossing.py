"""Joint limits that a step crosses: whether, where and when."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from isotorque.learning.simulator.dynamics.equations import Array

_HALVINGS = 50


def first_crossing(
    limits: Array, q: Array, v: Array, q_next: Array, v_next: Array, h: float
) -> tuple[float, Array] | None:
    """Find the first crossing of a joint limit during a step.

    Parameters
    ----------
    limits : (n, 2) array
        Joint limits [rad].
    q, v, q_next, v_next : (n,) arrays
        States at the ends of the step.
    h : float
        Length of the step [s].

    Returns
    -------
    None, or a pair
        Fraction of the step at which the first limit is met, and the joint angles (n,) there.

    Notes
    -----
    Between the ends the motion is taken as the cubic with their angles and velocities, so a joint
    that passes its limit and turns back within one step is noticed.

    Examples
    --------
    >>> one, still = np.array([1.0]), np.zeros(1)
    >>> fraction, where = first_crossing(np.array([[-1.0, 0.5]]), still, one, one, one, 1.0)
    >>> print(round(fraction, 6), where)
    0.5 [0.5]
    """
    first = None
    rows = zip(
        limits.tolist(), q.tolist(), v.tolist(), q_next.tolist(), v_next.tolist(), strict=True
    )
    for (low, high), q0, v0, q1, v1 in rows:
        motion = Cubic(q0, h * v0, q1, h * v1)
        end = 1.0
        if low <= q1 <= high:
            # A joint that turns round gets less than this beyond both ends of the step.
            reach = h * max(abs(v0), abs(v1))
            inside = low <= min(q0, q1) - reach and max(q0, q1) + reach <= high
            if v0 * v1 >= 0.0 or inside:
                continue
            end = motion.turns_at()
        beyond = motion.at(end)
        if not low <= beyond <= high:
            met = motion.meets(high if beyond > high else low, end)
            first = met if first is None else min(first, met)
    if first is None:
        return None
    where = Cubic(q, h * v, q_next, h * v_next).at(first)
    return first, np.clip(where, limits[:, 0], limits[:, 1])


class Cubic(NamedTuple):
    """The cubic with given values q0, q1 and slopes v0, v1 at 0 and 1."""

    q0: Any
    v0: Any
    q1: Any
    v1: Any

    def at(self, s: float) -> Any:
        """Return its value at s."""
        r = 1.0 - s
        begin = self.q0 * (1.0 + 2.0 * s) + self.v0 * s
        return r * r * begin + s * s * (self.q1 * (3.0 - 2.0 * s) - self.v1 * r)

    def slope(self, s: float) -> Any:
        """Return its derivative at s."""
        r = 1.0 - s
        ends = self.v0 * r * (1.0 - 3.0 * s) + self.v1 * s * (3.0 * s - 2.0)
        return 6.0 * s * r * (self.q1 - self.q0) + ends

    def turns_at(self) -> float:
        """Return where the slope vanishes, if v0 and v1 have opposite signs."""
        before, after = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (before + after)
            if self.slope(middle) * self.v0 > 0.0:
                before = middle
            else:
                after = middle
        return after

    def meets(self, limit: float, end: float) -> float:
        """Return where it first meets a limit that it is beyond at ``end``, but not at 0."""
        side = self.at(end) > limit
        before, after = 0.0, end
        for _ in range(_HALVINGS):
            middle = 0.5 * (before + after)
            if (self.at(middle) > limit) == side:
                after = middle
            else:
                before = middle
        return after
