"""Compiled loops of the gravity recursion, apart because importing numba takes its time."""

import numpy as np

from isotorque.symbolic.common.compiled import compiled

# Columns of the scratch array that the compiled functions share, one row per joint (and the base):
# 0 cos, 1 sin; gravity 2-3 before and 4-6 after the joint's rotation; the moment that the joint
# carries, 7-9 after and 10-11 before its rotation. The z parts before and after are equal.


@compiled(inline="always")  # halves the time of short arms
def _passes(parents, table, q, start, work):
    """Fill ``work`` for the configuration that begins at ``q[start]``."""
    n = len(parents)
    for j in range(3):
        work[n, 4 + j] = table[n, j]
    for i in range(n):
        p = parents[i] if parents[i] >= 0 else n
        cos, sin = np.cos(q[start + i]), np.sin(q[start + i])
        a, b, c = work[p, 4], work[p, 5], work[p, 6]
        x = table[i, 0] * a + table[i, 3] * b + table[i, 6] * c
        y = table[i, 1] * a + table[i, 4] * b + table[i, 7] * c
        work[i, 0], work[i, 1] = cos, sin
        work[i, 2], work[i, 3] = x, y
        work[i, 4], work[i, 5] = cos * x + sin * y, cos * y - sin * x
        work[i, 6] = table[i, 2] * a + table[i, 5] * b + table[i, 8] * c
        work[i, 7], work[i, 8], work[i, 9] = table[i, 9], table[i, 10], table[i, 11]
    for i in range(n - 1, -1, -1):
        p = parents[i]
        cos, sin = work[i, 0], work[i, 1]
        x = cos * work[i, 7] - sin * work[i, 8]
        y = sin * work[i, 7] + cos * work[i, 8]
        z = work[i, 9]
        work[i, 10], work[i, 11] = x, y
        if p >= 0:
            work[p, 7] += table[i, 0] * x + table[i, 1] * y + table[i, 2] * z
            work[p, 8] += table[i, 3] * x + table[i, 4] * y + table[i, 5] * z
            work[p, 9] += table[i, 6] * x + table[i, 7] * y + table[i, 8] * z


@compiled
def torque(parents, table, q, out):
    """Compute torques; ``out`` may be ``q``."""
    n = len(parents)
    work = np.empty((n + 1, 12))
    for start in range(0, len(q), n):
        _passes(parents, table, q, start, work)
        for i in range(n):
            out[start + i] = work[i, 11] * work[i, 2] - work[i, 10] * work[i, 3]


@compiled
def stiffness(parents, table, q, out):
    """Compute the matrices dg/dq, one per configuration, into ``out`` (m, n, n)."""
    n = len(parents)
    work = np.empty((n + 1, 12))
    push = np.empty((n, 3))  # v x z of joint i, seen from each joint that it carries
    above = np.empty(n, dtype=np.bool_)
    for b in range(len(out)):
        _passes(parents, table, q, b * n, work)
        for i in range(n):
            above[:] = False
            above[i] = True
            push[i, 0], push[i, 1], push[i, 2] = work[i, 5], -work[i, 4], 0.0
            out[b, i, i] = push[i, 0] * work[i, 8] - push[i, 1] * work[i, 7]
            for j in range(i + 1, n):
                p = parents[j]
                if p < 0 or not above[p]:
                    continue
                above[j] = True
                u, v, w = push[p, 0], push[p, 1], push[p, 2]
                x = table[j, 0] * u + table[j, 3] * v + table[j, 6] * w
                y = table[j, 1] * u + table[j, 4] * v + table[j, 7] * w
                push[j, 0] = work[j, 0] * x + work[j, 1] * y
                push[j, 1] = work[j, 0] * y - work[j, 1] * x
                push[j, 2] = table[j, 2] * u + table[j, 5] * v + table[j, 8] * w
                out[b, i, j] = out[b, j, i] = push[j, 0] * work[j, 8] - push[j, 1] * work[j, 7]
