"""Levenberg's and Marquardt's method on rotations, levers eliminated: compiled.

Arguments as in `compiled_torque`, and: ``whitening`` (m, n, n) lower triangular, errors of a pose
times it are independent with standard deviation 1; ``extra`` (m, n, p) columns that are linear in
unknown coefficients; ``free_turns`` (2 n,), ``free_levers`` (2 n,), ``free_gains`` (n,) which
unknowns may change; ``canonical`` whether tangents are those of offset and twist.
"""

from __future__ import annotations

import numpy as np

from isotorque.learning.learners.rigid.fitting.compiled_torque import chain_jacobian
from isotorque.symbolic.common.compiled import compiled

RIDGE = 1e-12
"""Added to the normal equations of columns scaled to length 1, against exact dependency."""
NEGLIGIBLE = 1e-9
"""Columns shorter than this, relative to the longest, are scaled as if they were so long."""
TINY = 1e-100
"""Length that stands for that of the longest column where all are zero."""
DROPPED = 1e150
"""Pivot of an unknown that drops out."""
MOST_GAIN = 50.0
"""Gains may grow to so many times what they started from."""


@compiled(error_model="numpy")
def rotation_about(vector):
    """Exp of a rotation vector (3,) [rad] (Rodrigues)."""
    x, y, z = vector[0], vector[1], vector[2]
    angle = np.sqrt(x * x + y * y + z * z)
    if angle < 1e-8:
        a, b = 1.0 - angle * angle / 6.0, 0.5
    else:
        a, b = np.sin(angle) / angle, (1.0 - np.cos(angle)) / (angle * angle)
    R = np.empty((3, 3))
    R[0, 0] = 1.0 - b * (y * y + z * z)
    R[1, 1] = 1.0 - b * (x * x + z * z)
    R[2, 2] = 1.0 - b * (x * x + y * y)
    R[0, 1], R[1, 0] = b * x * y - a * z, b * x * y + a * z
    R[0, 2], R[2, 0] = b * x * z + a * y, b * x * z - a * y
    R[1, 2], R[2, 1] = b * y * z - a * x, b * y * z + a * x
    return R


@compiled(error_model="numpy")
def set_directions(rotations, canonical, directions):
    """Tangents: about y and x; canonical: offset (about the parent's z), then twist (about x)."""
    for j in range(len(rotations)):
        for a in range(3):
            directions[j, 0, a] = rotations[j, 2, a] if canonical else 0.0
            directions[j, 1, a] = 0.0
        if not canonical:
            directions[j, 0, 1] = 1.0
        directions[j, 1, 0] = 1.0


@compiled(error_model="numpy")
def turn(rotations, directions, steps):
    """Rotations moved along their tangents, the first then the second."""
    result = np.empty_like(rotations)
    for j in range(len(rotations)):
        first = rotation_about(directions[j, 0] * steps[2 * j])
        second = rotation_about(directions[j, 1] * steps[2 * j + 1])
        turned = product(product(rotations[j], first), second)
        for a in range(3):  # entry by entry: to assign a matrix takes numba seconds to compile
            for b in range(3):
                result[j, a, b] = turned[a, b]
    return result


@compiled(error_model="numpy")
def product(A, B):
    """Product of two (3, 3) matrices."""
    C = np.empty((3, 3))
    for a in range(3):
        for b in range(3):
            C[a, b] = A[a, 0] * B[0, b] + A[a, 1] * B[1, b] + A[a, 2] * B[2, b]
    return C


@compiled(error_model="numpy")
def gram(rows):
    """``rows^T rows``."""
    return rows.T @ rows


@compiled(error_model="numpy")
def against(rows, values):
    """``rows^T values``."""
    result = np.zeros(rows.shape[1])
    for i in range(rows.shape[0]):
        for c in range(rows.shape[1]):
            result[c] += rows[i, c] * values[i]
    return result


