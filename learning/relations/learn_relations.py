"""Symmetry relations learned from static samples: identified, and checked by pairs."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.examined_fit import ExaminedFit
from isotorque.learning.relations.identification.chain_identification import METHOD as BY_CHAIN
from isotorque.learning.relations.identification.group_fit import fit_group
from isotorque.learning.relations.identification.identify import (
    candidates_of,
    identify,
    in_basis,
    is_among,
)
from isotorque.learning.relations.identification.wave_identification import METHOD as BY_WAVES
from isotorque.learning.relations.identification.wave_identification import SIGNIFICANCE, claim
from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
)
from isotorque.learning.relations.pairing.orbit_refinement import Refinement
from isotorque.learning.relations.pairing.pair_evidence import PairEvidence
from isotorque.learning.relations.pairing.pair_relations import (
    learned_from_pairs,
    nothing_stands_out,
)
from isotorque.learning.relations.pairing.pair_search import PairSearch, search_pairs
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.groups.group_arrays import CandidateGroup, completed
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

LEAST_ANGLE_NOISE = 1e-8
"""Settled angles are not trusted beyond this [rad] when pairs are compared."""
FREEDOM = 8.0
"""Degrees of freedom from which an estimated noise level is good enough for pairing."""
CONTRADICTED = 5.0
"""A relation is false if torques that a chain predicts for it differ by so many standard errors"""
NEGLIGIBLE = 1e-6
"""and by this share of the largest."""


def learn_relations(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
    largest_entry: int = 2,
    snap: bool = True,
    parents: Sequence[int] | None = None,
) -> LearnedSymmetries:
    """Learn the symmetry group of the torque map from static samples, by all methods.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known; estimated otherwise.
    largest_entry : int
        Largest entry of A that pairing tries.
    snap : bool
        Round offsets to multiples of a right angle where all of them agree; every relation says
        whether that was done.
    parents : sequence of int, optional
        Joint that carries each joint, -1 for the base; in series by default.

    Returns
    -------
    LearnedSymmetries
        Every relation says how it is known: *observed* in pairs of at least three distinct
        torques (two where the angles are exact), *implied by the group* of those, or *identified*
        through the fitted potential.
        ``missing`` says what the data lack where something could not be decided;
        ``contradicted`` holds relations that pairs seem to show and the potential excludes.

    Raises
    ------
    InputError
        If the arrays do not fit together.

    Notes
    -----
    Identification (`identify`: a rigid chain first, waves where joints are few or no chain is
    accepted) needs no configurations with equal torque and finds relations that no pair can show:
    an arm that cannot hold itself upright never records an upright partner.
    Pairing (`pair_relations`) needs no model of the torque. Where both speak, a paired relation
    that the chain or the fitted potential contradicts is dropped, and the offsets come from those,
    which use all samples. Where the samples determine neither, what pairing found
    stands alone, without a bound on the torque error.

    Examples
    --------
    >>> rng = np.random.default_rng(2)
    >>> q = rng.uniform([-1.5, -1.5], [-0.1, 0.1], (8, 2))
    >>> q = np.concatenate([q, q @ [[-1, 2], [0, 1]]])  # q1' = -q1, q2' = 2 q1 + q2
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = learn_relations(q, tau)
    >>> [str(relation.known) for relation in found.relations].count("identified")
    6
    """
    configurations, torques = static_samples(q, tau)
    identified = identify(configurations, torques, noise=noise, snap=snap, parents=parents)
    lack = identified.lack
    if lack is not None and lack.failed:
        # pairs would show near misses of relations that the measured torque does not have
        return identified
    try:
        pairs = search_pairs(
            configurations, torques, _noise_of_pairs(noise, identified), largest_entry
        )
    except Undetermined as lacking:
        if identified.order > 1 or identified.decided:
            return identified
        missing = _both(identified.missing, str(lacking))
        return dataclasses.replace(identified, missing=missing)
    paired = learned_from_pairs(pairs, snap)
    if not identified.decided and identified.order == 1:
        return _pairs_first(pairs, paired, identified)
    if identified.fit is None:
        return _beside_chain(pairs, paired, identified)
    return _joined(pairs, paired, identified, snap)


def _and_pairing(method: str) -> str:
    """A method, and pairing as well.

    Examples
    --------
    >>> [_and_pairing(method) for method in ("rigid chain", "identification")]
    ['rigid chain and pairing', 'pairing and identification']
    >>> _and_pairing("rigid chain and identification")
    'rigid chain, pairing and identification'
    """
    if method == BY_CHAIN:
        return f"{method} and pairing"
    return method.replace(f" and {BY_WAVES}", f", {BY_WAVES}").replace(
        BY_WAVES, f"pairing and {BY_WAVES}"
    )


def _both(missing: str | None, for_pairing: str) -> str:
    """What each method lacks; once where it is the same."""
    return for_pairing if missing == for_pairing else f"{missing}; for pairing: {for_pairing}"


def _noise_of_pairs(
    noise: MeasurementNoise | None, identified: LearnedSymmetries
) -> MeasurementNoise | None:
    """Noise that pairing shall allow for: given, or estimated by a potential that fits."""
    fit = identified.fit
    if noise is not None or fit is None or identified.order == 1 or fit.freedom < FREEDOM:
        return noise
    return MeasurementNoise(max(fit.noise.angle, LEAST_ANGLE_NOISE), 0.0)


def _pairs_first(
    pairs: PairSearch, paired: LearnedSymmetries, identified: LearnedSymmetries
) -> LearnedSymmetries:
    """Pairing's result where identification could not decide; a fit may still contradict."""
    missing = identified.missing
    if paired.order == 1:
        missing = _both(missing, nothing_stands_out(pairs))
    fit = identified.fit
    if fit is not None and paired.order > 1:
        whole = fit_group(fit, candidates_of(list(paired.group)))
        flipped = identified.lack is not None and any(
            (r.Y[identified.lack.offset_joints] < 0.0).any() for r in paired.group
        )
        if whole.p_value < SIGNIFICANCE or flipped:
            contradicted = tuple(r for r in paired.relations if not r.relation.is_identity)
            return dataclasses.replace(
                identified, contradicted=contradicted, method=_and_pairing(identified.method)
            )
    return dataclasses.replace(
        paired,
        missing=missing,
        fit=fit,
        method=_and_pairing(identified.method),
        lack=identified.lack,
    )


