"""One row of the benchmark of relation learning: many recordings, learned from and judged."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.relations.samples import Samples, Truth, level_set_samples, stable_samples, truth
from isotorque.learning.relations.identification.identify import identify
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.learning.relations.pairing.pair_relations import pair_relations
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

METHODS: dict[str, Callable[..., LearnedSymmetries]] = {
    "both methods": learn_relations,
    "identification": identify,
    "pairing": pair_relations,
}
SAME_MAP = 0.05
"""Relations with the same A and Y whose offsets differ by less [rad] are one relation."""
OFFSET_EXACT, OFFSET_NOISY = 1e-9, float(np.deg2rad(0.2))
"""Errors of d that a right answer may have [rad], with exact and with noisy angles."""
PROBES = 200
SECONDS = {"2r": 1.0, "3r": 5.0, "4r-planar": 60.0}
"""What learning may take [s]."""


@dataclass(frozen=True)
class Case:
    """Experiment that a row measures.

    Attributes
    ----------
    method, robot : str
    count : int
        Torques of level sets; for identification, stable samples.
    degrees : float
        Noise of the angles [deg].
    demanded : str
        In words; empty for rows that are there to compare with.
    least_right, least_precision : float
        Demanded shares of seeds with the whole group, and of true relations among the learned.
    share_of_seeds : float
        Slow rows take fewer seeds.
    snap : bool
        Whether offsets are rounded to right angles where the data agree.
    """

    method: str
    robot: str
    count: int
    degrees: float
    demanded: str = ""
    least_right: float = 1.0
    least_precision: float = 1.0
    share_of_seeds: float = 1.0
    snap: bool = True

    def samples(self, seed: int) -> Samples:
        """Samples of a seed, angles with noise."""
        source = stable_samples if self.method == "identification" else level_set_samples
        q, tau = source(self.robot, self.count, seed)
        noise = np.random.default_rng([seed, 1]).normal(size=q.shape)
        return q + np.deg2rad(self.degrees) * noise, tau


@dataclass(frozen=True)
class Row:
    """Result of a case.

    Attributes
    ----------
    case : Case
    seeds, right : int
        Recordings, and how many gave the whole group, nothing else, and offsets near enough.
    claimed, false : int
        Relations claimed over all of them, and how many the arm does not have.
    false_torque_error : float
        Largest torque error of a false one [N m].
    worst_offset : float
        Largest error of d among the true ones [rad].
    observed : float
        Mean number of relations seen in pairs.
    seconds, most_seconds : float
        Computing time of the learning, median and largest [s].
    """

    case: Case
    seeds: int
    right: int
    claimed: int
    false: int
    false_torque_error: float
    worst_offset: float
    observed: float
    seconds: float
    most_seconds: float

    @property
    def precision(self) -> float:
        """Share of true relations among those claimed."""
        return 1.0 - self.false / self.claimed

    @property
    def holds(self) -> bool | None:
        """Whether what is demanded was reached; None where nothing is."""
        if not self.case.demanded:
            return None
        return (
            self.right >= self.case.least_right * self.seeds
            and self.precision >= self.case.least_precision
            and self.most_seconds <= SECONDS.get(self.case.robot, np.inf)
        )


def run(case: Case, seeds: int) -> Row:
    """Learn from `seeds` recordings and hold the results against the truth."""
    arm, learn = truth(case.robot), METHODS[case.method]
    learn(*case.samples(0), snap=case.snap)  # compile
    allowed = OFFSET_NOISY if case.degrees else OFFSET_EXACT
    right = claimed = false = observed = 0
    torque_error = offset_error = 0.0
    seconds = []
    for seed in range(seeds):
        q, tau = case.samples(seed)
        start = time.process_time()  # other programs on the machine do not count
        learned = learn(q, tau, snap=case.snap)
        seconds.append(time.process_time() - start)
        errors = [_offset_error(relation, arm.group) for relation in learned.group]
        wrong = [r for r, e in zip(learned.group, errors, strict=True) if e > SAME_MAP]
        true = [e for e in errors if e <= SAME_MAP]
        right += not wrong and len(true) == arm.group.order and max(true) <= allowed
        claimed += len(errors)
        false += len(wrong)
        observed += sum(str(r.known) == "observed" for r in learned.relations)
        offset_error = max(offset_error, *true)
        torque_error = max([torque_error, *(_torque_error(r, arm, seed) for r in wrong)])
    return Row(
        case=case,
        seeds=seeds,
        right=int(right),
        claimed=claimed,
        false=false,
        false_torque_error=torque_error,
        worst_offset=offset_error,
        observed=observed / seeds,
        seconds=float(np.median(seconds)),
        most_seconds=max(seconds),
    )


def _offset_error(relation: SymmetryRelation, group: SymmetryGroup) -> float:
    """Distance of the offset from that of the true relation with the same A and Y [rad]."""
    if not np.array_equal(relation.basis, group.basis):
        return 0.0 if relation.is_identity else np.inf
    match = (group.Y == relation.Y).all(axis=1)
    match &= (np.abs(group.A_sat - relation.A_sat) < 1e-6).all(axis=(1, 2))
    off = np.abs(wrap(group.d_sat[match] - relation.d_sat)).max(axis=1, initial=0.0)
    return float(off.min(initial=np.inf))


def _torque_error(relation: SymmetryRelation, arm: Truth, seed: int) -> float:
    """Largest |g(A q + d) - Y g(q)| over random configurations [N m]."""
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (PROBES, relation.n))
    image = arm.potential.gradient(relation.configuration(q))
    return float(np.abs(image - relation.torque(arm.potential.gradient(q))).max())