@compiled(error_model="numpy")
def solve_definite(matrix, right):
    """Solve ``matrix x = right`` (p, k) by Cholesky's factors; both are overwritten.

    Unknowns of which rounding leaves nothing are set to zero.
    """
    p, k = right.shape
    for j in range(p):
        pivot = matrix[j, j]
        for c in range(j):
            pivot -= matrix[j, c] * matrix[j, c]
        matrix[j, j] = np.sqrt(pivot) if pivot > 0.0 else DROPPED
        for i in range(j + 1, p):
            value = matrix[i, j]
            for c in range(j):
                value -= matrix[i, c] * matrix[j, c]
            matrix[i, j] = value / matrix[j, j]
    for b in range(k):
        for i in range(p):
            value = right[i, b]
            for c in range(i):
                value -= matrix[i, c] * right[c, b]
            right[i, b] = value / matrix[i, i]
        for i in range(p - 1, -1, -1):
            value = right[i, b]
            for c in range(i + 1, p):
                value -= matrix[c, i] * right[c, b]
            right[i, b] = value / matrix[i, i]
    return right


@compiled(error_model="numpy")
def fill(
    parents,
    rotations,
    levers,
    gains,
    directions,
    q,
    whitening,
    extra,
    free_turns,
    free_levers,
    free_gains,
    rows,
    torque,
    turned,
    leant,
    stiffness,
):
    """Whitened derivatives by all free unknowns, into ``rows`` (m n, nonlinear + linear).

    Order: turns, gains; levers, coefficients.
    """
    m, n = q.shape
    chain_jacobian(parents, rotations, levers, directions, q, torque, turned, leant, stiffness)
    for k in range(m):
        for i in range(n):
            row = rows[k * n + i]
            row[:] = 0.0
            for l in range(i + 1):
                w = whitening[k, i, l]
                if w == 0.0:
                    continue
                wg = w * gains[l]
                c = 0
                for b in range(2 * n):
                    if free_turns[b]:
                        row[c] += wg * turned[k, l, b]
                        c += 1
                for b in range(n):
                    if free_gains[b]:
                        if b == l:
                            row[c] += w * torque[k, l]
                        c += 1
                for b in range(2 * n):
                    if free_levers[b]:
                        row[c] += wg * leant[k, l, b]
                        c += 1
                for b in range(extra.shape[2]):
                    row[c] += w * extra[k, l, b]
                    c += 1


@compiled(error_model="numpy")
def whitened(values, whitening):
    """Values (m, n) times the whitening of their pose, flat."""
    m, n = values.shape
    result = np.zeros(m * n)
    for k in range(m):
        for i in range(n):
            for l in range(i + 1):
                result[k * n + i] += whitening[k, i, l] * values[k, l]
    return result


@compiled(error_model="numpy")
def solved(design, target):
    """Least squares by normal equations of scaled columns, refined once; and the residual."""
    normal = gram(design)
    p = len(normal)
    scale = np.empty(p)
    longest = TINY
    for c in range(p):
        scale[c] = np.sqrt(normal[c, c])
        longest = max(longest, scale[c])
    for c in range(p):
        scale[c] = max(scale[c], NEGLIGIBLE * longest)
    for a in range(p):
        for b in range(p):
            normal[a, b] /= scale[a] * scale[b]
        normal[a, a] += RIDGE
    solution = np.zeros(p)
    rest = target.copy()
    for _ in range(2):
        right = (against(design, rest) / scale).reshape(p, 1)
        solution += solve_definite(normal.copy(), right)[:, 0] / scale
        for i in range(len(target)):
            value = target[i]
            for c in range(p):
                value -= design[i, c] * solution[c]
            rest[i] = value
    return solution, rest