def _joined(
    pairs: PairSearch, paired: LearnedSymmetries, identified: LearnedSymmetries, snap: bool
) -> LearnedSymmetries:
    """Both methods spoke: join their groups where the potential agrees, and add the evidence."""
    fit, lack = identified.fit, identified.lack
    assert fit is not None
    assert lack is not None
    examined = ExaminedFit(fit, lack, [])
    result = identified
    group = candidates_of(list(identified.group))
    contradicted = []
    for learned in paired.relations:
        relation = in_basis(learned.relation, group.basis)
        if relation is not None and is_among(relation, group):
            continue
        larger = None if relation is None else _extended(group, relation)
        joined = None if larger is None else fit_group(fit, larger)
        if joined is None or joined.p_value < SIGNIFICANCE:
            contradicted.append(learned)
            continue
        claimed = claim(examined, joined, snap)
        if claimed.decided:
            result = dataclasses.replace(claimed, missing=identified.missing)
            group = joined.group
    return dataclasses.replace(
        _with_evidence(result, pairs, paired),
        contradicted=tuple(contradicted),
        method=_and_pairing(identified.method),
    )


def _beside_chain(
    pairs: PairSearch, paired: LearnedSymmetries, identified: LearnedSymmetries
) -> LearnedSymmetries:
    """The relations of a chain alone, with what pairs say of them."""
    chain = identified.chain
    assert chain is not None
    group = candidates_of(identified.group)
    contradicted, open_ones = [], 0
    for learned in paired.relations:
        relation = in_basis(learned.relation, group.basis)
        if relation is not None and is_among(relation, group):
            continue
        if _excluded(chain, learned):
            contradicted.append(learned)
        else:
            open_ones += 1
    missing = identified.missing
    if open_ones:
        missing = f"samples that decide about {open_ones} more relations, which pairs alone show"
    return dataclasses.replace(
        _with_evidence(identified, pairs, paired),
        missing=missing,
        contradicted=tuple(contradicted),
        method=_and_pairing(identified.method),
    )


def _excluded(chain: RigidChain, learned: LearnedRelation) -> bool:
    """Whether a chain's torques do not obey a relation, errors of both allowed for."""
    relation, samples = learned.relation, chain.fit_.samples
    q, image = samples.q, relation.configuration(samples.q)
    error = np.abs(chain.predict(image) - relation.Y * chain.predict(q))
    shift = np.linalg.pinv(relation.basis.astype(float)) @ learned.standard_error
    allowed = chain.standard_error(image) + chain.standard_error(q)
    allowed = allowed + np.abs(chain.jacobian(image)) @ np.abs(shift)
    allowed = CONTRADICTED * allowed + NEGLIGIBLE * samples.largest_torque
    return bool((error > allowed).any())


def _extended(group: CandidateGroup, relation: SymmetryRelation) -> CandidateGroup | None:
    return completed(
        CandidateGroup(
            group.basis,
            np.concatenate([group.A, relation.A_sat[None]]),
            np.concatenate([group.d, relation.d_sat[None]]),
            np.concatenate([group.Y, relation.Y[None]]),
        )
    )


def _with_evidence(
    result: LearnedSymmetries, pairs: PairSearch, paired: LearnedSymmetries
) -> LearnedSymmetries:
    """Say of every relation what the pairs say of it."""
    active = pairs.active
    joints = np.ix_(active, active)
    local = CandidateGroup(
        np.eye(int(active.sum()), dtype=np.int64),
        np.array([r.A[joints] for r in result.group]),
        np.array([r.d[active] for r in result.group]),
        np.array([r.Y[active] for r in result.group]),
    )
    noise = pairs.refinement if paired.order > 1 else None
    sigma = noise.sigma if noise else pairs.tolerance.sigma
    freedom = noise.freedom if noise else np.inf
    refinement = Refinement(local, np.zeros(local.d.shape), sigma, freedom)
    evidence = PairEvidence(pairs.kinds, refinement, pairs.accepted, pairs.tolerance)
    known = candidates_of(list(paired.group))
    learned = []
    for i, relation in enumerate(result.relations):
        support = evidence.support(i)
        in_old_basis = in_basis(relation.relation, known.basis)
        paired_too = in_old_basis is not None and is_among(in_old_basis, known)
        how = Knowledge.IDENTIFIED
        if paired_too:
            how = Knowledge.OBSERVED if support >= pairs.least_torques else Knowledge.IMPLIED
        learned.append(
            dataclasses.replace(
                relation,
                known=how,
                support=support,
                p_value=min(relation.p_value, evidence.p_value(i)),
                log10_false_alarms=evidence.log10_false_alarms(i),
                regression=evidence.regression(i),
            )
        )
    return dataclasses.replace(result, relations=tuple(learned), rejected=evidence.rejected())
