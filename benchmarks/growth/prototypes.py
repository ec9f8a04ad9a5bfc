"""Costs against the number of prototypes of the online learners, on the 2R arm, no symmetries."""

from __future__ import annotations

from functools import cache

import numpy as np

from benchmarks.growth.curves import Curve, Work
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

PANELS = ("LocalLinearMap", "RecursiveLeastSquares")
MAP = (10, 18, 32, 56, 100, 178, 316)
LEAST_SQUARES = (3, 5, 8, 13, 20, 28)
"""Prototypes per turn of a joint: their number is the square."""
JITTER, RADIUS = 0.1, 0.79
"""Of prototypes from places of a square lattice, and the learner's, in steps of the lattice: all
are farther apart than the radius."""
MEMORY = 20
"""Samples that recursive least squares keep where updates are timed: few, for to choose them costs
more than the update of few prototypes."""
SAMPLES = 1000


def curves(
    of_map: tuple[int, ...] = MAP, least_squares: tuple[int, ...] = LEAST_SQUARES
) -> list[Curve]:
    """All curves; arguments are prototypes per turn of a joint."""
    mapped, solved = (tuple(k * k for k in ks) for ks in (of_map, least_squares))
    return [
        Curve("update with one sample, anywhere", mapped, _map_update, PANELS[0]),
        Curve("update with one sample, along a path", mapped, _map_path, PANELS[0]),
        Curve("prediction of one query, anywhere", mapped, _map_prediction, PANELS[0]),
        Curve("one sample that becomes a prototype", mapped, _map_filling, PANELS[0]),
        Curve("update with one sample", solved, _squares_update, PANELS[1]),
        Curve("prediction of one query", solved, _squares_prediction, PANELS[1]),
        Curve("all solved anew", solved, _squares_anew, PANELS[1]),
    ]


@cache
def _gravity() -> GravityModel:
    return GravityModel(load_robot("2r"))


@cache
def spread(count: int) -> tuple[np.ndarray, float]:
    """Configurations spread over all joint angles in random order, and the step of the lattice."""
    side = round(count**0.5)
    rng = np.random.default_rng(count)
    step = 2.0 * np.pi / side
    places = np.stack(np.meshgrid(*[np.arange(side)] * 2), axis=-1).reshape(-1, 2)
    q = (places + rng.uniform(-JITTER, JITTER, places.shape)) * step - np.pi
    return q[rng.permutation(len(q))], step


def _queries() -> np.ndarray:
    return np.random.default_rng(1).uniform(-np.pi, np.pi, (SAMPLES, 2))


def _map(count: int) -> LocalLinearMap:
    q, step = spread(count)
    return LocalLinearMap(RADIUS * step).partial_fit(q, _gravity().torque(q))


def _least_squares(count: int, memory: int) -> RecursiveLeastSquares:
    q, step = spread(count)
    found = RecursiveLeastSquares(RADIUS * step, memory=memory).partial_fit(q, _gravity().torque(q))
    found.predict(q[:1])  # solves
    return found


@cache
def _filled(kind: str, count: int) -> LocalLinearMap | RecursiveLeastSquares:
    """A learner with so many prototypes.

    Raises
    ------
    RuntimeError
        If it has another number.
    """
    learner = _map(count) if kind == PANELS[0] else _least_squares(count, MEMORY)
    if learner.n_prototypes_ != count:
        raise RuntimeError(f"{learner.n_prototypes_} prototypes, not {count}")
    return learner


def _map_update(count: int) -> Work:
    """Samples that were learned before, so that none becomes a prototype."""
    learner, q = _filled(PANELS[0], count), spread(count)[0][:SAMPLES]
    torque = _gravity().torque(q)
    return Work(lambda: learner.partial_fit(q, torque), len(q))


def _map_path(count: int) -> Work:
    """Row by row of the lattice: what one sample touches, the next one finds in the cache."""
    learner, (places, step) = _filled(PANELS[0], count), spread(count)
    row, column = np.rint((places.T + np.pi) / step)
    q = places[np.lexsort((row, column))][:SAMPLES]
    torque = _gravity().torque(q)
    return Work(lambda: learner.partial_fit(q, torque), len(q))


def _map_prediction(count: int) -> Work:
    learner, q = _filled(PANELS[0], count), _queries()
    return Work(lambda: learner.predict(q), len(q))


def _map_filling(count: int) -> Work:
    return Work(lambda: _map(count), count)


def _squares_update(count: int) -> Work:
    learner, q = _filled(PANELS[1], count), spread(count)[0][:1]
    torque = _gravity().torque(q)
    for _ in range(MEMORY):  # until no more room is left: then updates cost the same
        learner.partial_fit(q, torque)
    return Work(lambda: learner.partial_fit(q, torque))


def _squares_prediction(count: int) -> Work:
    learner, q = _filled(PANELS[1], count), _queries()
    return Work(lambda: learner.predict(q), len(q))


def _squares_anew(count: int) -> Work:
    """What a new prototype leads to: features and factors of all samples kept, one for each."""
    return Work(lambda: _least_squares(count, count))
