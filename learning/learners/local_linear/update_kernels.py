"""Compiled update of the local linear map: insert prototypes, descend the error (Eq. 19-22).

Arguments as in `predict_kernels`.
"""

from __future__ import annotations

import numpy as np

from isotorque.learning.learners.local_linear.cell_list_search import enter, find_near
from isotorque.learning.learners.local_linear.predict_kernels import blend, search, slope, weigh
from isotorque.symbolic.common.compiled import compiled, tuple_setitem


@compiled
def insert(grid, counts, parameters, y, torque, found, least, work, rule):
    """Add a prototype at y (Eq. 19, or Eq. 22 more than 2 d from all others)."""
    number = counts[0]
    if found > 0 and least <= 4.0 * rule.radius * rule.radius:
        weigh(work, found, least, rule.kernel)
        blend(parameters, work, found, grid.axes, rule)
        jacobian = np.empty((torque.size, y.size))
        slope(parameters, work, found, grid.axes, rule, jacobian)
        for j in range(torque.size):
            parameters[number, j, 0] = work.output[j]
            for k in range(y.size):
                parameters[number, j, 1 + k] = rule.radius * jacobian[j, k]
    else:
        for j in range(torque.size):
            parameters[number, j, 0] = torque[j]
            for k in range(y.size):
                parameters[number, j, 1 + k] = 0.0
    counts[1] = enter(grid, counts[1], number, y)
    counts[0] = number + 1


@compiled
def squared_features(work, found, rank, rule):
    """Squared length of the feature vector: the change of the estimate per unit step."""
    total = 0.0
    if not rule.several_images:
        for e in range(found):
            local = work.squared[e] / (rule.radius * rule.radius)
            total += work.responsibility[e] * work.responsibility[e] * (1.0 + local)
        return total
    for e in range(found):
        p = work.found[e]
        work.totals[p, 0] += work.responsibility[e]
        for k in range(len(rank)):
            work.totals[p, 1 + k] += work.responsibility[e] * work.offset[e, k] / rule.radius
    for e in range(found):
        p = work.found[e]
        for k in range(1 + len(rank)):
            total += work.totals[p, k] * work.totals[p, k]
            work.totals[p, k] = 0.0
    return total


@compiled(error_model="numpy")
def descend(parameters, work, found, torque, step, rank, rule):
    """One move of the parameters by ``step`` times error times features (Eq. 20, 21)."""
    responsibility, offset = work.responsibility, work.offset
    error = rule.joints
    for j in range(len(rule.joints)):
        error = tuple_setitem(error, j, step * (torque[j] - work.output[j]))
    inverse = 1.0 / rule.radius
    for e in range(found):
        p = work.found[e]
        weight = responsibility[e]
        for j in range(len(rule.joints)):
            move = weight * error[j]
            parameters[p, j, 0] += move
            move *= inverse
            for k in range(len(rank)):
                parameters[p, j, 1 + k] += move * offset[e, k]


@compiled(forceinline=True)
def learn(parameters, work, found, torque, sample_weight, rank, rule):
    """Gradient steps on one sample whose estimate is in ``work``, in closed form if so ruled."""
    step = 2.0 * rule.rate * sample_weight
    if rule.looped:
        for _ in range(rule.iterations):
            descend(parameters, work, found, torque, step, rank, rule)
            blend(parameters, work, found, rank, rule)
        return
    if rule.iterations != 1 and sample_weight > 0.0:
        length = squared_features(work, found, rank, rule)
        if rule.iterations == 0:
            step = rule.relaxation / length
        else:
            step = (1.0 - (1.0 - step * length) ** rule.iterations) / length
    descend(parameters, work, found, torque, step, rank, rule)


@compiled
def update(grid, counts, parameters, y, torque, sample_weight, work, rule):
    """Learn that ``torque`` holds the wrapped point y: insert, then descend."""
    found, least = search(grid, counts, y, work)
    if found == 0 or least >= rule.radius * rule.radius:
        insert(grid, counts, parameters, y, torque, found, least, work, rule)
        found, least = search(grid, counts, y, work)
    weigh(work, found, least, rule.kernel)
    blend(parameters, work, found, grid.axes, rule)
    learn(parameters, work, found, torque, sample_weight, grid.axes, rule)


