"""The poses that tell most about a chain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.pose_design import PoseDesign
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
POWER = 4
"""Variances to this power are added up in choosing from a list."""
EXCHANGES = 2
"""Rounds in which each chosen pose may be exchanged for a better one."""
STARTS, KEPT = 4, 1
"""Random sets of poses that are moved at first, and the best of them that are moved on."""
STAGES = ((1.0, 40), (4.0, 40), (16.0, 80))
"""Power of the variances and steps at most: the mean error first, nearly the largest last."""
EFFORT = 0.99
"""Share of an effort limit that poses are moved within."""


@dataclass(frozen=True, eq=False)
class PosePlan:
    """Poses to measure next, in this order.

    Attributes
    ----------
    poses : (k, n) array
        [rad].
    before : float
        Largest standard error of any torque in the region without them [N m].
    expected : (k,) array
        The same after each of them.
    """

    poses: Array
    before: float
    expected: Array


@single_thread()
def plan_poses(
    chain: ChainParameters,
    free: Mask,
    seen: ChainSamples,
    candidates: Array,
    region: Array,
    count: int,
    within: float = 0.0,
) -> PosePlan:
    """Choose from a list the poses that lower the largest standard error of the torque most.

    Parameters
    ----------
    chain : ChainParameters
        What is known: derivatives are taken there, and near it (`PoseDesign`).
    free : (P,) bool array
        Which of its parameters are unknown (`Information`).
    seen : ChainSamples
        Samples that there are already (maybe none), and the noise of those to come.
    candidates : (c, n) array
        Poses to choose from [rad].
    region : (m, n) array
        Poses at which the torque is to be known [rad].
    count : int
        Poses at most.
    within : float
        Enough: three standard errors of any torque in the region [N m].

    Notes
    -----
    One pose after the other is added, then each is exchanged for a better one while there is one.
    Each candidate's effect on the covariance is exact for the linearised chain.

    Raises
    ------
    InputError
        If there is nothing to choose from.

    Examples
    --------
    A pendulum measured where it hangs, told to look where it does not:

    >>> sideways = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]]
    >>> pendulum = ChainParameters.of(sideways, [[6.0, 0.0]])
    >>> q, one = np.array([[-1.5], [-1.6]]), np.ones(1)
    >>> seen = ChainSamples(q, pendulum.torque(q), 0.1 * one, 0.0 * one, np.ones(2))
    >>> choice = np.array([[-1.55], [0.0], [1.6]])
    >>> free = np.array([True] * 4 + [False])
    >>> plan_poses(pendulum, free, seen, choice, choice, 1).poses.tolist()
    [[0.0]]
    """
    if not len(candidates) or not len(region):
        raise InputError("plan", "poses to choose from", 0, "at least one")
    design = PoseDesign.of(chain, free, seen, region)
    offered = design.rows(candidates)

    def chosen(number: int) -> list[int]:
        picked: list[int] = []
        for _ in range(number):
            picked.append(_best(design, offered, picked))
        for _ in range(EXCHANGES):
            before = list(picked)
            for k in range(number):
                picked[k] = _best(design, offered, [*picked[:k], *picked[k + 1 :]])
            if picked == before:
                break
        return picked

    return _shortest(design, lambda number: candidates[chosen(number)], count, within)


@single_thread()
def plan_poses_within(
    chain: ChainParameters,
    free: Mask,
    seen: ChainSamples,
    low: Array,
    high: Array,
    region: Array,
    count: int,
    within: float = 0.0,
    *,
    effort: Array | None = None,
    random_state: int = 0,
) -> PosePlan:
    """Find the poses in a box that lower the largest standard error of the torque most.

    Parameters
    ----------
    chain, free, seen, region, count, within
        As of `plan_poses`.
    low, high : (n,) arrays
        Ends of the box [rad].
    effort : (n,) array, optional
        Largest torque at each joint that a pose may need [N m].
    random_state : int
        Seed of the poses to start from.

    Notes
    -----
    All poses are moved at the same time (limited-memory quasi-Newton, bounded), from several
    random sets: first to the least mean variance, then to nearly the least largest one. On the
    panda eight of them leave an error that choosing one by one from hundreds of random poses
    leaves with ten.

    Raises
    ------
    InputError
        If effort limits leave no pose.

    Examples
    --------
    >>> sideways = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]]
    >>> pendulum = ChainParameters.of(sideways, [[6.0, 0.0]])
    >>> nothing, one = np.zeros((0, 1)), np.ones(1)
    >>> seen = ChainSamples(nothing, nothing, 0.1 * one, 0.0 * one, np.zeros(0))
    >>> region = np.linspace(-3, 3, 20)[:, None]
    >>> free = np.array([True] * 4 + [False])
    >>> plan = plan_poses_within(pendulum, free, seen, -3 * one, 3 * one, region, 2)
    >>> bool(np.abs(np.sin(np.ptp(plan.poses))) > 0.9)  # a quarter of a turn apart, or three
    True
    """
    rng = np.random.default_rng(random_state)
    design = PoseDesign.of(chain, free, seen, region)
    most = np.full(chain.n, np.inf) if effort is None else np.asarray(effort, dtype=float)

    def allowed(poses: Array) -> Mask:
        return np.asarray(np.all(np.abs(chain.torque(poses)) <= most, axis=1))

    spare = _spare_poses(rng, low, high, allowed)

    def moved(number: int) -> Array:
        sets = [spare[rng.integers(len(spare), size=number)] for _ in range(STARTS)]
        for power, steps in STAGES:
            found = [_moved(design, chain, poses, low, high, most, power, steps) for poses in sets]
            found.sort(key=lambda pair: pair[0])
            sets = [poses for _, poses in found[:KEPT]]
        best = sets[0]
        outside = np.flatnonzero(~allowed(best))
        if len(outside):
            offered = design.rows(np.concatenate([best, spare]))
            inside = list(range(number, number + len(spare)))
            picked = [k for k in range(number) if k not in outside]
            for _ in outside:
                picked.append(_best(design, offered, picked, inside))
            best = np.concatenate([best, spare])[picked]
        return best

    return _shortest(design, moved, count, within)


def _spare_poses(
    rng: np.random.Generator, low: Array, high: Array, allowed: Callable[[Array], Mask]
) -> Array:
    """Random poses of the box that may be used."""
    poses = rng.uniform(low, high, (2000, len(low)))
    poses = poses[allowed(poses)][:200]
    if not len(poses):
        raise InputError("plan", "poses within effort limits", 0, "at least one")
    return poses


def _moved(
    design: PoseDesign,
    chain: ChainParameters,
    poses: Array,
    low: Array,
    high: Array,
    most: Array,
    power: float,
    steps: int,
) -> tuple[float, Array]:
    """Poses moved to lower the criterion; torques beyond the limits cost."""
    shape = poses.shape
    bounded = np.isfinite(most)

    def cost(x: Array) -> tuple[float, Array]:
        q = x.reshape(shape)
        value, slope = design.value_and_slope(q, power)
        if bounded.any():
            torque = chain.torque(q)[:, bounded]
            beyond = np.maximum(np.abs(torque) / (EFFORT * most[bounded]) - 1.0, 0.0)
            value += 1e3 * float(np.sum(beyond**2))
            pull = 2e3 * beyond * np.sign(torque) / (EFFORT * most[bounded])
            slope = slope + np.einsum("kj,kji->ki", pull, chain.stiffness(q)[:, bounded])
        return value, slope.ravel()

    ends = np.stack([np.tile(low, shape[0]), np.tile(high, shape[0])], axis=1)
    options = {"maxiter": steps}
    found = minimize(cost, poses.ravel(), jac=True, method="L-BFGS-B", bounds=ends, options=options)
    return float(found.fun), np.clip(np.reshape(found.x, shape), low, high)


def _best(
    design: PoseDesign,
    offered: tuple[Array, ...],
    chosen: list[int],
    among: list[int] | None = None,
) -> int:
    """The offered sample that lowers the criterion most beside those that are chosen."""
    covariances = design.covariances([rows[chosen] for rows in offered])
    if among is None:
        return int(np.argmin(design.after_each(covariances, offered, POWER)))
    left = [rows[among] for rows in offered]
    return among[int(np.argmin(design.after_each(covariances, left, POWER)))]


def _shortest(
    design: PoseDesign, poses_of: Callable[[int], Array], count: int, within: float
) -> PosePlan:
    """The plan of the fewest poses that suffice, ``count`` at most, the most telling ones first."""
    n = design.chains[0].n
    before = design.largest_error(design.covariances(design.rows(np.zeros((0, n)))))
    if 3.0 * before <= within:
        return PosePlan(np.zeros((0, n)), before, np.zeros(0))
    plan = _in_order(design, poses_of(count), before)
    low, high = 0, count  # the first is known not to suffice
    while within > 0.0 and 3.0 * plan.expected[-1] <= within and high - low > 1:
        middle = (low + high) // 2
        fewer = _in_order(design, poses_of(middle), before)
        if 3.0 * fewer.expected[-1] <= within:
            plan, high = fewer, middle
        else:
            low = middle
    return plan


def _in_order(design: PoseDesign, poses: Array, before: float) -> PosePlan:
    """The same poses, the most telling one first, and so on."""
    offered = design.rows(poses)
    order: list[int] = []
    expected = []
    while len(order) < len(poses):
        left = [k for k in range(len(poses)) if k not in order]
        order.append(_best(design, offered, order, left))
        chosen = design.covariances([rows[order] for rows in offered])
        expected.append(design.largest_error(chosen))
    return PosePlan(poses[order], before, np.array(expected))
