"""Joint limits that a step crosses: whether, where and when, compiled."""

from __future__ import annotations

import math

from isotorque.learning.simulator.compiled.kernel import kernel

_HALVINGS = 50


@kernel
def _between(q0, v0, q1, v1, h, s):
    """Return the cubic through both ends of a step at the fraction s of it."""
    r = 1.0 - s
    return (
        q0 * r * r * (1.0 + 2.0 * s) + q1 * s * s * (3.0 - 2.0 * s) + h * s * r * (v0 * r - v1 * s)
    )


@kernel
def _outermost(q0, v0, q1, v1, h):
    """Return the fraction of a step at which the joint turns round; 1 where it does not."""
    if not v0 * v1 < 0.0:
        return 1.0
    # Derivative of the cubic over h: v0 + 2 b s + c s^2.
    mean = (q1 - q0) / h
    b = 3.0 * mean - 2.0 * v0 - v1
    c = 3.0 * (v0 + v1 - 2.0 * mean)
    root = math.sqrt(max(b * b - c * v0, 0.0))
    below = -b - math.copysign(root, b)
    s = v0 / below if below != 0.0 else 1.0
    if not 0.0 < s < 1.0:
        s = below / c if c != 0.0 else 1.0
    return s if 0.0 < s < 1.0 else 1.0


@kernel
def crossing(limits, q, v, q_next, v_next, h):
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
    float
        Fraction of the step at which the first limit is crossed; 2 if none is.

    Notes
    -----
    Between the ends the motion is taken as the cubic with their angles and velocities, so a joint
    that passes its limit and turns back within one step is noticed.
    """
    first = 2.0
    for i in range(q.shape[0]):
        end = 1.0
        beyond = q_next[i]
        if limits[i, 0] <= beyond <= limits[i, 1]:
            end = _outermost(q[i], v[i], q_next[i], v_next[i], h)
            if end == 1.0:
                continue
            beyond = _between(q[i], v[i], q_next[i], v_next[i], h, end)
            if limits[i, 0] <= beyond <= limits[i, 1]:
                continue
        limit = limits[i, 1] if beyond > limits[i, 1] else limits[i, 0]
        inside = 0.0
        outside = end
        for _ in range(_HALVINGS):
            s = 0.5 * (inside + outside)
            there = _between(q[i], v[i], q_next[i], v_next[i], h, s)
            if (there > limit) == (beyond > limit):
                outside = s
            else:
                inside = s
        first = min(first, outside)
    return first


@kernel
def stop_at(limits, q, v, q_next, v_next, h, s):
    """Move q (n,) to where the joints are at the fraction s of a step, no joint past its limit."""
    for i in range(q.shape[0]):
        there = _between(q[i], v[i], q_next[i], v_next[i], h, s)
        q[i] = min(max(there, limits[i, 0]), limits[i, 1])
