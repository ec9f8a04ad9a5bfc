"""Costs against the order of the group: subgroups of that of the planar arm with four joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from benchmarks.growth.curves import Curve, Work
from benchmarks.growth.samples import FEW_STEPS
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup, close
from isotorque.symbolic.groups.symmetry_relation import identity
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

ROBOT = "4r-planar"
ORDERS = (1, 2, 4, 8, 16, 32)
FILLING, UPDATES = 3000, 200
"""Samples that fill a map with prototypes, and that are timed."""
PROTOTYPES = 60
"""Of recursive least squares, whatever the order."""
OF_PROCESS, OF_NETWORK, OF_REGRESSION = 200, 300, 1000
"""Samples that are fitted."""


def curves(orders: Sequence[int] = ORDERS) -> list[Curve]:
    """All curves."""
    whats: dict[str, Callable[[int], Work]] = {
        "LocalLinearMap, update": _map_update,
        "RecursiveLeastSquares, update": _squares_update,
        f"SymmetricGaussianProcess, fit of {OF_PROCESS}": _process_fit,
        "SymmetricGaussianProcess, answer": _process_answer,
        f"FeedForwardNetwork, fit of {OF_NETWORK}": _network_fit,
        f"EquivariantTrigonometric, fit of {OF_REGRESSION}": _regression_fit,
    }
    return [Curve(what, tuple(orders), prepare) for what, prepare in whats.items()]


def subgroup(group: SymmetryGroup, order: int) -> SymmetryGroup:
    """A subgroup; that of a smaller order is contained in that of a larger one.

    From the identity on, the relation is added that makes the smallest group.

    Raises
    ------
    InputError
        If no subgroup of that order is met on this way.
    """
    found = SymmetryGroup([identity(group.n, group.basis)])
    while found.order < order <= group.order:
        more = (relation for relation in group if relation not in found)
        found = min((close([*found, relation]) for relation in more), key=len)
    if found.order != order:
        raise InputError("symmetry group", "order of a subgroup", order, "one of a chain")
    return found


@cache
def _group(order: int) -> SymmetryGroup:
    return subgroup(primary_symmetries(_gravity().potential), order)


@cache
def _gravity() -> GravityModel:
    return GravityModel(load_robot(ROBOT))


@cache
def _samples(count: int) -> tuple[np.ndarray, np.ndarray]:
    gravity = _gravity()
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (count, gravity.n))
    return q, gravity.torque(q)


def _map_update(order: int) -> Work:
    """All copies are learned; prototypes fill all joint angles, whatever the order."""
    q, torque = _samples(FILLING)
    learner = LocalLinearMap(0.8, cutoff=2.0, group=_group(order)).partial_fit(q, torque)
    q, torque = q[:UPDATES], torque[:UPDATES]
    return Work(lambda: learner.partial_fit(q, torque), UPDATES)


def _squares_update(order: int) -> Work:
    """The kernel is as wide as by default, the radius so small that all samples are prototypes.

    Raises
    ------
    RuntimeError
        If one of them is not.
    """
    q, torque = _samples(PROTOTYPES)
    learner = RecursiveLeastSquares(
        0.1, kernel_width=14.0, memory=PROTOTYPES, group=_group(order)
    ).partial_fit(q, torque)
    learner.predict(q)  # solves
    if learner.n_prototypes_ != PROTOTYPES:
        raise RuntimeError(f"{learner.n_prototypes_} prototypes, not {PROTOTYPES}")
    return Work(lambda: learner.partial_fit(q[:1], torque[:1]))


def _process_fit(order: int) -> Work:
    """Hyperparameters but for the amplitude are given: to search them takes as long as it may."""
    q, torque = _samples(OF_PROCESS)
    return Work(
        lambda: SymmetricGaussianProcess(0.1, length_scale=1.0, group=_group(order)).fit(q, torque)
    )


def _process_answer(order: int) -> Work:
    q, torque = _samples(OF_PROCESS)
    learner = SymmetricGaussianProcess(0.1, length_scale=1.0, group=_group(order)).fit(q, torque)
    return Work(lambda: learner.predict(q), OF_PROCESS)


def _network_fit(order: int) -> Work:
    q, torque = _samples(OF_NETWORK)
    return Work(lambda: FeedForwardNetwork(group=_group(order), **FEW_STEPS).fit(q, torque))


def _regression_fit(order: int) -> Work:
    q, torque = _samples(OF_REGRESSION)
    return Work(lambda: EquivariantTrigonometric(group=_group(order)).fit(q, torque))
