"""Whether, where and when a step crosses a joint limit."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from learning.dynamics.equations import Array

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
    low, high = limits[:, 0], limits[:, 1]
    outside = (q_next < low) | (q_next > high)
    suspects = np.flatnonzero(outside | (v * v_next < 0.0))
    if len(suspects) == 0:
        return None
    motions = CubicHermiteSpline([0.0, 1.0], [q, q_next], [h * v, h * v_next])
    fractions = []
    for j in suspects:
        joint = CubicHermiteSpline([0.0, 1.0], [q[j], q_next[j]], [h * v[j], h * v_next[j]])
        turns = [1.0] if outside[j] else joint.derivative().roots(extrapolate=False)
        ends = [s for s in turns if not low[j] <= joint(s) <= high[j]]
        if ends:
            limit = high[j] if joint(ends[0]) > high[j] else low[j]
            fractions.append(_meets(joint, limit, ends[0]))
    if not fractions:
        return None
    first = min(fractions)
    return first, np.clip(motions(first), low, high)


def _meets(joint: CubicHermiteSpline, limit: float, end: float) -> float:
    """Return when a joint that is beyond a limit at ``end`` first gets there, by bisection."""
    inside, beyond = 0.0, end
    side = joint(end) > limit
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + beyond)
        if (joint(middle) > limit) == side:
            beyond = middle
        else:
            inside = middle
    return beyond
