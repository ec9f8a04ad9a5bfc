"""Next sample: the configuration whose torque says most about undecided symmetries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.learning.relations.potential.errors_in_variables import (
    stiffness_matrices,
    torque_features,
)
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.relations.potential.pull_backs import PullBacks
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.group_arrays import CandidateGroup
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

PROPOSALS = 64
"""Configurations that are considered."""


@dataclass(frozen=True, eq=False)
class NextSample:
    """A configuration worth measuring.

    Attributes
    ----------
    q : (n,) array
        Configuration [rad].
    torque : (n,) array
        Torque that the fitted potential expects there [N m]: what to command an arm that can only
        settle, or to compare with where it can be placed.
    information : float
        Expected information about the rival hypotheses [nat].
    index : int
        Position among the proposed configurations.
    """

    q: Array
    torque: Array
    information: float
    index: int


def most_telling_sample(
    fit: FittedPotential, group: SymmetryGroup | None, proposals: ArrayLike
) -> NextSample:
    """Choose the configuration that best separates a symmetric torque map from an asymmetric one.

    Parameters
    ----------
    fit : FittedPotential
        What is known so far.
    group : SymmetryGroup or None
        The symmetries in question; None where all coefficients are.
    proposals : (m, n) array_like
        Configurations that can be measured [rad]: places where the arm can settle, or any in
        guided operation.

    Returns
    -------
    NextSample

    Raises
    ------
    InputError
        If there are no proposals or they have another number of joints.

    Notes
    -----
    The rivals differ in the part of the coefficients that the symmetries forbid. With its
    covariance V, torque features F(q) of that part and measurement noise R(q), a measurement at q
    brings ``0.5 log det(I + R^-1 F V F^T)`` nats (Bayesian D-optimal design [1]_).

    References
    ----------
    .. [1] K. Chaloner, I. Verdinelli, "Bayesian experimental design: a review", Statistical
       Science 10 (1995).
    """
    q = np.asarray(proposals, dtype=float)
    n = fit.frequencies.shape[1]
    if q.ndim != 2 or q.shape[1] != n or not len(q):
        raise InputError("next sample", "shape of proposals", q.shape, f"(m, {n}), m >= 1")
    forbidden = np.eye(len(fit.coefficients))
    if group is not None:
        candidate = CandidateGroup(group.basis, group.A_sat, group.d_sat, group.Y)
        forbidden = forbidden - PullBacks(fit.frequencies, candidate).average()
    root = forbidden @ np.linalg.inv(fit.root)  # V = root root^T
    acting = fit.frequencies.any(axis=0)
    effect = torque_features(fit.frequencies, q)[:, acting] @ root
    stiffness = stiffness_matrices(fit.frequencies, fit.coefficients, q)[:, acting][:, :, acting]
    noise = fit.noise.torque**2 * np.eye(int(acting.sum()))
    noise = noise + fit.noise.angle**2 * stiffness @ np.swapaxes(stiffness, 1, 2)
    gain = np.linalg.solve(noise, effect @ np.swapaxes(effect, 1, 2))
    information = 0.5 * np.linalg.slogdet(np.eye(gain.shape[1]) + gain)[1]
    best = int(information.argmax())
    torque = torque_features(fit.frequencies, q[best : best + 1])[0] @ fit.coefficients
    return NextSample(q[best].copy(), torque, float(information[best]), best)


def next_torque(
    learned: LearnedSymmetries, settled: ArrayLike, rng: np.random.Generator
) -> NextSample | None:
    """Choose the torque that an arm without a controller should be given next.

    Parameters
    ----------
    learned : LearnedSymmetries
        What its settled samples say so far.
    settled : (m, n) array_like
        Configurations it has settled in [rad].
    rng : numpy.random.Generator
        Source of proposals.

    Returns
    -------
    NextSample or None
        To be commanded: its ``torque``. None where no potential could be fitted, or it expects
        the arm to rest at none of the proposals.

    Notes
    -----
    Proposals lie between configurations the arm has settled in, where the fitted potential is
    stable. Where no relation is claimed yet, all coefficients are in question.
    """
    seen, fit = np.asarray(settled, dtype=float), learned.fit
    if fit is None or len(seen) < 2:
        return None
    if learned.lack is not None:  # the form by which `claim` decides
        fit = fit.without_constants(learned.lack.offset_joints)
    first, second = seen[rng.integers(len(seen), size=(2, PROPOSALS))]
    between = first + rng.random((PROPOSALS, 1)) * wrap(second - first)
    acting = fit.frequencies.any(axis=0)
    stiffness = stiffness_matrices(fit.frequencies, fit.coefficients, between)
    stable = np.linalg.eigvalsh(stiffness[:, acting][:, :, acting])[:, 0] > 0.0
    if not stable.any():
        return None
    return most_telling_sample(fit, learned.group if learned.order > 1 else None, between[stable])


class Released(Protocol):
    """Motion of an arm that is let go."""

    @property
    def balanced(self) -> bool:
        """Whether it stays, as far as can be seen at once."""
        ...


class ReleasableArm(Protocol):
    """An arm that can be placed from outside and let go (guided operation)."""

    def release_test(
        self, q: ArrayLike, torque: ArrayLike, acceleration: float | None = None
    ) -> Released:
        """Place at rest at q (n,) [rad], apply a torque (n,) [N m], observe the acceleration."""
        ...


@dataclass(frozen=True, eq=False)
class ReleaseCheck:
    """Outcome of letting an arm go at images of recorded configurations.

    Attributes
    ----------
    tested, balanced : int
        Number of images, and how many the predicted torque balanced.
    counterexample : (n,) array or None
        A recorded configuration [rad] whose image was not balanced.
    """

    tested: int
    balanced: int
    counterexample: Array | None

    @property
    def passed(self) -> bool:
        """Whether every image was balanced, and there was one."""
        return 0 < self.tested == self.balanced


def confirm_by_release(
    arm: ReleasableArm,
    relation: SymmetryRelation,
    q: ArrayLike,
    tau: ArrayLike,
    *,
    acceleration: float | None = None,
) -> ReleaseCheck:
    """Try a relation on an arm, also where the arm cannot settle.

    Parameters
    ----------
    arm : ReleasableArm
    relation : SymmetryRelation
    q, tau : (N, n) array_like
        Recorded configurations [rad] and the torques that held them [N m].
    acceleration : float, optional
        Largest initial acceleration that counts as balance [rad/s^2]; the arm's own by default.
        Allow for the uncertainty of the relation's offset.

    Returns
    -------
    ReleaseCheck
        Images are wrapped to (-pi, pi].
    """
    balanced, counterexample = 0, None
    samples = np.atleast_2d(np.asarray(q, dtype=float))
    torques = np.atleast_2d(np.asarray(tau, dtype=float))
    for configuration, torque in zip(samples, torques, strict=True):
        image = wrap(relation.configuration(configuration))
        if arm.release_test(image, relation.torque(torque), acceleration).balanced:
            balanced += 1
        elif counterexample is None:
            counterexample = configuration.copy()
    return ReleaseCheck(len(samples), balanced, counterexample)
