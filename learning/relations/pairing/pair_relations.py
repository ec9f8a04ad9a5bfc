"""Symmetries found by pairing configurations that the same |torque| holds."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.identification.offset_snapping import snapped_offsets
from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
)
from isotorque.learning.relations.pairing.pair_evidence import PairEvidence
from isotorque.learning.relations.pairing.pair_search import PairSearch, search_pairs
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.groups.group_arrays import CandidateGroup, lifted_relations
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import identity

Array = NDArray[np.float64]


def pair_relations(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
    largest_entry: int = 2,
    snap: bool = True,
) -> LearnedSymmetries:
    """Find relations between configurations that the same |torque| holds.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m]; several configurations per |tau|, several |tau|.
    noise : MeasurementNoise, optional
        Noise levels where known. Otherwise torques are taken as commanded (exact), and the noise
        of the angles as the one under which the relations are the least likely to be chance.
    largest_entry : int
        Largest entry of A that is tried.
    snap : bool
        Round offsets to multiples of a right angle where all of them agree.

    Returns
    -------
    LearnedSymmetries
        Group of the observed relations and their products; every relation with its support, free
        regression, and how little chance explains it. ``missing`` says what is lacking where
        nothing was found.

    Raises
    ------
    InputError
        If the arrays do not fit together.

    Notes
    -----
    This is the paper's section 4.2 without knowing which configurations belong together: integer
    relations are voted for (`hough_transform`), judged against chance over distinct torques
    (`a_contrario_test`), only those that close to a group are kept, and all offsets are refined
    together (`orbit_refinement`). Relations that no pair shows cannot be found; identification
    finds them.

    Joints whose torque is always zero are left out. Samples with a torque component below 2 % of
    the joint's largest are not used: its sign means nothing.
    """
    configurations, torques = static_samples(q, tau)
    try:
        found = search_pairs(configurations, torques, noise, largest_entry)
    except Undetermined as lacking:
        return _nothing(configurations.shape[1], str(lacking))
    if len(found.refinement.group) == 1:
        return _nothing(configurations.shape[1], nothing_stands_out(found))
    return learned_from_pairs(found, snap)


def nothing_stands_out(found: PairSearch) -> str:
    """What is missing where pairs show no relation."""
    return (
        f"more torques or configurations: {sum(len(p) for p in found.kinds) // 2} pairs at "
        f"{found.groups.count} |torque| show no relation that chance does not explain"
    )


def _nothing(n: int, missing: str) -> LearnedSymmetries:
    unit = identity(n)
    relation = LearnedRelation(unit, Knowledge.IMPLIED, 0, np.zeros(n), 1.0)
    return LearnedSymmetries(SymmetryGroup([unit]), (relation,), missing, "pairing")


def learned_from_pairs(found: PairSearch, snap: bool) -> LearnedSymmetries:
    """State the group that pairs show, in the coordinates of all joints, with its evidence."""
    refinement = found.refinement
    rounded = snapped_offsets(refinement.group, refinement.offset_errors) if snap else None
    if rounded is not None:
        refinement = dataclasses.replace(refinement, group=rounded)
    evidence = PairEvidence(found.kinds, refinement, found.accepted, found.tolerance)
    group, active = refinement.group, found.active
    Y = np.ones((len(group), len(active)))
    Y[:, active] = group.Y
    basis = np.eye(len(active), dtype=np.int64)[active]
    relations = lifted_relations(CandidateGroup(basis, group.A, group.d, Y))
    learned = []
    for i, relation in enumerate(relations):
        support = evidence.support(i)
        learned.append(
            LearnedRelation(
                relation,
                Knowledge.OBSERVED if support >= found.least_torques else Knowledge.IMPLIED,
                support,
                refinement.offset_errors[i],
                evidence.p_value(i),
                evidence.log10_false_alarms(i),
                evidence.regression(i),
                rounded is not None,
            )
        )
    return LearnedSymmetries(
        SymmetryGroup(relations), tuple(learned), None, "pairing", None, evidence.rejected()
    )
