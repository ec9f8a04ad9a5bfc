"""Candidate relations from another source, such as geometry, held against recorded samples."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.claim_bounds import claim_bounds
from isotorque.learning.relations.examined_fit import LARGEST_ERROR, ExaminedFit, examined_fit
from isotorque.learning.relations.identification.wave_identification import SIGNIFICANCE
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.inactive_joints import NEVER_MOVED
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.relations.potential.pull_backs import PullBacks
from isotorque.learning.relations.potential.samples_needed import samples_needed
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.learning.statistics.tails import tail_probability
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.group_arrays import CandidateGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

FIXED = 1e-10  # singular values of relation minus identity below it are rounding


class Judgement(StrEnum):
    """Judgement of a candidate relation by samples."""

    CONSISTENT = "consistent"
    """The samples would have shown a violation, and show none."""
    CONTRADICTED = "contradicted"
    """No torque map with this relation explains the samples."""
    UNTESTABLE = "untestable with this data"
    """The samples leave the question open."""


@dataclass(frozen=True, eq=False)
class JudgedCandidate:
    """A candidate relation and what the samples say of it.

    Attributes
    ----------
    relation : SymmetryRelation
        The candidate, with the bound on its torque error that the samples guarantee at three
        standard errors [N m] (NaN where they determine no potential).
    judgement : Judgement
    p_value : float
        Probability of a misfit at least as large if the relation holds; NaN where untested.
    reason : str
        What is missing where the candidate is untestable; what beside gravity contradicts it.
    """

    relation: SymmetryRelation
    judgement: Judgement
    p_value: float
    reason: str = ""


def judge_candidates(
    candidates: Iterable[SymmetryRelation],
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
) -> tuple[JudgedCandidate, ...]:
    """Test given relations against static samples.

    Parameters
    ----------
    candidates : iterable of SymmetryRelation
        Relations from geometry, from another arm, from a drawing.
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known.

    Returns
    -------
    tuple of JudgedCandidate
        In the order of the candidates.

    Raises
    ------
    InputError
        If the arrays do not fit together, or a candidate has another number of joints.

    Notes
    -----
    Each candidate is one linear hypothesis on the coefficients of the fitted potential: they are a
    fixed point of the relation. It is a claim about the measured torque: one that flips a joint
    with a constant torque is contradicted too, and where the samples show torques that the form
    has no term for (`lack_of_fit`), none is called consistent. One that carries a joint that never
    moved to where nothing was measured is untestable. The offset is taken as it is
    stated. Nothing is learned here, so a candidate may hold where `learn_relations` does not yet
    claim it.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (8, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> true = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> false = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
    >>> [str(found.judgement) for found in judge_candidates([true, false], q, tau)]
    ['consistent', 'contradicted']
    """
    configurations, torques = static_samples(q, tau)
    claims = list(candidates)
    for relation in claims:
        if relation.n != configurations.shape[1]:
            accepted = f"{configurations.shape[1]}, as the samples have"
            raise InputError("candidate relation", "number of joints", relation.n, accepted)
    try:
        examined = examined_fit(configurations, torques, noise)
    except Undetermined as lacking:
        open_question = Judgement.UNTESTABLE
        return tuple(JudgedCandidate(r, open_question, np.nan, str(lacking)) for r in claims)
    still = np.ptp(configurations, axis=0) <= NEVER_MOVED
    return tuple(_judged(relation, examined, still) for relation in claims)


def _judged(
    relation: SymmetryRelation, examined: ExaminedFit, still: NDArray[np.bool_]
) -> JudgedCandidate:
    carried = still & ((np.eye(relation.n) != relation.A).any(axis=1) | (relation.d != 0.0))
    if carried.any():
        joints = ", ".join(str(j + 1) for j in np.flatnonzero(carried))
        reason = f"joint {joints} never moved, and the relation carries it elsewhere"
        return JudgedCandidate(relation, Judgement.UNTESTABLE, np.nan, reason)
    fit, lack = examined.fit, examined.lack
    single = CandidateGroup(
        relation.basis, relation.A_sat[None], relation.d_sat[None], relation.Y[None]
    )
    p_value = _p_value(fit, single)
    bound, rms = claim_bounds(fit, lack, single, examined.deviations)
    bounded = SymmetryRelation(
        relation.A, relation.d, relation.Y, relation.basis, relation.exact, bound[0]
    )
    flipped = (relation.Y[lack.offset_joints] < 0.0).any()
    if p_value < SIGNIFICANCE or (flipped and not lack.failed):
        reason = f"the measured torque has {lack.said}" if flipped else ""
        return JudgedCandidate(bounded, Judgement.CONTRADICTED, p_value, reason)
    if lack.failed:
        return JudgedCandidate(bounded, Judgement.UNTESTABLE, p_value, examined.obstacle)
    typical = fit.rms_torque()
    acting = typical > 0.0
    excess = float((rms[0, acting] / typical[acting]).max(initial=0.0)) / LARGEST_ERROR
    if excess > 1.0:
        reason = f"{samples_needed(fit.samples, excess)}: a violation could hide in the noise"
        return JudgedCandidate(bounded, Judgement.UNTESTABLE, p_value, reason)
    return JudgedCandidate(bounded, Judgement.CONSISTENT, p_value)


def _p_value(fit: FittedPotential, relation: CandidateGroup) -> float:
    """Fit the coefficients among the fixed points of the relation; test the misfit."""
    pulled = PullBacks(fit.frequencies, relation).matrix(0)
    _, singular, directions = np.linalg.svd(pulled - np.eye(len(pulled)))
    fixed = directions[singular < FIXED].T
    target = fit.root @ fit.coefficients
    misfit = target
    if fixed.shape[1]:
        reachable = fit.root @ fixed
        misfit = target - reachable @ np.linalg.lstsq(reachable, target, rcond=None)[0]
    degrees = len(target) - fixed.shape[1]
    return tail_probability(float(misfit @ misfit), degrees, fit.freedom)
