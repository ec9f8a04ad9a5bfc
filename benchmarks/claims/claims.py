"""Relations claimed from a data set, held against the arm as measured."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.claims.data_sets import DataSet, true_arm
from isotorque.learning.learners.rigid.planning.information import Information, parameter_mask
from isotorque.learning.relations.identification.identify import in_basis
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]

PROBES, FLOOR = 600, 1e-9
"""Random configurations; share of the largest torque that is rounding."""
DEVIATIONS = 6.0
"""A group may be larger than the exact one if it errs by so many standard errors at most."""
STEP = 0.02
"""Logarithm to base 10 to which tolerances of groups are rounded down: few are derived."""


@dataclass(frozen=True)
class Claims:
    """What was claimed, and how it stands.

    Attributes
    ----------
    order : int
        Of the group, relations counted once that differ in what the arm does not feel: turns and
        signs of joints that carry nothing.
    relations, wrong, unbounded : int
        Relations but the identity; those whose error exceeds their bound; those without bound.
    worst : float
        Largest ratio of error and bound.
    exact, most : int
        Orders of the arm's exact group, and of its largest one within the errors.
    seconds : float
        Processor time.
    """

    order: int
    relations: int
    wrong: int
    unbounded: int
    worst: float
    exact: int
    most: int
    seconds: float


def judged_claims(robot: str, data: DataSet) -> Claims:
    """Learn relations and hold every one against what the arm measures."""
    recorded = data.recorded
    stated = None if data.stated is None else MeasurementNoise(0.0, data.stated)
    start = time.process_time()
    learned = learn_relations(recorded.q, recorded.tau, noise=stated)
    seconds = time.process_time() - start
    relations = [r.relation for r in learned.relations if not r.relation.is_identity]
    relations += learned.corrected
    n = recorded.q.shape[1]
    q = np.random.default_rng([len(recorded.q), n]).uniform(-np.pi, np.pi, (PROBES, n))
    ratios = [excess(relation, data, q) for relation in relations if _bounded(relation)]
    order = learned.order // sum(map(_unfelt_by(robot), learned.group))
    exact = most = _exact_group(robot).order
    if data.contamination.kind is None and order > exact:
        largest = float(least_standard_error(data, q).max())
        most = _order_within(robot, int(np.floor(np.log10(DEVIATIONS * largest) / STEP)))
    return Claims(
        order,
        len(relations),
        sum(ratio > 1.0 for ratio in ratios),
        len(relations) - len(ratios),
        max(ratios, default=0.0),
        exact,
        most,
        seconds,
    )


def excess(relation: SymmetryRelation, data: DataSet, q: Array) -> float:
    """Largest error of a relation of the measured torque, in units of its bound.

    Angles are wrapped unless its correction has springs, to which turns make a difference.
    """
    image = relation.configuration(q)
    if relation.correction is None or not relation.correction.rate.any():
        image = wrap(image)
    allowed = relation.bound + FLOOR * data.contamination.arm.peak.max()
    errors = [
        np.abs(torque(image) - relation.torque(torque(q), q)).max(axis=0)
        for torque in data.recorded.truth
    ]
    return float((np.max(errors, axis=0) / allowed).max())


def least_standard_error(data: DataSet, q: Array) -> Array:
    """Least standard errors (m, n) of torques at q that a chain tells [N m]."""
    poses, chain = data.contamination.q, data.contamination.arm.chain
    whitening = np.tile(np.diag(1.0 / data.noise), (len(poses), 1, 1))
    information = Information.of(chain, poses, whitening, parameter_mask(chain.n))
    return information.standard_error(chain, q)


def _bounded(relation: SymmetryRelation) -> bool:
    return bool(np.all(np.isfinite(relation.bound)))


def _unfelt_by(robot: str) -> Callable[[SymmetryRelation], bool]:
    """Whether a relation changes nothing that a built-in arm feels."""
    basis, peak = _exact_group(robot).basis, true_arm(robot).peak
    loaded = peak > FLOOR * peak.max()

    def unfelt(relation: SymmetryRelation) -> bool:
        felt = in_basis(relation, basis)
        if felt is None:
            return False
        signs = np.where(loaded, felt.Y, 1.0)
        return SymmetryRelation(felt.A, felt.d, signs, basis).is_identity

    return unfelt


@cache
def _exact_group(robot: str) -> SymmetryGroup:
    return primary_symmetries(true_arm(robot).gravity.potential)


@cache
def _order_within(robot: str, steps: int) -> int:
    """Order of an arm's largest group within a tolerance, in steps of its logarithm."""
    potential = true_arm(robot).gravity.potential
    return max(group.order for group in maximal_groups(potential, float(10.0 ** (STEP * steps))))
