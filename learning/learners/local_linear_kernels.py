"""Compiled steps of the local linear map: blend, insert, update (Eq. 17-22 of the paper).

Notation of the arguments used throughout: ``grid`` cell list of the prototypes, ``counts`` integer
array [prototypes, entries of the grid], ``parameters`` (M, n, 1 + r) with offset o in column 0 and
slope W in the rest, ``work`` scratch of ``Scratch``, ``rule`` the constants of ``Rule``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from learning.learners.cell_grid import enter, find_near, scan_all

Array = NDArray[np.float64]


class Rule(NamedTuple):
    """Constants of the update.

    Attributes
    ----------
    radius : float
        d of Eq. 17 [rad].
    kernel : float
        Width of the responsibility [rad]: kappa d (d in Eq. 18).
    rate : float
        eta of Eq. 20; one step moves by 2 eta times the error (gradient of a square).
    iterations : int
        Gradient steps per sample; 0: until the error has vanished.
    relaxation : float
        Share of the error taken away when ``iterations`` is 0.
    looped : bool
        Do the steps one by one instead of in closed form.
    several_images : bool
        Whether a prototype can appear at several periodic images in one search.
    """

    radius: float
    kernel: float
    rate: float
    iterations: int
    relaxation: float
    looped: bool
    several_images: bool


class Scratch(NamedTuple):
    """Working memory for one point: what was found near it, and sums over it."""

    found: NDArray[np.int32]
    offset: Array
    squared: Array
    responsibility: Array
    output: Array
    local: Array
    totals: Array


def make_scratch(entries: int, points: int, rank: int, outputs: int) -> Scratch:
    """Room for everything a search can find (one more row than that is touched)."""
    size = max(entries, points) + 2
    return Scratch(
        np.zeros(size, dtype=np.int32),
        np.zeros((size, rank)),
        np.zeros(size),
        np.zeros(size),
        np.zeros(outputs),
        np.zeros(outputs),
        np.zeros((points + 2, 1 + rank)),
    )


@njit(cache=True)
def search(grid, counts, y, work):
    """Find the prototypes that matter at y; how many, and the least squared distance.

    Beyond the reach of every kernel the responsibilities of Eq. 18 still sum to one: then all
    prototypes hardly farther than the nearest one are taken.
    """
    found, least = find_near(grid, counts[0], y, work.found, work.offset, work.squared)
    if found == 0 and counts[0] > 0:
        _, least = scan_all(grid, counts[0], y, -1.0, work.found, work.offset, work.squared)
        limit = least + grid.search_radius * grid.search_radius
        found, least = scan_all(grid, counts[0], y, limit, work.found, work.offset, work.squared)
    return found, least


@njit(cache=True)
def weigh(work, found, least, kernel):
    """Normalised responsibilities (Eq. 18), relative to the nearest so that none underflows."""
    total = 0.0
    scale = -1.0 / (kernel * kernel)
    for e in range(found):
        weight = np.exp((work.squared[e] - least) * scale)
        work.responsibility[e] = weight
        total += weight
    total = 1.0 / total
    for e in range(found):
        work.responsibility[e] *= total


@njit(cache=True)
def blend(parameters, work, found, radius):
    """The estimate of Eq. 18, into ``work.output``."""
    outputs = work.output.size
    rank = work.offset.shape[1]
    inverse = 1.0 / radius
    for j in range(outputs):
        work.output[j] = 0.0
    for e in range(found):
        p = work.found[e]
        weight = work.responsibility[e]
        for j in range(outputs):
            value = 0.0
            for k in range(rank):
                value += parameters[p, j, 1 + k] * work.offset[e, k]
            work.output[j] += weight * (parameters[p, j, 0] + value * inverse)


@njit(cache=True)
def slope(parameters, work, found, rule, jacobian):
    """Derivative of the estimate by ``L y``, shape (n, r), derivative of the weights included."""
    outputs = work.output.size
    rank = work.offset.shape[1]
    mean = np.zeros(rank)
    for e in range(found):
        for k in range(rank):
            mean[k] += work.responsibility[e] * work.offset[e, k]
    jacobian[:] = 0.0
    factor = 2.0 / (rule.kernel * rule.kernel)
    for e in range(found):
        p = work.found[e]
        weight = work.responsibility[e]
        for j in range(outputs):
            value = parameters[p, j, 0]
            for k in range(rank):
                value += parameters[p, j, 1 + k] * work.offset[e, k] / rule.radius
            for k in range(rank):
                jacobian[j, k] += weight * (
                    parameters[p, j, 1 + k] / rule.radius
                    + value * factor * (mean[k] - work.offset[e, k])
                )


@njit(cache=True)
def insert(grid, counts, parameters, y, torque, found, least, work, rule):
    """Add a prototype at y (Eq. 19, or Eq. 22 more than 2 d from all others)."""
    number = counts[0]
    rank = y.size
    outputs = torque.size
    if found > 0 and least <= 4.0 * rule.radius * rule.radius:
        weigh(work, found, least, rule.kernel)
        blend(parameters, work, found, rule.radius)
        jacobian = np.empty((outputs, rank))
        slope(parameters, work, found, rule, jacobian)
        for j in range(outputs):
            parameters[number, j, 0] = work.output[j]
            for k in range(rank):
                parameters[number, j, 1 + k] = rule.radius * jacobian[j, k]
    else:
        for j in range(outputs):
            parameters[number, j, 0] = torque[j]
            for k in range(rank):
                parameters[number, j, 1 + k] = 0.0
    counts[1] = enter(grid, counts[1], number, y)
    counts[0] = number + 1


@njit(cache=True)
def squared_features(work, found, rule):
    """Squared length of the feature vector: the change of the estimate per unit step."""
    rank = work.offset.shape[1]
    total = 0.0
    if not rule.several_images:
        for e in range(found):
            local = work.squared[e] / (rule.radius * rule.radius)
            total += work.responsibility[e] * work.responsibility[e] * (1.0 + local)
        return total
    for e in range(found):
        p = work.found[e]
        work.totals[p, 0] += work.responsibility[e]
        for k in range(rank):
            work.totals[p, 1 + k] += work.responsibility[e] * work.offset[e, k] / rule.radius
    for e in range(found):
        p = work.found[e]
        for k in range(1 + rank):
            total += work.totals[p, k] * work.totals[p, k]
            work.totals[p, k] = 0.0
    return total


@njit(cache=True)
def descend(parameters, work, found, torque, rule, step):
    """One move of the parameters by ``step`` times error times features (Eq. 20, 21)."""
    outputs = torque.size
    rank = work.offset.shape[1]
    for j in range(outputs):
        work.local[j] = step * (torque[j] - work.output[j])
    inverse = 1.0 / rule.radius
    for e in range(found):
        p = work.found[e]
        weight = work.responsibility[e]
        for j in range(outputs):
            move = weight * work.local[j]
            parameters[p, j, 0] += move
            move *= inverse
            for k in range(rank):
                parameters[p, j, 1 + k] += move * work.offset[e, k]


@njit(cache=True)
def update(grid, counts, parameters, y, torque, sample_weight, work, rule):
    """Learn that ``torque`` holds the wrapped point y: insert, then descend."""
    found, least = search(grid, counts, y, work)
    if found == 0 or least >= rule.radius * rule.radius:
        insert(grid, counts, parameters, y, torque, found, least, work, rule)
        found, least = search(grid, counts, y, work)
    weigh(work, found, least, rule.kernel)
    blend(parameters, work, found, rule.radius)
    step = 2.0 * rule.rate * sample_weight
    if rule.looped:
        for _ in range(rule.iterations):
            descend(parameters, work, found, torque, rule, step)
            blend(parameters, work, found, rule.radius)
        return
    if rule.iterations != 1 and sample_weight > 0.0:
        length = squared_features(work, found, rule)
        if rule.iterations == 0:
            step = rule.relaxation / length
        else:
            step = (1.0 - (1.0 - step * length) ** rule.iterations) / length
    descend(parameters, work, found, torque, rule, step)


@njit(cache=True)
def update_copies(grid, counts, parameters, symmetries, q, torque, sample_weight, work, rule):
    """Learn all symmetric copies of one sample (q, torque)."""
    basis, A_sat, d_sat, signs = symmetries
    order, rank, _ = A_sat.shape
    joints = q.size
    y = np.empty(rank)
    image = np.empty(rank)
    signed = np.empty(torque.size)
    for i in range(rank):
        y[i] = 0.0
        for j in range(joints):
            y[i] += basis[i, j] * q[j]
    for g in range(order):
        for i in range(rank):
            value = d_sat[g, i]
            for j in range(rank):
                value += A_sat[g, i, j] * y[j]
            image[i] = value - 2 * np.pi * np.floor(value / (2 * np.pi) + 0.5)
        for j in range(torque.size):
            signed[j] = signs[g, j] * torque[j]
        update(grid, counts, parameters, image, signed, sample_weight, work, rule)


@njit(cache=True)
def train(
    grid, counts, parameters, symmetries, q, torque, weights, memory_q, memory_torque, stored,
    draws, work, rule,
):  # fmt: skip
    """Learn samples in their order, each followed by the replay of remembered ones.

    ``stored`` is [samples remembered, samples seen]; ``draws`` (m, 1 + replays) are uniform random
    numbers. Returns how many samples were learned: fewer than given when there might be no room
    for another prototype.
    """
    samples = q.shape[0]
    replays = draws.shape[1] - 1
    needed = A_count(symmetries) * (1 + max(replays, 0))
    for s in range(samples):
        if counts[0] + needed > parameters.shape[0]:
            return s
        update_copies(grid, counts, parameters, symmetries, q[s], torque[s], weights[s], work, rule)
        if replays <= 0:
            continue
        stored[1] += 1
        slot = stored[0]
        if slot < memory_q.shape[0]:
            stored[0] += 1
        else:
            slot = int(draws[s, 0] * stored[1])
        if slot < memory_q.shape[0]:
            memory_q[slot] = q[s]
            memory_torque[slot] = torque[s]
        for r in range(replays):
            old = int(draws[s, 1 + r] * stored[0])
            update_copies(
                grid, counts, parameters, symmetries, memory_q[old], memory_torque[old], 1.0,
                work, rule,
            )  # fmt: skip
    return samples


@njit(cache=True)
def A_count(symmetries):
    """Order of the group."""
    return symmetries[1].shape[0]


@njit(cache=True)
def predict_batch(grid, counts, parameters, y, work, rule, result):
    """Estimates at the wrapped points y (m, r), into ``result`` (m, n)."""
    for s in range(y.shape[0]):
        found, least = search(grid, counts, y[s], work)
        weigh(work, found, least, rule.kernel)
        blend(parameters, work, found, rule.radius)
        result[s] = work.output


@njit(cache=True)
def slope_batch(grid, counts, parameters, y, work, rule, result):
    """Derivatives of the estimate by ``L y`` at the points y (m, r), into ``result`` (m, n, r)."""
    for s in range(y.shape[0]):
        found, least = search(grid, counts, y[s], work)
        weigh(work, found, least, rule.kernel)
        slope(parameters, work, found, rule, result[s])
