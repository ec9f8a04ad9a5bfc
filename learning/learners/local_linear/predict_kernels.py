"""Compiled pieces of the local linear map: find, weigh and blend local functions (Eq. 17, 18).

Arguments used throughout: ``grid`` cell list of the prototypes, ``counts`` integer array
[prototypes, entries of the grid], ``parameters`` (M, n, 1 + r) with offset o in column 0 and slope
W in the rest, ``work`` a ``Scratch``, ``rule`` a ``Rule``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.local_linear.cell_list import CellList
from isotorque.learning.learners.local_linear.cell_list_search import find_far, find_near
from isotorque.symbolic.common.compiled import compiled, tuple_setitem

Array = NDArray[np.float64]


class Rule(NamedTuple):
    """Constants of the map.

    Attributes
    ----------
    joints : tuple of n zeros
        Its length tells the compiler the number of outputs.
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

    joints: tuple[float, ...]
    radius: float
    kernel: float
    rate: float
    iterations: int
    relaxation: float
    looped: bool
    several_images: bool


class Scratch(NamedTuple):
    """Working memory for one point.

    Attributes
    ----------
    found, offset, squared, responsibility : (e,), (e, r), (e,), (e,) arrays
        What a search found: number of the prototype, ``L (y - p)``, its squared length, h.
    output : (n,) array
        Estimate.
    totals : (p, 1 + r) array
        Sums per prototype, zero between uses.
    """

    found: NDArray[np.int32]
    offset: Array
    squared: Array
    responsibility: Array
    output: Array
    totals: Array


def make_scratch(grid: CellList, outputs: int) -> Scratch:
    """Room for everything a search in ``grid`` can find (one more row than that is touched)."""
    points, rank = grid.point.shape
    size = max(len(grid.number), points) + 2
    return Scratch(
        np.zeros(size, dtype=np.int32),
        np.zeros((size, rank)),
        np.zeros(size),
        np.zeros(size),
        np.zeros(outputs),
        np.zeros((points + 2, 1 + rank)),
    )


@compiled(error_model="numpy")
def exponential(x):
    """exp(x) for x from -60 to 0, to 1e-14 near 0 and a share of 1e-6 at -40.

    Taylor series of exp(x / 64), squared six times: unlike a library call, loops over it are
    vectorised.
    """
    t = x * (1.0 / 64.0)
    series = 1.0 + t * (1.0 / 9.0)
    series = 1.0 + series * t * (1.0 / 8.0)
    series = 1.0 + series * t * (1.0 / 7.0)
    series = 1.0 + series * t * (1.0 / 6.0)
    series = 1.0 + series * t * (1.0 / 5.0)
    series = 1.0 + series * t * (1.0 / 4.0)
    series = 1.0 + series * t * (1.0 / 3.0)
    series = 1.0 + series * t * (1.0 / 2.0)
    series = 1.0 + series * t
    for _ in range(6):
        series = series * series
    return series


@compiled
def search(grid, counts, y, work):
    """Find the prototypes that matter at y; how many, and the least squared distance.

    Beyond the reach of every kernel the responsibilities of Eq. 18 still sum to one: then all
    prototypes hardly farther than the nearest one are taken.
    """
    found, least = find_near(grid, y, work.found, work.offset, work.squared)
    if found == 0 and counts[0] > 0:
        found, least = find_far(grid, counts[0], y, work.found, work.offset, work.squared)
    return found, least


@compiled(error_model="numpy")
def weigh(work, found, least, kernel):
    """Normalised responsibilities (Eq. 18), relative to the nearest so that none underflows."""
    squared, responsibility = work.squared, work.responsibility
    scale = -1.0 / (kernel * kernel)
    total = 0.0
    for e in range(found):
        weight = exponential((squared[e] - least) * scale)
        responsibility[e] = weight
        total += weight
    total = 1.0 / total
    for e in range(found):
        responsibility[e] *= total


@compiled(error_model="numpy")
def blend(parameters, work, found, rank, rule):
    """The estimate of Eq. 18, into ``work.output``."""
    responsibility, offset, output = work.responsibility, work.offset, work.output
    inverse = 1.0 / rule.radius
    sums = rule.joints
    for e in range(found):
        p = work.found[e]
        weight = responsibility[e]
        for j in range(len(rule.joints)):
            value = 0.0
            for k in range(len(rank)):
                value += parameters[p, j, 1 + k] * offset[e, k]
            value = parameters[p, j, 0] + value * inverse
            sums = tuple_setitem(sums, j, sums[j] + weight * value)
    for j in range(len(rule.joints)):
        output[j] = sums[j]


@compiled
def slope(parameters, work, found, rank, rule, jacobian):
    """Derivative of the estimate by ``L y``, shape (n, r), derivative of the weights included."""
    mean = np.zeros(len(rank))
    for e in range(found):
        for k in range(len(rank)):
            mean[k] += work.responsibility[e] * work.offset[e, k]
    jacobian[:] = 0.0
    factor = 2.0 / (rule.kernel * rule.kernel)
    for e in range(found):
        p = work.found[e]
        weight = work.responsibility[e]
        for j in range(len(rule.joints)):
            value = parameters[p, j, 0]
            for k in range(len(rank)):
                value += parameters[p, j, 1 + k] * work.offset[e, k] / rule.radius
            for k in range(len(rank)):
                jacobian[j, k] += weight * (
                    parameters[p, j, 1 + k] / rule.radius
                    + value * factor * (mean[k] - work.offset[e, k])
                )


@compiled
def predict_batch(grid, counts, parameters, y, work, rule, result):
    """Estimates at the wrapped points y (m, r), into ``result`` (m, n)."""
    for s in range(y.shape[0]):
        found, least = search(grid, counts, y[s], work)
        weigh(work, found, least, rule.kernel)
        blend(parameters, work, found, grid.axes, rule)
        for j in range(result.shape[1]):  # to assign rows takes numba seconds to compile
            result[s, j] = work.output[j]


@compiled
def slope_batch(grid, counts, parameters, y, work, rule, result):
    """Derivatives of the estimate by ``L y`` at the points y (m, r), into ``result`` (m, n, r)."""
    for s in range(y.shape[0]):
        found, least = search(grid, counts, y[s], work)
        weigh(work, found, least, rule.kernel)
        slope(parameters, work, found, grid.axes, rule, result[s])
