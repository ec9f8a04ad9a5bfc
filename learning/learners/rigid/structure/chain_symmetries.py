"""The symmetry group of a fitted chain, and how far each relation can be off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
    torques_of,
)
from isotorque.learning.learners.rigid.planning.standard_errors import TorqueErrors
from isotorque.learning.learners.rigid.structure.beside_chain import BesideChain
from isotorque.learning.learners.rigid.structure.expansion import expanded
from isotorque.learning.learners.rigid.structure.snapping import SnappedChain
from isotorque.learning.statistics.causes.cause_words import OR_FRICTION
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.exact_symmetries import exact_symmetries
from isotorque.symbolic.symmetries.residual_bound import residual_bound

Array = NDArray[np.float64]

DEVIATIONS = 3.0
"""Bounds hold at so many standard errors."""
POINTS = 400
"""Configurations at which the largest error is looked for."""
FLOOR = 1e-9
"""Least bound, relative to the largest torque: rounding."""


@dataclass(frozen=True, eq=False)
class ChainSymmetries:
    """Symmetries of the snapped chain, with bounds for the arm that was measured.

    Attributes
    ----------
    group : SymmetryGroup
        Exact for the snapped chain (nearly exact, where a tolerance was given). ``bound`` of
        each relation [N m] holds for the measured arm at three standard errors: it contains
        what was snapped, levers set to zero among it, and constant torques, springs and cables
        as large as the samples leave room for.
    gravity_bounds : (order, n) array
        The same of gravity alone, if the arm is a rigid chain [N m].
    shown : str
        What the samples show beside the chain: where they do, its relations are not to be claimed.
    correction : Correction or None
        Constants and springs of the joints, which are no gravity: relations of the measured torque
        hold with it, ``tau' - c(q') = Y (tau - c(q))``; with springs, bounds are those of angles
        within half a turn of zero. None where the chain has none.
    snapped : SnappedChain
        The chain that the group belongs to.
    alternatives : tuple of SymmetryGroup
        With a tolerance: the other maximal groups.
    """

    group: SymmetryGroup
    gravity_bounds: Array
    shown: str
    correction: Correction | None
    snapped: SnappedChain
    alternatives: tuple[SymmetryGroup, ...] = ()

    @property
    def statement(self) -> str:
        """What is claimed, in words."""
        count = len(self.snapped.hypotheses)
        if not count:
            return "true of the fitted chain; nothing was snapped" + self._object + self._beside
        text = (
            "true of the snapped chain, which the data do not contradict, "
            f"p = {self.snapped.p_value:.2g} ({count} hypotheses)"
        )
        lever = self.snapped.smallest_visible_lever
        if np.isfinite(lever) and lever > 0:
            text += f"; smallest lever that would have been seen everywhere: {lever:.2g} N m"
        return text + self._object + self._beside

    @property
    def _beside(self) -> str:
        """What the samples show beside the chain."""
        if not self.shown:
            return ""
        return f"; but the samples show {self.shown}: of gravity alone they may be true"

    @property
    def _object(self) -> str:
        """What the relations speak of, where that is not the measured torque."""
        if self.correction is None:
            return ""
        sizes = ", ".join(f"{x:.3g}" for x in self.correction.constant)
        springs = ""
        if self.correction.rate.any():
            rates = ", ".join(f"{x:.3g}" for x in self.correction.rate)
            springs = f", and springs of ({rates}) N m/rad"
        return (
            f"; joints have constant torques of ({sizes}) N m beside gravity{OR_FRICTION}"
            f"{springs}; "
            "relations that change their sign hold of gravity, of the measured torque with "
            "corrections"
        )


@single_thread()
def chain_symmetries(
    fit: ChainFit,
    errors: TorqueErrors,
    snapped: SnappedChain,
    beside: BesideChain,
    shown: str,
    tolerance: float = 0.0,
) -> ChainSymmetries:
    """Derive the group of the snapped chain; bound its relations for the measured arm.

    Parameters
    ----------
    fit : ChainFit
        An accepted fit.
    errors : TorqueErrors
        Of the same fit.
    snapped : SnappedChain
        Of the same fit.
    beside : BesideChain
        Of the same fit, at `DEVIATIONS`.
    shown : str
        What the samples show beside the chain, in words; empty where nothing.
    tolerance : float
        Also relations that err by no more in any torque of the snapped chain [N m].

    Notes
    -----
    The error ``g(A q + d) - Y g(q)`` of a relation is bounded in two parts. That of the snapped
    chain has a proved bound (zero without a tolerance). What the chain as it was fitted, nothing
    snapped, has beside that is taken at many configurations, three of its standard errors are
    added point by point, and the largest counts. Standard errors come from derivatives and from
    repeated experiments, as those of torques (`TorqueErrors`). The same with every kind of torque
    beside the chain that samples do not exclude (`beside_chain`), the chain changed as far as it
    has taken part of it for gravity: the largest is the bound of the measured torque.
    """
    potential = expanded(snapped.chain)
    if tolerance > 0:
        groups = maximal_groups(potential, tolerance)
    else:
        groups = [exact_symmetries(potential)]
    bounds = RelationBounds(fit, errors, snapped, potential, beside)
    bounded, gravity = [], []
    for group in groups:
        both = [bounds.of(relation) for relation in group]
        gravity.append(np.array([of_gravity for of_gravity, _ in both]))
        bounded.append(
            SymmetryGroup(
                [
                    SymmetryRelation(r.A, r.unwrapped_d, r.Y, r.basis, r.is_identity, bound)
                    for r, (_, bound) in zip(group, both, strict=True)
                ]
            )
        )
    correction = fit.chain.correction
    shown_beside = correction if correction.constant.any() or correction.rate.any() else None
    return ChainSymmetries(bounded[0], gravity[0], shown, shown_beside, snapped, tuple(bounded[1:]))


class RelationBounds:
    """Bounds of relations of one chain, at the same configurations each.

    Parameters
    ----------
    fit, errors, snapped, beside
        As of `chain_symmetries`.
    potential : TrigonometricPolynomial
        Of the snapped chain.
    """

    def __init__(
        self,
        fit: ChainFit,
        errors: TorqueErrors,
        snapped: SnappedChain,
        potential: TrigonometricPolynomial,
        beside: BesideChain,
    ) -> None:
        self._fit, self._errors, self._beside = fit, errors, beside
        self._special, self._potential = snapped.chain, potential
        n = fit.chain.n
        self._q = np.random.default_rng(0).uniform(-np.pi, np.pi, (POINTS, n))
        self._here = _Evaluated(fit, errors.replicas, self._q)
        self._torque = self._special.torque(self._q)
        mine, other = fit.chain.correction, self._special.correction
        self._changed = Correction(mine.constant - other.constant, mine.rate - other.rate)
        largest = float(np.abs(self._here.torque).max())
        self._floor = FLOOR * max(largest, fit.samples.largest_torque)
        self._roots = [term.root for term in beside.terms]

    def violation(
        self, relation: SymmetryRelation, deviations: float
    ) -> tuple[Array, Array, Array, Array]:
        """How far the measured torque misses ``tau' = Y tau``, any relation.

        Parameters
        ----------
        relation
            Need be none of the chain's; its correction is not looked at.
        deviations
            Standard errors that are taken off.

        Returns
        -------
        estimate, seen, least : (n,) arrays
            Largest error of each joint at the configurations looked at [N m]: as fitted, so many
            standard errors less, and what else the samples leave room for less.
        where : (n, n) array
            Configuration of the latter, one row per joint [rad].
        """
        fit, here, Y = self._fit, self._here, relation.Y
        there = _Evaluated(fit, self._errors.replicas, relation.configuration(self._q))
        missed = there.torque - Y * here.torque
        slopes = there.slopes - Y[:, None] * here.slopes
        error = deviations / DEVIATIONS * self._error(there, slopes, Y)
        seen = least = np.abs(missed) - error - self._floor
        for term, more in zip(self._beside.terms, _sizes(slopes, self._roots), strict=True):
            size = np.abs(missed + slopes @ term.change) - np.hypot(error, more)
            least = np.minimum(least, size - term.missed(relation))
        at = least.argmax(axis=0)
        return np.abs(missed).max(axis=0), seen.max(axis=0), least.max(axis=0), self._q[at]

    def beside_gravity(self, relation: SymmetryRelation) -> Array:
        """How far the measured torque misses a relation by constants and springs, (n,) [N m]."""
        found = self._fit.chain.correction
        missed = found.at(relation.configuration(self._q)) - relation.Y * found.at(self._q)
        return np.asarray(np.abs(missed).max(axis=0))

    def _error(self, there: _Evaluated, slopes: Array, Y: Array) -> Array:
        """Standard errors of what relations miss, times `DEVIATIONS`."""
        fit, here = self._fit, self._here
        error = np.sqrt(np.einsum("kij,kij->ki", slopes, slopes))
        if len(here.changes):
            changed = there.changes - Y * here.changes
            repeated = np.einsum("rki,rki->ki", changed, changed) / len(changed)
            error = np.maximum(error, np.sqrt(repeated))
        return np.asarray(DEVIATIONS * fit.spread * error)

    def of(self, relation: SymmetryRelation) -> tuple[Array, Array]:
        """Of gravity alone, and of the measured torque, (n,) [N m] each."""
        fit, here, Y = self._fit, self._here, relation.Y
        if relation.is_identity:
            return np.zeros(relation.n), np.zeros(relation.n)
        image = relation.configuration(self._q)
        there = _Evaluated(fit, self._errors.replicas, image)
        proved = residual_bound(self._potential, relation.A, relation.unwrapped_d, Y)
        moved = there.torque - self._special.torque(image)
        fitted = moved - Y * (here.torque - self._torque)
        fitted = fitted - (self._changed.at(image) - Y * self._changed.at(self._q))
        slopes = there.slopes - Y[:, None] * here.slopes
        error = self._error(there, slopes, Y)
        least = np.abs(self._special.gains) * proved
        gravity = np.maximum(least + (np.abs(fitted) + error).max(axis=0), self._floor)
        bound = gravity
        for term, more in zip(self._beside.terms, _sizes(slopes, self._roots), strict=True):
            size = np.abs(fitted + slopes @ term.change) + np.hypot(error, more)
            bound = np.maximum(bound, least + size.max(axis=0) + term.missed(relation))
        return gravity, bound


class _Evaluated:
    """Torques, their derivatives times the square root of the covariance, changes of replicas."""

    def __init__(self, fit: ChainFit, replicas: list[ChainParameters], q: Array) -> None:
        slopes = fit.chain.derivatives(q, raw_directions(fit.chain.n))
        self.torque = slopes.torque
        information = fit.information
        free = slopes.by_parameters()[:, :, information.free]
        self.slopes = _times(free, information.factor)
        self.changes = torques_of(replicas, q) - self.torque if replicas else np.empty(0)


def _times(slopes: Array, matrix: Array) -> Array:
    """Derivatives (m, n, p) times a matrix (p, r), as one product of large matrices."""
    m, n, p = slopes.shape
    return (slopes.reshape(m * n, p) @ matrix).reshape(m, n, -1)


def _sizes(slopes: Array, roots: list[Array]) -> list[Array]:
    """Norms (m, n) of derivatives (m, n, p) times each root (p, r)."""
    if not roots:
        return []
    products = _times(slopes, np.concatenate(roots, axis=1))
    ends = np.cumsum([root.shape[1] for root in roots])[:-1]
    parts = np.split(products, ends, axis=2)
    return [np.sqrt(np.einsum("kij,kij->ki", part, part)) for part in parts]
