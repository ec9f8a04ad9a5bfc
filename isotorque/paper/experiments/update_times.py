"""Section 7.1.1: processor time of an iteration of the local linear maps."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.scheme import LearnerFactory
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.experiments.online import iterated, literal, literal_iterated
from isotorque.paper.published import SAMPLES_PER_ITERATION
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]
ITERATIONS, GROWN = 15, 3000


def measure_update_times(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Time updates of a grown model along a random walk, all symmetric copies included.

    The three learners take turns, so that what else the machine does touches all alike; each
    number is the median over iterations.
    """
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    count = effort.of(ITERATIONS, 4)
    grown = effort.of(GROWN, 200)
    rng = np.random.default_rng(seed)
    q = np.cumsum(rng.normal(0.0, 0.1, (grown + count * SAMPLES_PER_ITERATION, robot.n)), axis=0)
    torque = gravity.torque(q)
    makers: dict[str, LearnerFactory] = {
        "plain": literal,
        "printed": literal_iterated,
        "iterated": iterated,
    }
    learners: dict[str, LocalLinearMap] = {}
    for name, make in makers.items():
        learners[name] = make(group, np.abs(torque).max(axis=0))  # type: ignore[assignment]
        learners[name].partial_fit(q[:grown], torque[:grown])
    seconds: dict[str, list[float]] = {name: [] for name in learners}
    for i in range(count):
        part = slice(grown + i * SAMPLES_PER_ITERATION, grown + (i + 1) * SAMPLES_PER_ITERATION)
        for name, learner in learners.items():
            seconds[name].append(_seconds(learner, q[part], torque[part]))
    numbers = {f"{name}_seconds": float(np.median(taken)) for name, taken in seconds.items()}
    numbers["ratio"] = numbers["iterated_seconds"] / numbers["plain_seconds"]
    numbers["printed_ratio"] = numbers["printed_seconds"] / numbers["plain_seconds"]
    return Measured(numbers)


def _seconds(learner: LocalLinearMap, q: Array, torque: Array) -> float:
    start = time.process_time()
    learner.partial_fit(q, torque)
    return time.process_time() - start
