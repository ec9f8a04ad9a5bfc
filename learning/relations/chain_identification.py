"""Symmetries identified from static samples through a rigid chain: few samples, many joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
)
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.static_samples import static_samples
from isotorque.learning.statistics.poses import by_pose

Array = NDArray[np.float64]

METHOD = "rigid chain"
LARGEST_ERROR = 0.05
"""Relations are claimed if none can be wrong by more, relative to the largest torque."""
STARTS = 60
MOST_PER_JOINT = 6
"""Parameters per joint of a chain with constants: four, and what constants add."""
CONSTANT_SEEN = 20.0
"""A constant is seen where it lowers the squares of a joint by so many of what each pose leaves."""
FEW_JOINTS = 3
"""Up to so many joints a potential of waves needs no more than nine samples: its word stands."""


def with_chain(
    learned: LearnedSymmetries,
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
) -> LearnedSymmetries:
    """What was learned otherwise, or what a rigid chain says where that lacks samples.

    Parameters
    ----------
    learned : LearnedSymmetries
        By pairing and identification. It stands where it found relations, lacks nothing, where
        the torques are no rigid gravity, and on arms of few joints.
    q, tau, noise
        As in `identify_by_chain`.
    """
    stands = learned.order > 1 or learned.missing is None or learned.group.n <= FEW_JOINTS
    if stands or (learned.lack is not None and learned.lack.failed):
        return learned
    return identify_by_chain(q, tau, noise=noise) or learned


def identify_by_chain(
    q: ArrayLike, tau: ArrayLike, *, noise: MeasurementNoise | None = None
) -> LearnedSymmetries | None:
    """Find the symmetry group of the rigid chain behind static samples.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad]; joints in series.
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known; estimated otherwise.

    Returns
    -------
    LearnedSymmetries or None
        None where no chain is accepted, or where a relation of it could be wrong by 5 % of the
        largest torque.

    Notes
    -----
    Rows of one pose count as one sample.
    Where one potential for all torques of any arm needs ``(3^n - 1) / n`` samples (`identify`), a
    chain needs four to eight, as it has 4 n - 1 numbers. Relations are those of the snapped chain;
    their bounds are of the arm that was measured (`chain_symmetries`).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> q = rng.uniform(-3, 3, (6, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = identify_by_chain(q, tau)
    >>> found.order, found.method
    (8, 'rigid chain')
    """
    configurations, torques = static_samples(q, tau)
    if not len(torques) or not torques.any():
        return None
    _, configurations, torques = by_pose(configurations, torques)
    learner = RigidChain(
        torque_noise=None if noise is None else noise.torque,
        angle_noise=0.0 if noise is None else noise.angle,
        max_starts=STARTS,
    ).fit(configurations, torques)
    return relations_of_chain(learner, configurations, torques)


def relations_of_chain(
    learner: RigidChain, configurations: Array, torques: Array
) -> LearnedSymmetries | None:
    """The relations of a chain that was fitted to samples, if they can be claimed.

    Parameters
    ----------
    learner : RigidChain
        Fitted, accepted or not.
    configurations, torques : (m, n) arrays
        Static samples that it explains [rad], [N m].

    Returns
    -------
    LearnedSymmetries or None
        As of `identify_by_chain`.
    """
    if not learner.verdict_.accepted or _shows_constants(learner, configurations, torques):
        return None
    found = learner.symmetries()
    worst = max(float(relation.bound.max(initial=0.0)) for relation in found.group)
    if worst > LARGEST_ERROR * float(np.abs(torques).max()):
        return None
    relations = tuple(
        LearnedRelation(
            relation,
            Knowledge.IDENTIFIED,
            0,
            np.full(len(relation.basis), np.nan),
            found.snapped.p_value,
            snapped=bool(found.snapped.hypotheses),
        )
        for relation in found.group
    )
    return LearnedSymmetries(found.group, relations, None, METHOD)


def _shows_constants(learner: RigidChain, q: Array, tau: Array) -> bool:
    """Whether constant torques explain what a chain with noise estimated took for noise.

    Relations that change their sign would then not hold of the measured torque.
    """
    if learner.verdict_ is not FitStatus.HELD_OUT:
        return False
    other = RigidChain(unknown_offsets=True, max_starts=STARTS).fit(q, tau)
    if not other.verdict_.accepted:
        return False
    without = ((tau - learner.predict(q)) ** 2).sum(axis=0)
    left = ((tau - other.predict(q)) ** 2).sum(axis=0)
    spare = max(len(q) - MOST_PER_JOINT, 1)
    return bool((without > left * (1.0 + CONSTANT_SEEN / spare)).any())
