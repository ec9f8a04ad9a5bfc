"""Costs against the number of samples and of queries, on the 2R arm with its group."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np

from benchmarks.growth.curves import Curve, Work
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

ROBOT = "2r"
PANELS = ("learning all samples", "answering all queries")
SAMPLES = (100, 300, 1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
OF_PROCESS = (100, 180, 320, 560, 1000)
BLOCK = 100
"""Samples that the online learners get at a time."""
LEARNED = {"LocalLinearMap": 10_000}
"""Samples learned before queries are answered; 100 by default."""
FEW_STEPS: dict[str, Any] = {
    "restarts": 1,
    "trial_iterations": 10,
    "iterations": 20,
    "tolerance": 1e-300,
}
"""The network always takes 30 steps: how many are needed depends on the samples' luck."""
MOST_LEARNED = {
    "SymmetricGaussianProcess": 1000,
    "FeedForwardNetwork": 10_000,
    "RecursiveLeastSquares": 30_000,
    "learn_relations": 30_000,
}
MOST_ANSWERED = {"SymmetricGaussianProcess": 100_000, "RecursiveLeastSquares": 100_000}
"""Points beyond would take minutes."""


def curves(most: int = SAMPLES[-1]) -> list[Curve]:
    """All curves, up to so many samples."""
    learning, answering = PANELS
    fits: dict[str, Callable[[int], Work]] = {name: partial(_fit, name) for name in _LEARNERS}
    fits["learn_relations"] = _relations
    found = [
        Curve(name, _steps(name, min(most, MOST_LEARNED.get(name, most))), prepare, learning)
        for name, prepare in fits.items()
    ]
    for name in _LEARNERS:
        counts = tuple(x for x in SAMPLES if x <= min(most, MOST_ANSWERED.get(name, most)))
        found.append(Curve(name, counts, partial(_predict, name), answering))
    return found


def _steps(name: str, most: int) -> tuple[int, ...]:
    counts = OF_PROCESS if name == "SymmetricGaussianProcess" else SAMPLES
    return tuple(x for x in counts if x <= most)


@cache
def _arm() -> tuple[GravityModel, SymmetryGroup]:
    gravity = GravityModel(load_robot(ROBOT))
    return gravity, primary_symmetries(gravity.potential)


@cache
def _samples(count: int) -> tuple[np.ndarray, np.ndarray]:
    gravity, _ = _arm()
    q = np.random.default_rng(count).uniform(-np.pi, np.pi, (count, gravity.n))
    return q, gravity.torque(q)


_LEARNERS: dict[str, Callable[[SymmetryGroup], Any]] = {
    "EquivariantTrigonometric": lambda group: EquivariantTrigonometric(group=group),
    "StaticRegressor": lambda _: StaticRegressor(ROBOT),
    "SymmetricGaussianProcess": lambda group: SymmetricGaussianProcess(group=group),
    "FeedForwardNetwork": lambda group: FeedForwardNetwork(group=group, **FEW_STEPS),
    "LocalLinearMap": lambda group: LocalLinearMap(group=group),
    "RecursiveLeastSquares": lambda group: RecursiveLeastSquares(group=group),
}


def _learn(name: str, q: np.ndarray, torque: np.ndarray) -> Any:
    """A learner that has learned, online ones block by block."""
    learner = _LEARNERS[name](_arm()[1])
    if not hasattr(learner, "partial_fit"):
        return learner.fit(q, torque)
    for start in range(0, len(q), BLOCK):
        block = slice(start, start + BLOCK)
        learner.partial_fit(q[block], torque[block])
    return learner


def _fit(name: str, count: int) -> Work:
    return Work(partial(_learn, name, *_samples(count)))


def _predict(name: str, count: int) -> Work:
    learner = _learn(name, *_samples(LEARNED.get(name, 100)))
    q, _ = _samples(count)
    return Work(lambda: learner.predict(q))


def _relations(count: int) -> Work:
    """From configurations with all their symmetric partners."""
    gravity, group = _arm()
    seeds, _ = _samples(-(-count // group.order))
    q = wrap(group.orbit(seeds).transpose(1, 0, 2).reshape(-1, gravity.n)[:count])
    torque = gravity.torque(q)
    return Work(lambda: learn_relations(q, torque))