@compiled(error_model="numpy")
def levenberg_marquardt(
    parents,
    rotations,
    gains,
    q,
    torques,
    whitening,
    extra,
    free_turns,
    free_levers,
    free_gains,
    canonical,
    iterations,
    progress,
    enough,
):
    """Minimise the sum of squares of whitened torque errors from one start.

    Parameters
    ----------
    iterations : int
        Accepted steps at most.
    progress : float
        Stop where a step lowers the sum by a smaller share.
    enough : float
        Stop at a sum below.

    Returns
    -------
    rotations, levers, gains, coefficients, cost, steps

    Notes
    -----
    Levers and coefficients are linear: they are eliminated (variable projection with Kaufman's
    approximation of the Jacobian, that is, the Schur complement of the normal equations).
    """
    m, n = q.shape
    turns, levers_free, gains_free = 0, 0, 0
    for b in range(2 * n):
        turns += free_turns[b]
        levers_free += free_levers[b]
    for b in range(n):
        gains_free += free_gains[b]
    p = extra.shape[2]
    curved, flat = turns + gains_free, levers_free + p
    rows = np.zeros((m * n, curved + flat))
    torque, turned = np.empty((m, n)), np.empty((m, n, 2 * n))
    leant, stiffness = np.empty((m, n, 2 * n)), np.empty((m, n, n))
    directions = np.empty((n, 2, 3))
    start_gains, rotations, gains = gains, rotations.copy(), gains.copy()
    levers = np.zeros((n, 2))
    target = whitened(torques, whitening)
    set_directions(rotations, canonical, directions)
    fill(
        parents,
        rotations,
        levers,
        gains,
        directions,
        q,
        whitening,
        extra,
        free_turns,
        free_levers,
        free_gains,
        rows,
        torque,
        turned,
        leant,
        stiffness,
    )
    linear, rest = solved(np.ascontiguousarray(rows[:, curved:]), target)
    cost = rest @ rest
    damping, taken = 1e-2, 0
    small = 0
    steps = np.zeros(2 * n)
    while taken < iterations and cost > enough:
        c = 0
        for b in range(2 * n):
            levers[b // 2, b % 2] = 0.0
            if free_levers[b]:
                levers[b // 2, b % 2] = linear[c]
                c += 1
        set_directions(rotations, canonical, directions)
        fill(
            parents,
            rotations,
            levers,
            gains,
            directions,
            q,
            whitening,
            extra,
            free_turns,
            free_levers,
            free_gains,
            rows,
            torque,
            turned,
            leant,
            stiffness,
        )
        normal = gram(rows)
        downhill = against(rows, rest)[:curved].copy()
        reduced = normal[:curved, :curved].copy()
        if flat > 0:
            block, across = normal[curved:, curved:].copy(), normal[curved:, :curved].copy()
            longest = TINY
            for a in range(flat):
                longest = max(longest, np.sqrt(block[a, a]))
            scale = np.empty(flat)
            for a in range(flat):
                scale[a] = max(np.sqrt(block[a, a]), NEGLIGIBLE * longest)
            for a in range(flat):
                for b in range(flat):
                    block[a, b] /= scale[a] * scale[b]
                block[a, a] += RIDGE
                for b in range(curved):
                    across[a, b] /= scale[a]
            solved_across = solve_definite(block, across.copy())
            for a in range(curved):
                for b in range(curved):
                    for c in range(flat):
                        reduced[a, b] -= across[c, a] * solved_across[c, b]
        longest = TINY
        for a in range(curved):
            longest = max(longest, reduced[a, a])
        better = False
        tried_cost = cost
        for _ in range(8):
            damped = reduced.copy()
            for a in range(curved):
                damped[a, a] += damping * max(reduced[a, a], 1e-7 * longest)
            move = solve_definite(damped, downhill.copy().reshape(curved, 1))[:, 0]
            if not np.all(np.isfinite(move)):
                damping *= 5.0
                continue
            steps[:] = 0.0
            c = 0
            for b in range(2 * n):
                if free_turns[b]:
                    steps[b] = move[c]
                    c += 1
            tried_gains = gains.copy()
            run_away = False
            for b in range(n):
                if free_gains[b]:
                    tried_gains[b] += move[c]
                    run_away = run_away or abs(tried_gains[b]) > MOST_GAIN * abs(start_gains[b])
                    c += 1
            if run_away:
                damping *= 5.0
                continue
            tried = turn(rotations, directions, steps)
            fill_linear(
                parents, tried, tried_gains, q, whitening, extra, free_levers, rows, curved, leant
            )
            tried_linear, tried_rest = solved(np.ascontiguousarray(rows[:, curved:]), target)
            tried_cost = tried_rest @ tried_rest
            if tried_cost < cost:
                better = True
                break
            damping *= 5.0
        if not better:
            break
        share = (cost - tried_cost) / cost
        rotations, gains, linear, rest = tried, tried_gains, tried_linear, tried_rest
        cost = tried_cost
        damping = max(damping / 5.0, 1e-10)
        taken += 1
        small = small + 1 if share < progress else 0
        if small >= 2:
            break
    c = 0
    for b in range(2 * n):
        levers[b // 2, b % 2] = 0.0
        if free_levers[b]:
            levers[b // 2, b % 2] = linear[c]
            c += 1
    return rotations, levers, gains, linear[c:].copy(), cost, taken


@compiled(error_model="numpy")
def fill_linear(parents, rotations, gains, q, whitening, extra, free_levers, rows, first, leant):
    """Whitened derivatives by levers and coefficients, into the columns of rows from ``first``."""
    m, n = q.shape
    lever_columns(parents, rotations, q, leant)
    for k in range(m):
        for i in range(n):
            row = rows[k * n + i]
            row[first:] = 0.0
            for l in range(i + 1):
                w = whitening[k, i, l]
                if w == 0.0:
                    continue
                wg = w * gains[l]
                c = first
                for b in range(2 * n):
                    if free_levers[b]:
                        row[c] += wg * leant[k, l, b]
                        c += 1
                for b in range(extra.shape[2]):
                    row[c] += w * extra[k, l, b]
                    c += 1


@compiled(error_model="numpy")
def lever_columns(parents, rotations, q, leant):
    """Derivatives of the torques by the levers alone, into ``leant`` (m, n, 2 n)."""
    m, n = q.shape
    gravity, carried, below = np.empty((n, 3)), np.empty((n, 3)), np.empty(n, dtype=np.bool_)
    placed = np.empty((n, 3, 3))
    leant[:] = 0.0
    for k in range(m):
        for j in range(n):
            c, s = np.cos(q[k, j]), np.sin(q[k, j])
            p = parents[j]
            for a in range(3):
                x, y = rotations[j, a, 0], rotations[j, a, 1]
                placed[j, a, 0] = x * c + y * s
                placed[j, a, 1] = y * c - x * s
                placed[j, a, 2] = rotations[j, a, 2]
            for a in range(3):
                if p < 0:
                    gravity[j, a] = placed[j, 2, a]
                else:
                    gravity[j, a] = (
                        placed[j, 0, a] * gravity[p, 0]
                        + placed[j, 1, a] * gravity[p, 1]
                        + placed[j, 2, a] * gravity[p, 2]
                    )
        for i in range(n):
            for b in range(i, n):
                p = parents[b]
                below[b] = b == i or (p >= i and below[p])
                if not below[b]:
                    continue
                if b == i:
                    carried[b, 0], carried[b, 1], carried[b, 2] = gravity[i, 1], -gravity[i, 0], 0.0
                else:
                    for a in range(3):
                        carried[b, a] = (
                            placed[b, 0, a] * carried[p, 0]
                            + placed[b, 1, a] * carried[p, 1]
                            + placed[b, 2, a] * carried[p, 2]
                        )
                leant[k, i, 2 * b] = carried[b, 0]
                leant[k, i, 2 * b + 1] = carried[b, 1]
