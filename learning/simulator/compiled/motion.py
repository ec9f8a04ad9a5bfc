"""Motion under a constant torque until rest, a limit or the end of the time, compiled."""

from __future__ import annotations

import math

from isotorque.learning.simulator.compiled.finish import finish
from isotorque.learning.simulator.compiled.kernel import kernel
from isotorque.learning.simulator.compiled.limits import crossing, stop_at
from isotorque.learning.simulator.compiled.step import (
    ACCELERATION,
    Q_NEXT,
    TORQUE,
    V_NEXT,
    acceleration_here,
    evaluate_here,
    try_step,
)
from isotorque.learning.simulator.dynamics.plant import (
    AT_EQUILIBRIUM,
    ELAPSED,
    LIMIT,
    RESTED,
    WHERE_IT_IS,
)
from isotorque.learning.simulator.dynamics.step_control import (
    FIRST_STEP,
    FLOOR,
    GROWTH,
    LONGEST_STEP,
    SAFETY,
    SHORTEST_STEP,
    SHRINKAGE,
    TIME_ROUNDING,
)


@kernel
def _largest(x):
    """Return the largest absolute entry."""
    largest = 0.0
    for i in range(x.shape[0]):
        largest = max(largest, abs(x[i]))
    return largest


@kernel
def move(plant, rest, q, v, torque, duration, scratch):
    """Integrate the motion under a constant torque.

    Parameters
    ----------
    plant, rest, scratch
        `Plant`, `Rest` and `Scratch`.
    q, v : (n,) arrays
        State, moved on in place. At a limit q is where the limit was met.
    torque : (n,) array
        Torque [N m].
    duration : float
        Time allowed [s].

    Returns
    -------
    code : int
        ``RESTED``, ``LIMIT`` or ``ELAPSED``.
    seconds : float
        Time that passed [s].
    steps : int
        Steps tried.
    """
    vectors = scratch.vectors
    n = q.shape[0]
    applied = vectors[TORQUE]
    for i in range(n):
        applied[i] = torque[i] + plant.nudge[i]
    evaluate_here(plant, q, v, scratch)
    acceleration_here(plant, v, applied, scratch)
    fastest = _largest(vectors[ACCELERATION])
    # The error of a first step from here is about a h^2 / 4.
    h = math.sqrt(2.0 * rest.tolerance / (fastest + 1e-9))
    h = max(SHORTEST_STEP, min(FIRST_STEP, h))
    quiet_since = -1.0
    if _largest(v) <= rest.velocity and fastest <= rest.acceleration:
        quiet_since = 0.0
    t = 0.0
    steps = 0
    while True:
        left = duration - t
        if left <= TIME_ROUNDING:
            return ELAPSED, duration, steps
        if quiet_since >= 0.0 and t - quiet_since < rest.dwell - TIME_ROUNDING:
            left = min(left, quiet_since + rest.dwell - t)
        step = min(h, left)
        steps += 1
        error = try_step(plant, q, v, applied, step, scratch)
        if not error < math.inf:
            # Numbers overflow: the arm flies off.
            if step <= SHORTEST_STEP:
                return ELAPSED, duration, steps
            h = max(SHORTEST_STEP, step * SHRINKAGE)
            continue
        speed = max(_largest(v), _largest(vectors[V_NEXT]))
        allowed = min(rest.tolerance, max(rest.time_tolerance * speed, FLOOR * rest.tolerance))
        scale = math.sqrt(allowed / (error + 1e-300))
        if not error <= allowed and step > SHORTEST_STEP:
            h = max(SHORTEST_STEP, step * max(SHRINKAGE, SAFETY * scale))
            continue
        q_next = vectors[Q_NEXT]
        v_next = vectors[V_NEXT]
        s = crossing(plant.limits, q, v, q_next, v_next, step)
        if s <= 1.0:
            stop_at(plant.limits, q, v, q_next, v_next, step, s)
            return LIMIT, t + s * step, steps
        for i in range(n):
            q[i] = q_next[i]
            v[i] = v_next[i]
        t += step
        grown = step * min(GROWTH, SAFETY * scale)
        grown = max(SHORTEST_STEP, min(LONGEST_STEP, grown))
        h = grown if step == h else max(h, grown)
        evaluate_here(plant, q, v, scratch)
        if _largest(v) <= rest.velocity:
            acceleration_here(plant, v, applied, scratch)
            if _largest(vectors[ACCELERATION]) <= rest.acceleration:
                if quiet_since < 0.0:
                    quiet_since = t
                if t - quiet_since >= rest.dwell - TIME_ROUNDING:
                    if rest.ending == WHERE_IT_IS:
                        return RESTED, t, steps
                    if finish(plant, q, v, torque, rest.ending == AT_EQUILIBRIUM, scratch):
                        return RESTED, t, steps
                    # At rest for now, but not near a stable equilibrium: it will move on.
                    evaluate_here(plant, q, v, scratch)
                continue
        quiet_since = -1.0


@kernel
def move_each(plant, rest, q, torques, duration, scratch, codes, seconds, steps):
    """Let each start (m, n) move from rest under its torque (m, n); q is moved on in place."""
    v = scratch.vectors[-1]
    for k in range(q.shape[0]):
        for i in range(v.shape[0]):
            v[i] = 0.0
        codes[k], seconds[k], steps[k] = move(plant, rest, q[k], v, torques[k], duration, scratch)


@kernel
def follow(plant, rest, q, v, torques, step_seconds, scratch, path):
    """Hold each torque of a profile (m, n) for a while and note where the arm is.

    Returns
    -------
    code : int
        ``LIMIT`` or ``ELAPSED``.
    count : int
        Rows of ``path`` (m, n) that were written, one at the end of each torque.
    seconds : float
        Time that passed [s].
    """
    for k in range(torques.shape[0]):
        code, seconds, _ = move(plant, rest, q, v, torques[k], step_seconds, scratch)
        for i in range(q.shape[0]):
            path[k, i] = q[i]
        if code == LIMIT:
            return LIMIT, k + 1, k * step_seconds + seconds
    return ELAPSED, torques.shape[0], torques.shape[0] * step_seconds
