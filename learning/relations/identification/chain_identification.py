"""Symmetries identified from static samples through a rigid chain: few samples, many joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape
from isotorque.learning.learners.rigid.planning.poses_needed import fewest_poses
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.examined_fit import LARGEST_ERROR, could_be_wrong
from isotorque.learning.relations.identification.unfelt_levers import unfelt_lever
from isotorque.learning.relations.lack_of_fit import LackOfFit
from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
    nothing_learned,
)
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.poses import by_pose
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

METHOD = "rigid chain"
STARTS = 60
SAME_TORQUE = 0.01
"""Torques that differ by less, relative to the largest, are the same."""
SAME = 1e-9
"""Entries and offsets [rad] that differ by less are equal."""
MOST_JOINTS = 8
"""A chain that does not fit is asked for wrong gains and signs up to so many joints: with 12 that
takes as long as two fits, and most arms of more joints branch."""
MOST_POSES = 500
"""A chain is fitted to no more poses, evenly taken."""


def identify_by_chain(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
    parents: Sequence[int] | None = None,
    any_chain: bool = True,
) -> LearnedSymmetries:
    """Find the symmetry group of the rigid chain behind static samples.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known; estimated otherwise.
    parents : sequence of int, optional
        Joint that carries each joint, -1 for the base; in series by default.
    any_chain : bool
        Also where samples are those of a rigid chain only with a gain or a sign that was measured
        otherwise. False where another form of gravity explains them without.

    Returns
    -------
    LearnedSymmetries
        Only the identity where no chain is accepted, where the samples show torques beside it or
        are too few to show them, or where a relation of gravity could be wrong by 5 % of the
        largest torque: ``missing`` says which.

    Notes
    -----
    Rows of one pose count as one sample. Where one potential for all torques of any arm needs
    ``(3^n - 1) / n`` samples (`identify_by_waves`), a chain needs four to eight, as it has 4 n - 1
    numbers. Relations are those of the snapped chain; their bounds are of the torque that was
    measured (`chain_symmetries`).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> q = rng.uniform(-3, 3, (6, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = identify_by_chain(q, tau)
    >>> found.order, found.method
    (8, 'rigid chain')
    >>> identify_by_chain(q[:3], tau[:3]).missing
    '1 more poses: 3 different ones were given, 4 are needed'
    """
    configurations, torques = static_samples(q, tau)
    n = configurations.shape[1]
    learner = chain_of_samples(configurations, torques, noise=noise, parents=parents)
    if isinstance(learner, str):
        return nothing_learned(n, learner, METHOD)
    return relations_of_chain(learner, any_chain=any_chain)


def chain_of_samples(
    q: Array,
    tau: Array,
    *,
    noise: MeasurementNoise | None = None,
    parents: Sequence[int] | None = None,
) -> RigidChain | str:
    """Fit a chain to the poses of samples, if these are of torques enough.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Rows [rad], [N m].
    noise, parents
        As of `identify_by_chain`.

    Returns
    -------
    RigidChain or str
        Fitted, accepted or not; or what is missing.
    """
    if not tau.any():
        return "samples with a torque"
    _, configurations, torques = by_pose(q, tau)
    given, needed = _different_torques(torques), fewest_poses(q.shape[1], parents)
    if given < min(needed, len(torques)):
        return (
            f"{needed - given} more torques: {given} different |torque| given, {needed} are needed "
            "(poses that symmetries relate say the same)"
        )
    last = len(configurations) - 1
    taken = np.unique(np.linspace(0, last, MOST_POSES).round().astype(int))
    return RigidChain(
        parents,
        torque_noise=None if noise is None else noise.torque,
        angle_noise=0.0 if noise is None else noise.angle,
        max_starts=STARTS,
    ).fit(configurations[taken], torques[taken])


def _different_torques(torques: Array) -> int:
    """Number of different |torque|, none within `SAME_TORQUE` of another at every joint.

    Recordings of the paper's kind hold many configurations of few torques, which the arm's
    symmetries map to each other: they fill equations without telling a false chain from the true.
    """
    sizes = np.abs(torques)
    near = SAME_TORQUE * float(sizes.max())
    left, count = sizes, 0
    while len(left):
        left = left[(np.abs(left - left[0]) > near).any(axis=1)]
        count += 1
    return count


def relations_of_chain(learner: RigidChain, *, any_chain: bool = True) -> LearnedSymmetries:
    """The relations of a chain that was fitted to samples, if they can be claimed.

    Parameters
    ----------
    learner : RigidChain
        Fitted, accepted or not.
    any_chain : bool
        As of `identify_by_chain`.

    Returns
    -------
    LearnedSymmetries
        As of `identify_by_chain`.
    """
    learner, missing, lack = explained(learner, any_chain=any_chain)
    n, samples = learner.fit_.model.n, learner.fit_.samples
    if missing:
        return nothing_learned(n, missing, METHOD, lack=lack)
    found = learner.symmetries()
    excess = float(found.gravity_bounds.max()) / (LARGEST_ERROR * samples.largest_torque)
    if excess > 1.0:
        missing = could_be_wrong(len(samples.q), excess)
        return nothing_learned(n, missing, METHOD)
    correction = None if lack is None else lack.correction
    plain = [r for r in found.group if correction is None or _needs_none(r, correction)]
    corrected = tuple(r.of_measured(correction) for r in found.group if r not in plain)
    relations = tuple(
        LearnedRelation(
            relation,
            Knowledge.IDENTIFIED,
            0,
            np.full(len(relation.basis), np.nan),
            found.snapped.p_value,
            snapped=bool(found.snapped.hypotheses),
        )
        for relation in plain
    )
    return LearnedSymmetries(
        SymmetryGroup([entry.relation for entry in relations]),
        relations,
        None,
        METHOD,
        lack=lack,
        corrected=corrected,
        chain=learner,
    )


def _needs_none(relation: SymmetryRelation, correction: Correction) -> bool:
    """Whether a relation of gravity holds of the measured torque as it is: c(q') = Y c(q)."""
    if relation.is_identity:
        return True
    kept = relation.Y > 0.0
    moved = np.abs(relation.A - relation.Y[:, None] * np.eye(relation.n)).max(axis=1)
    turned = np.maximum(moved, np.abs(relation.unwrapped_d)) < SAME
    springs = correction.rate != 0.0
    return bool(kept[correction.constant != 0.0].all() and turned[springs].all())


def explained(
    learner: RigidChain, *, any_chain: bool = True
) -> tuple[RigidChain, str, LackOfFit | None]:
    """A chain, with what its samples show beside it, and what stands in the way of claims.

    Parameters
    ----------
    learner : RigidChain
        Fitted to samples, accepted or not.
    any_chain : bool
        As of `identify_by_chain`.

    Returns
    -------
    learner : RigidChain
        With the constants, springs and gains that the samples show.
    missing : str
        What stands in the way; empty where nothing does.
    lack : LackOfFit or None
        What the samples show beside gravity.
    """
    n, lack = learner.fit_.model.n, None
    if not (learner.verdict_.accepted or (any_chain and n <= MOST_JOINTS)):
        return learner, learner.remark_, None
    if learner.shown_causes():
        extended = learner.with_causes()
        if extended is None:
            lack = _beside(learner, learner.shown_causes(), failed=True)
            return learner, f"an arm whose torque is rigid gravity: there is {lack.said}", lack
        learner, lack = extended, _beside(extended, extended.causes_, failed=False)
    elif learner.verdict_.accepted and learner.fit_.model.columns:  # it was told of some
        lack = _beside(learner, learner.causes_, failed=False)
    if not learner.verdict_.accepted:
        return learner, learner.remark_, None
    joint = unfelt_lever(learner.fit_)
    if joint is not None:
        missing = (
            f"torque on joint {joint + 1}: it held none in all samples, and what it carries may "
            "have been balanced there alone"
        )
        return learner, missing, None
    beside = learner.beside()
    if not beside.complete and learner.verdict_ is not FitStatus.ROUNDING:
        given, needed = len(learner.fit_.samples.q), beside.samples_needed
        missing = (
            f"{needed - given} more samples: {given} different ones were given, which a chain does "
            f"not explain exactly; {needed} show whether noise does, or a spring or a cable"
        )
        return learner, missing, None
    return learner, "", lack


def _beside(chain: RigidChain, causes: tuple[Cause, ...], *, failed: bool) -> LackOfFit:
    """What the samples show beside a chain: in it, or nothing that it has a term for."""
    errors = np.zeros(chain.fit_.model.n)
    columns = [c for c in chain.fit_.model.columns if c.shape is ColumnShape.OFFSET]
    joints = np.array(sorted({column.joint for column in columns}), dtype=int)
    errors[joints] = chain.fit_.offset_errors[joints]
    held, said = chain.fit_.chain.correction, causes_in_words(causes)
    return LackOfFit(causes, joints, held.constant, errors, (), failed, said, rates=held.rate)
