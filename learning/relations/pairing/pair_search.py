"""Search for relations among pairs of configurations that the same |torque| holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.examined_fit import LARGEST_ERROR
from isotorque.learning.relations.pairing.a_contrario_test import (
    AcceptedRelation,
    accepted_relations,
)
from isotorque.learning.relations.pairing.hough_transform import Tolerance, voted_relations
from isotorque.learning.relations.pairing.orbit_refinement import (
    Refinement,
    find_orbits,
    refine_offsets,
)
from isotorque.learning.relations.pairing.pair_evidence import supports
from isotorque.learning.relations.pairing.torque_pairs import (
    Pairs,
    TorqueGroups,
    group_by_torque,
    pairs_by_signs,
)
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.inactive_joints import (
    active_joints,
    fit_on_active_joints,
    stood_still,
)
from isotorque.learning.relations.potential.samples_needed import samples_with_torque_needed
from isotorque.learning.statistics.poses import by_pose
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import SAME_ESTIMATED_OFFSET, CandidateGroup, completed

Array = NDArray[np.float64]

LEAST_TORQUES = 3
"""Torques that a recording must have, and pairs must come from to show a relation."""
LEAST_TORQUES_EXACT = 2
"""The same for a single relation where angles are so exact that nothing agrees by chance."""
SMALLEST_SHARE = 0.02
SAME_TORQUE = 1e-6
SIGMAS = (1e-8, 1e-6, 3e-5, 5e-4, 2e-3, 4e-3, 6e-3, 9e-3, 1.35e-2)
"""Noise levels of an angle that are tried where none is given [rad]; the large ones close to each
other, for there a level a third too small loses the pairs and one a third too large finds chance
in them, once every torque has dozens of configurations."""
PRODUCTS_SEEN = 0.4
"""Mean support of all relations of a group, relative to that of the last one added."""
MISSED_DEVIATIONS, MISSED_ROUNDING = 25.0, 1e-5
"""Products of relations may miss their offset by so many standard deviations of an angle, but
rounding alone [rad] makes up for the smallest."""
UNMISTAKABLE = 1e-5
"""Below this noise [rad] pairs do not obey a relation by chance: no larger noise is tried."""
ROUNDING = 1e-9
"""Angles are never taken to be better known than this [rad]."""


@dataclass(frozen=True, eq=False)
class PairSearch:
    """Findings of pairing in a recording.

    Attributes
    ----------
    active : (n,) array of bool
        Joints that need torque; everything below is in their coordinates.
    groups : TorqueGroups
    kinds : list of Pairs
        All pairs, one entry per Y.
    accepted : list of AcceptedRelation
        Relations found on their own, the least likely by chance first.
    refinement : Refinement
        Their group; only the identity where nothing was found.
    tolerance : Tolerance
        The noise the search allowed for.
    """

    active: NDArray[np.bool_]
    groups: TorqueGroups
    kinds: list[Pairs]
    accepted: list[AcceptedRelation]
    refinement: Refinement
    tolerance: Tolerance

    @property
    def least_torques(self) -> int:
        """Distinct torques whose pairs must show a relation for it to count as observed."""
        return least_torques(self.tolerance)

    @property
    def saving(self) -> float:
        """Nats saved by describing the angles of an orbit by its base configuration and noise."""
        sigma = max(self.refinement.sigma, ROUNDING)
        return float(self.refinement.freedom * np.log(np.sqrt(2.0 * np.pi / np.e) / sigma))


def least_torques(tolerance: Tolerance) -> int:
    """Distinct torques whose pairs must show a relation."""
    return LEAST_TORQUES_EXACT if tolerance.sigma <= UNMISTAKABLE else LEAST_TORQUES


def search_pairs(
    q: Array, tau: Array, noise: MeasurementNoise | None, largest_entry: int
) -> PairSearch:
    """Find the group of relations that pairs obey.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Rows [rad], [N m]; those of one pose count as one sample.
    noise : MeasurementNoise, optional
        If not given, torques are taken as exact, and the angles' noise as the level of `SIGMAS`
        whose relations save most in the description of the recording, then as measured on the
        pairs themselves.
    largest_entry : int
        Largest entry of A that is tried.

    Raises
    ------
    Undetermined
        If the recording lacks torques or configurations, or leaves open whether a joint matters.
    """
    _, q, tau = by_pose(q, tau)  # a pose that was recorded twice is no second configuration
    active = active_joints(tau, noise)
    if not active.any():
        raise Undetermined(samples_with_torque_needed(*tau.shape))
    same = SAME_TORQUE * float(np.abs(tau).max())
    same = max(same, 6.0 * noise.torque if noise else 0.0)
    groups = group_by_torque(q[:, active], tau[:, active], same, SMALLEST_SHARE)
    _require_enough(groups)
    if any(not stood_still(q, joint, noise) for joint in np.flatnonzero(~active).tolist()):
        fit, _ = fit_on_active_joints(q, tau, noise, LARGEST_ERROR)
        if fit.frequencies[:, ~active].any():
            raise Undetermined(
                "torques other than zero on all joints: one whose torque was always zero matters"
            )
    kinds = pairs_by_signs(groups)

    def at_noise(sigma: float) -> PairSearch:
        tolerance = Tolerance(max(sigma, ROUNDING))
        accepted = _accepted(kinds, groups, tolerance, largest_entry)
        while True:
            group = _consistent_group(accepted, kinds, tolerance, groups.q.shape[1])
            orbits = find_orbits(groups, group, tolerance)
            refinement = refine_offsets(groups, group, orbits, ROUNDING)
            lost = _lost(accepted, kinds, refinement.group, tolerance)
            if not lost:
                return PairSearch(active, groups, kinds, accepted, refinement, tolerance)
            accepted = [relation for relation in accepted if relation not in lost]

    if noise is not None:
        return at_noise(noise.angle)
    best = at_noise(SIGMAS[0])
    for sigma in SIGMAS[1:]:
        if best.saving > 0.0 and best.tolerance.sigma <= UNMISTAKABLE:
            break
        found = at_noise(sigma)
        best = found if found.saving > best.saving else best
    if best.saving > 0.0:
        measured = at_noise(best.refinement.sigma)
        best = measured if measured.saving > 0.0 else best
    return best


def _accepted(
    kinds: list[Pairs], groups: TorqueGroups, tolerance: Tolerance, largest_entry: int
) -> list[AcceptedRelation]:
    hypotheses = (2 * largest_entry + 1) ** groups.q.shape[1] - 1
    least = least_torques(tolerance)
    accepted: list[AcceptedRelation] = []
    for pairs in kinds:
        voted = voted_relations(pairs, groups.count, tolerance, least, largest_entry)
        accepted += accepted_relations(pairs, voted, groups.count, tolerance, least, hypotheses)
    accepted.sort(key=lambda relation: relation.log10_false_alarms)
    return accepted


def _consistent_group(
    found: list[AcceptedRelation], kinds: list[Pairs], tolerance: Tolerance, joints: int
) -> CandidateGroup:
    """Group of the best relations.

    A relation is dropped if it does not close with the better ones, or if its products with them
    are not seen: all relations of a group move configurations that can be held to such that can,
    so the products of observed relations are observed about as often.
    """
    unit = np.eye(joints)
    group = CandidateGroup(
        unit.astype(np.int64), unit[None], np.zeros((1, joints)), np.ones((1, joints))
    )
    for relation in found:
        if _place(relation, group):
            continue  # known as a product, or contradicting one in Y
        larger = completed(
            CandidateGroup(
                group.basis,
                np.concatenate([group.A, relation.A[None].astype(float)]),
                np.concatenate([group.d, relation.d[None]]),
                np.concatenate([group.Y, relation.Y[None]]),
            ),
            min(SAME_ESTIMATED_OFFSET, max(MISSED_ROUNDING, MISSED_DEVIATIONS * tolerance.sigma)),
        )
        if larger is None:
            continue
        support = supports(kinds, larger, tolerance)
        if support[1:].mean() >= PRODUCTS_SEEN * relation.torques:
            group = larger
    return group


def _lost(
    accepted: list[AcceptedRelation],
    kinds: list[Pairs],
    group: CandidateGroup,
    tolerance: Tolerance,
) -> list[AcceptedRelation]:
    """Relations whose own pairs disagree with the offset they got in the group."""
    support, least = supports(kinds, group, tolerance), least_torques(tolerance)
    return [r for r in accepted if any(support[i] < least for i in _place(r, group))]


def _place(relation: AcceptedRelation, group: CandidateGroup) -> list[int]:
    """Where a relation stands in a group (nowhere, or in one place)."""
    match = (group.A == relation.A).all(axis=(1, 2))
    match &= (np.abs(wrap(group.d - relation.d)) < SAME_ESTIMATED_OFFSET).all(axis=1)
    return np.flatnonzero(match).tolist()


def _require_enough(groups: TorqueGroups) -> None:
    """Say what is missing before pairing can begin."""
    useless = ""
    if groups.left_out:
        useless = f" ({groups.left_out} samples have a torque component too near to zero)"
    if groups.count < LEAST_TORQUES:
        raise Undetermined(
            f"{LEAST_TORQUES - groups.count} more torques: {groups.count} different |torque| "
            f"given, a relation must hold for at least {LEAST_TORQUES}{useless}"
        )
    sizes = np.bincount(groups.torque, minlength=groups.count)
    several = int((sizes >= 2).sum())
    if several < LEAST_TORQUES:
        raise Undetermined(
            f"more configurations: {several} |torque| have been seen at two or more, "
            f"{LEAST_TORQUES} are needed{useless}"
        )
