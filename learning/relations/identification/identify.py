"""Symmetries identified from static samples: by a rigid chain first, by waves for a second time."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.identification.chain_identification import identify_by_chain
from isotorque.learning.relations.identification.group_fit import fit_group
from isotorque.learning.relations.identification.wave_identification import (
    SIGNIFICANCE,
    identify_by_waves,
)
from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import SAME_ESTIMATED_OFFSET, CandidateGroup
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

BOTH = "rigid chain and identification"
SECOND_OPINION = 3
"""Up to so many joints waves are fitted beside a chain that was accepted: they are few."""


def identify(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
    snap: bool = True,
    parents: Sequence[int] | None = None,
) -> LearnedSymmetries:
    """Find the symmetry group of the torque map behind static samples.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known; estimated from the misfit otherwise.
    snap : bool
        Round offsets to multiples of a right angle where all of them agree; every relation says
        whether that was done. A rigid chain has symmetries because its angles are set: False
        leaves it out.
    parents : sequence of int, optional
        Joint that carries each joint, -1 for the base; in series by default. Waves need no such
        thing.

    Returns
    -------
    LearnedSymmetries
        ``missing`` says what the data lack; where it is not None only the identity is claimed,
        unless it speaks of joints that never moved, or of what the methods disagree on.

    Raises
    ------
    InputError
        If the arrays do not fit together.

    Notes
    -----
    A rigid chain is fitted first (`identify_by_chain`): a handful of samples determines it. Where
    it can be claimed and joints are more than three, that is all. With up to three, waves are
    fitted as well (`identify_by_waves`): the form that every arm of rigid links and revolute
    joints has, be it a chain or not, and constant torques. They have the last word where they
    see torques that are no gravity, and constants; relations of the chain that they contradict
    are not claimed. Where no chain is accepted, or waves find more, what they say stands.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> q = rng.uniform([-1.5, -1.5], [-0.1, 0.1], (6, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = identify(q, tau)
    >>> found.order, found.missing, found.method
    (8, None, 'rigid chain and identification')
    >>> identify(q[:4], tau[:4]).method
    'rigid chain'
    >>> print(identify(q[:3], tau[:3]).missing)
    1 more poses: 3 different ones were given, 4 are needed (rigid chain); 3 more samples: 3
    different ones were given, 6 determine 8 coefficients and 2 constants and check them (any arm)
    """
    configurations, torques = static_samples(q, tau)
    if not snap or not torques.any():
        return identify_by_waves(configurations, torques, noise=noise, snap=snap)
    waves = None
    if configurations.shape[1] <= SECOND_OPINION:
        waves = identify_by_waves(configurations, torques, noise=noise)
        if _more_than_gravity(waves):
            return waves
    explained = waves is not None and waves.fit is not None
    explained &= waves is not None and waves.lack is not None and not waves.lack.failed
    chain = identify_by_chain(
        configurations, torques, noise=noise, parents=parents, any_chain=not explained
    )
    if chain.decided:
        return chain if waves is None else _agreed(chain, waves)
    if chain.lack is not None and chain.lack.failed:
        return chain
    if waves is None:
        waves = identify_by_waves(configurations, torques, noise=noise)
    return _without_chain(chain, waves)


def _more_than_gravity(waves: LearnedSymmetries) -> bool:
    """Whether waves have the last word: they see constants, no gravity, or joints at rest."""
    lack = waves.lack
    if waves.fit is None or lack is None:
        return False
    failed = lack.failed and not lack.of_a_chain
    return bool(failed or len(lack.offset_joints) or waves.unmoved)


def _without_chain(chain: LearnedSymmetries, waves: LearnedSymmetries) -> LearnedSymmetries:
    """What waves say, and what stands in the way of a chain where they lack samples."""
    if waves.fit is not None:
        return waves
    missing = f"{chain.missing} (rigid chain); {waves.missing} (any arm)"
    return dataclasses.replace(waves, missing=missing, lack=chain.lack)


def _agreed(chain: LearnedSymmetries, waves: LearnedSymmetries) -> LearnedSymmetries:
    """The relations of a chain, if waves do not contradict them."""
    fit = waves.fit
    if fit is None or chain.lack is not None:
        return chain
    group = candidates_of(chain.group)
    whole = fit_group(fit, group)
    if whole.p_value < SIGNIFICANCE:
        return _common(chain, waves, whole.p_value)
    better = waves.order > chain.order or waves.group.rank < chain.group.rank
    if waves.decided and better:  # a chain that nearly fits some other arm sees less
        return waves
    relations = tuple(
        dataclasses.replace(entry, standard_error=error, p_value=min(entry.p_value, whole.p_value))
        for entry, error in zip(chain.relations, whole.offset_errors, strict=True)
    )
    return dataclasses.replace(chain, relations=relations, fit=fit, lack=waves.lack, method=BOTH)


def _common(
    chain: LearnedSymmetries, waves: LearnedSymmetries, p_value: float
) -> LearnedSymmetries:
    """What waves claim and the chain has too, where they do not agree."""
    known = candidates_of(chain.group)
    kept = []
    for entry in waves.relations:
        relation = in_basis(entry.relation, known.basis)
        if relation is not None and is_among(relation, known):
            kept.append(entry)
    missing = (
        f"samples that decide: {chain.order} relations of a rigid chain fit them, and are "
        f"contradicted by the potential of any arm (p = {p_value:.1g})"
    )
    group = SymmetryGroup([entry.relation for entry in kept])
    return dataclasses.replace(
        waves, group=group, relations=tuple(kept), missing=missing, method=BOTH
    )


def candidates_of(relations: Iterable[SymmetryRelation]) -> CandidateGroup:
    """Relations of one group as arrays."""
    listed = list(relations)
    return CandidateGroup(
        listed[0].basis,
        np.array([r.A_sat for r in listed]),
        np.array([r.d_sat for r in listed]),
        np.array([r.Y for r in listed]),
    )


def in_basis(relation: SymmetryRelation, basis: NDArray[np.int64]) -> SymmetryRelation | None:
    """Write a relation in other y = B q coordinates; None where it does not act on them."""
    B = basis.astype(float)
    if not np.allclose(B @ relation.A @ np.linalg.pinv(B) @ B, B @ relation.A, atol=1e-9):
        return None
    return SymmetryRelation(relation.A, relation.d, relation.Y, basis)


def is_among(relation: SymmetryRelation, others: CandidateGroup) -> bool:
    """Whether a relation is one of others in the same coordinates, up to errors of offsets."""
    match = (others.Y == relation.Y).all(axis=1)
    match &= (np.abs(others.A - relation.A_sat) < 1e-6).all(axis=(1, 2))
    match &= (np.abs(wrap(others.d - relation.d_sat)) < SAME_ESTIMATED_OFFSET).all(axis=1)
    return bool(match.any())