@compiled(forceinline=True)
def symmetric_copy(symmetries, q, torque, g, y, signed):
    """Coordinates, wrapped, and torque of copy g of a sample, into ``y`` and ``signed``."""
    basis, A_sat, d_sat, signs = symmetries
    for i in range(y.size):
        value = d_sat[g, i]
        for k in range(y.size):
            for j in range(q.size):
                value += A_sat[g, i, k] * basis[k, j] * q[j]
        y[i] = value - 2 * np.pi * np.floor(value / (2 * np.pi) + 0.5)
    for j in range(torque.size):
        signed[j] = signs[g, j] * torque[j]


@compiled
def remember(stored, memory_q, memory_torque, q, torque, draw):
    """Keep a sample for replay; when memory is full each one seen is kept equally likely."""
    slot = stored[0]
    stored[1] += 1
    if slot < memory_q.shape[0]:
        stored[0] += 1
    else:
        slot = int(draw * stored[1])
    if slot < memory_q.shape[0]:
        # entry by entry: to assign rows takes numba longer to compile than all the rest
        for i in range(q.shape[0]):
            memory_q[slot, i] = q[i]
        for i in range(torque.shape[0]):
            memory_torque[slot, i] = torque[i]


@compiled
def run(
    grid,
    parameters,
    symmetries,
    q,
    torque,
    weights,
    memory_q,
    memory_torque,
    stored,
    draws,
    work,
    rule,
    progress,
    y,
    signed,
):
    """Learn samples from ``progress`` on, until one needs a new prototype or all are done.

    ``progress`` is [sample, item (0: the sample itself, then replays), copy]. Returns whether
    something is left; its coordinates, torque and weight then are in ``y`` and ``signed``.

    Kept apart from ``train`` because a call that passes ``grid`` costs as much as all the rest,
    even in a branch that is not taken.
    """
    near = rule.radius * rule.radius
    items = max(draws.shape[1], 1)
    order = symmetries[1].shape[0]
    while progress[0] < q.shape[0]:
        s = progress[0]
        while progress[1] < items:
            item = progress[1]
            x, tau, weight = q[s], torque[s], weights[s]
            if item > 0:
                old = int(draws[s, item] * stored[0])
                x, tau, weight = memory_q[old], memory_torque[old], 1.0
            while progress[2] < order:
                symmetric_copy(symmetries, x, tau, progress[2], y, signed[:-1])
                found, least = find_near(grid, y, work.found, work.offset, work.squared)
                if found == 0 or least >= near:
                    signed[-1] = weight
                    return True
                weigh(work, found, least, rule.kernel)
                blend(parameters, work, found, grid.axes, rule)
                learn(parameters, work, found, signed, weight, grid.axes, rule)
                progress[2] += 1
            progress[2] = 0
            progress[1] += 1
            if item == 0 and draws.shape[1] > 0:
                remember(stored, memory_q, memory_torque, q[s], torque[s], draws[s, 0])
        progress[1] = 0
        progress[0] += 1
    return False


@compiled
def train(
    grid,
    counts,
    parameters,
    symmetries,
    q,
    torque,
    weights,
    memory_q,
    memory_torque,
    stored,
    draws,
    work,
    rule,
    progress,
):
    """Learn samples in their order, each followed by the replay of remembered ones.

    ``stored`` is [samples remembered, samples seen]; ``draws`` (m, 1 + replays) are uniform random
    numbers, without columns where nothing is replayed; ``progress`` as in ``run``. Returns whether
    all samples were learned: if not, there is no room for another prototype.
    """
    y = np.empty(symmetries[1].shape[1])
    signed = np.empty(torque.shape[1] + 1)
    while run(
        grid,
        parameters,
        symmetries,
        q,
        torque,
        weights,
        memory_q,
        memory_torque,
        stored,
        draws,
        work,
        rule,
        progress,
        y,
        signed,
    ):
        if counts[0] == parameters.shape[0]:
            return False
        update(grid, counts, parameters, y, signed[:-1], signed[-1], work, rule)
        progress[2] += 1
    return True
