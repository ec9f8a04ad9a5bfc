"""Errors of given relations of the torque behind samples: how large at least, how large at most.

Only poses that a relation carries into each other can be compared directly. Otherwise a form of the
torque is fitted to the samples, which says how far it misses the relation anywhere: waves, the form
of every arm of rigid links, and a rigid chain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.misread_samples import other_reading
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.structure.chain_symmetries import RelationBounds
from isotorque.learning.learners.rigid.structure.expansion import expanded
from isotorque.learning.relations.claim_bounds import claim_bounds
from isotorque.learning.relations.examined_fit import ExaminedFit, examined_fit
from isotorque.learning.relations.identification.chain_identification import (
    chain_of_samples,
    explained,
)
from isotorque.learning.relations.identification.group_fit import torque_uncertainty
from isotorque.learning.relations.identification.identify import SECOND_OPINION
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
    torque_features,
)
from isotorque.learning.relations.potential.inactive_joints import NEVER_MOVED
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.group_arrays import CandidateGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

POINTS = 400
"""Configurations at which errors are looked for."""
CHANCE = 1e-3
"""Chance with which any least error is above the true one."""


@dataclass(frozen=True, eq=False)
class RelationErrors:
    """How far the torque behind samples misses a relation.

    Attributes
    ----------
    estimate, seen, least, most, beside : (n,) arrays
        Largest error of each joint over all configurations [N m]: as fitted; errors of samples
        taken off; torques beside gravity that they leave room for taken off, too; at most (errors
        of samples added, three standard errors), if no torque acts that samples do not show; and if
        springs, cables and constants act as large as they leave room for. NaN where nothing is
        known.
    where : (n, n) array
        Where the least error is found, one configuration per joint [rad]; NaN likewise.
    means : str
        What was fitted; empty where nothing could be.
    missing : str
        What the samples lack; empty where something was fitted.
    noise : (n,) array
        Of the torques of a pose, by what was left of them [N m]; NaN likewise.
    freedom : float
        Degrees of freedom it is known with, joint by joint.
    """

    estimate: Array
    seen: Array
    least: Array
    most: Array
    beside: Array
    where: Array
    means: str
    missing: str
    noise: Array
    freedom: float


class _Form(Protocol):
    """A form of the torque that explains the samples."""

    means: str
    residual: Array
    freedom: float

    def errors(
        self, relation: SymmetryRelation, chance: float
    ) -> tuple[Array, Array, Array, Array, Array, Array]:
        """As `RelationErrors`: estimate, seen, least, most, beside (n,), and where (n, n)."""


def relation_errors(
    relations: Sequence[SymmetryRelation],
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
) -> tuple[tuple[RelationErrors, ...], ...]:
    """Say how far the torque behind static samples misses given relations.

    Parameters
    ----------
    relations
        From a drawing, from another recording. What their ``correction`` says is taken off the
        torques, and the rest judged.
    q, tau : (N, n) array_like
        Configurations at rest [rad], torques that held them [N m]; rows of one pose count as one.
    noise : MeasurementNoise, optional
        Noise levels where known.

    Returns
    -------
    tuple of tuple of RelationErrors
        For each relation, in their order, what each form that explains the samples says; one entry
        without means where none does.

    Raises
    ------
    InputError
        If the arrays do not fit together, or a relation has another number of joints.

    Notes
    -----
    Up to three joints waves are fitted, and a chain beside; beyond, a chain, and waves where none
    is accepted. Where the samples show torques that a form has no term for (`lack_of_fit`,
    `beside_chain`), or are too few to show them, it says nothing. Least errors of all relations,
    joints and configurations hold together (Bonferroni, or Scheffe where that is less).

    References
    ----------
    H. Scheffe, "The Analysis of Variance", Wiley 1959, section 3.4.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (20, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += 0.01 * rng.normal(size=tau.shape)
    >>> true = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> false = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
    >>> found = relation_errors([true, false], q, tau)
    >>> [errors[0].means for errors in found]
    ['waves', 'waves']
    >>> bool(found[0][0].most.max() < 0.2), bool(found[1][0].least.max() > 5.0)
    (True, True)
    """
    configurations, torques = static_samples(q, tau)
    n = configurations.shape[1]
    for relation in relations:
        if relation.n != n:
            raise InputError("relation", "number of joints", relation.n, f"{n}, as samples have")
    still = np.ptp(configurations, axis=0) <= NEVER_MOVED
    fitted: dict[bytes, tuple[tuple[_Form, ...], str]] = {}
    found: list[tuple[RelationErrors, ...]] = []
    for relation in relations:
        correction = relation.correction or Correction(np.zeros(n))
        key = correction.constant.tobytes() + correction.rate.tobytes()
        if key not in fitted:
            gravity = torques - correction.at(configurations)
            fitted[key] = _forms(configurations, gravity, noise)
        forms, missing = fitted[key]
        chance = CHANCE / max(1, len(relations) * len(forms))
        carried = still & ((np.eye(n) != relation.A).any(axis=1) | (relation.d != 0.0))
        if carried.any():
            joints = ", ".join(str(j + 1) for j in np.flatnonzero(carried))
            found.append((_nothing(n, f"joint {joints} moved, which the relation carries"),))
        elif not forms:
            found.append((_nothing(n, missing),))
        else:
            found.append(tuple(_asked(form, relation, chance) for form in forms))
    return tuple(found)


def _asked(form: _Form, relation: SymmetryRelation, chance: float) -> RelationErrors:
    noise = np.sqrt(np.sum(form.residual**2, axis=0) / form.freedom)
    found = form.errors(relation, chance)
    return RelationErrors(*found, form.means, "", noise, form.freedom)


def _nothing(n: int, missing: str) -> RelationErrors:
    nothing = np.full(n, np.nan)
    nowhere = np.full((n, n), np.nan)
    five = nothing, nothing, nothing, nothing, nothing
    return RelationErrors(*five, nowhere, "", missing, nothing, 0.0)


def _forms(q: Array, tau: Array, noise: MeasurementNoise | None) -> tuple[tuple[_Form, ...], str]:
    """Forms that explain the samples, and what is missing where there is none."""
    few = q.shape[1] <= SECOND_OPINION
    waves = _waves(q, tau, noise) if few else None
    if isinstance(waves, _Obstacle) and not waves.of_a_chain:
        return (), waves + _reading(q, tau)
    chain = _chain(q, tau, noise, any_chain=not isinstance(waves, _Waves))
    if not few and isinstance(chain, str):
        waves = _waves(q, tau, noise)
    if isinstance(waves, _Obstacle) and isinstance(chain, str):
        return (), waves + _reading(q, tau)
    forms = tuple(x for x in (waves, chain) if x is not None and not isinstance(x, str))
    missing = "" if forms else f"{chain} (rigid chain); {waves} (any arm){_reading(q, tau)}"
    return forms, missing


def _reading(q: Array, tau: Array) -> str:
    """What would make the samples those of a rigid chain: degrees, a sign, columns."""
    learner = chain_of_samples(q, tau)
    if isinstance(learner, str) or learner.verdict_ is not FitStatus.MISFIT:
        return ""
    names = [f"joint {j + 1}" for j in range(q.shape[1])]
    samples = learner.fit_.samples
    found = other_reading(learner, samples.q, samples.torque, names)
    return f"; a rigid chain explains all samples if {found}" if found else ""


def _waves(q: Array, tau: Array, noise: MeasurementNoise | None) -> _Waves | str:
    try:
        examined = examined_fit(q, tau, noise)
    except Undetermined as lacking:
        return str(lacking)
    if examined.lack.failed:
        return _Obstacle(examined)
    return (examined.lack.left if noise is None else "") or _Waves(examined)


def _chain(
    q: Array, tau: Array, noise: MeasurementNoise | None, *, any_chain: bool
) -> _Chain | str:
    """A chain, with the constants and gains that samples show beside it."""
    learner = chain_of_samples(q, tau, noise=noise)
    if isinstance(learner, str):
        return learner
    learner, missing, _ = explained(learner, any_chain=any_chain)
    return missing or _Chain(learner)


def _points(n: int) -> Array:
    return np.asarray(np.random.default_rng(0).uniform(-np.pi, np.pi, (POINTS, n)))


def _deviations(chance: float, n: int, parameters: int, freedom: float) -> float:
    """Standard errors exceeded at any of the configurations and joints with a chance."""
    single = chance / (2.0 * POINTS * n)
    if np.isinf(freedom):
        return float(min(stats.norm.isf(single), stats.chi2.isf(chance, parameters) ** 0.5))
    together = parameters * stats.f.isf(chance, parameters, freedom)
    return float(min(stats.t.isf(single, freedom), together**0.5))


class _Obstacle(str):
    """Why potentials say nothing: samples show what these have no term for."""

    of_a_chain: bool

    def __new__(cls, examined: ExaminedFit) -> _Obstacle:
        found = super().__new__(cls, examined.obstacle)
        found.of_a_chain = examined.lack.of_a_chain
        return found


class _Waves:
    """The form of every arm of rigid links and revolute joints, with constants."""

    means = "waves"

    def __init__(self, examined: ExaminedFit) -> None:
        self.examined = examined
        n, samples = len(examined.fit.offsets), examined.fit.whitened
        self._q = _points(n)
        self.residual = np.zeros((len(samples.q), n))
        self.residual[:, samples.joints] = samples.torques(samples.residual)
        self.freedom = max(1.0, len(samples.q) - len(samples.root) / len(samples.joints))

    def errors(
        self, relation: SymmetryRelation, chance: float
    ) -> tuple[Array, Array, Array, Array, Array, Array]:
        fit, lack = self.examined.fit, self.examined.lack
        single = CandidateGroup(
            relation.basis, relation.A_sat[None], relation.d_sat[None], relation.Y[None]
        )
        allowed = self.examined.deviations
        beside, _ = claim_bounds(fit, lack, single, allowed)
        shown = fit.without_constants(lack.offset_joints)
        most, _ = torque_uncertainty(shown, single, allowed)
        most = most + (1.0 - relation.Y) * (np.abs(shown.offsets) + allowed * shown.offset_errors)
        deviations = _deviations(chance, relation.n, len(fit.whitened.root), fit.freedom)
        missed, error = self._missed(fit, relation)
        seen = least = np.abs(missed) - deviations * error
        for other in lack.alternatives:
            miss, more = self._missed(other.fit, relation)
            least = np.minimum(least, np.abs(miss) - deviations * more - 2.0 * other.size)
        at = least.argmax(axis=0)
        sizes = seen.max(axis=0), least.max(axis=0), most[0], beside[0]
        return np.abs(missed).max(axis=0), *sizes, self._q[at]

    def _missed(self, fit: FittedPotential, relation: SymmetryRelation) -> tuple[Array, Array]:
        """What a relation misses at the configurations, and its standard error, (POINTS, n)."""
        there = torque_features(fit.frequencies, relation.configuration(self._q))
        rows = there - relation.Y[:, None] * torque_features(fit.frequencies, self._q)
        flips = 1.0 - relation.Y
        missed = rows @ fit.coefficients + flips * fit.offsets
        error = np.linalg.norm(rows @ np.linalg.inv(fit.root), axis=2)
        return missed, error + flips * fit.offset_errors


class _Chain:
    """A rigid chain, with constants where they were fitted."""

    means = "a rigid chain"

    def __init__(self, learner: RigidChain) -> None:
        self._fit = fit = learner.fit_
        snapped = learner.snapped()
        self.residual = fit.samples.torque - fit.chain.torque(fit.samples.q)
        self.freedom = max(1.0, fit.degrees / fit.samples.n)
        self._bounds = RelationBounds(
            learner.fit_, learner.errors_, snapped, expanded(snapped.chain), learner.beside()
        )

    def errors(
        self, relation: SymmetryRelation, chance: float
    ) -> tuple[Array, Array, Array, Array, Array, Array]:
        fit = self._fit
        freedom = np.inf if fit.verdict is FitStatus.CHI_SQUARE else self.freedom
        deviations = _deviations(chance, relation.n, fit.information.rank, freedom)
        estimate, seen, least, where = self._bounds.violation(relation, deviations)
        constants = self._bounds.beside_gravity(relation)
        gravity, everything = self._bounds.of(relation)
        return estimate, seen, least, gravity + constants, everything + constants, where
