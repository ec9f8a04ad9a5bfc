"""The symmetry group of a fitted chain, and how far each relation can be off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.planning.standard_errors import TorqueErrors
from isotorque.learning.learners.rigid.structure.expansion import expanded
from isotorque.learning.learners.rigid.structure.snapping import SnappedChain
from isotorque.learning.statistics.constant_torques import OR_FRICTION
from isotorque.symbolic.common.single_thread import single_thread
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
        what was snapped, levers set to zero among it.
    corrections : (order, n) array
        c of each relation of the measured torque, ``tau' = Y tau + c`` [N m]: twice the offset of
        the sensor where the torque changes sign.
    snapped : SnappedChain
        The chain that the group belongs to.
    alternatives : tuple of SymmetryGroup
        With a tolerance: the other maximal groups.
    """

    group: SymmetryGroup
    corrections: Array
    snapped: SnappedChain
    alternatives: tuple[SymmetryGroup, ...] = ()

    @property
    def statement(self) -> str:
        """What is claimed, in words."""
        count = len(self.snapped.hypotheses)
        if not count:
            return "true of the fitted chain; nothing was snapped" + self._object
        text = (
            "true of the snapped chain, which the data do not contradict, "
            f"p = {self.snapped.p_value:.2g} ({count} hypotheses)"
        )
        lever = self.snapped.smallest_visible_lever
        if np.isfinite(lever) and lever > 0:
            text += f"; smallest lever that would have been seen everywhere: {lever:.2g} N m"
        return text + self._object

    @property
    def _object(self) -> str:
        """What the relations speak of, where that is not the measured torque."""
        if not self.corrections.any():
            return ""
        sizes = ", ".join(f"{x:.3g}" for x in np.abs(self.corrections).max(axis=0) / 2.0)
        return (
            f"; joints have constant torques of at most ({sizes}) N m beside gravity{OR_FRICTION}; "
            "relations that change their sign hold of gravity, of the measured torque with "
            "corrections"
        )


@single_thread()
def chain_symmetries(
    fit: ChainFit, errors: TorqueErrors, snapped: SnappedChain, tolerance: float = 0.0
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
    tolerance : float
        Also relations that err by no more in any torque of the snapped chain [N m].

    Notes
    -----
    The error ``g(A q + d) - Y g(q)`` of a relation is bounded in two parts. That of the snapped
    chain has a proved bound (zero without a tolerance). What the chain as it was fitted, nothing
    snapped, has beside that is taken at many configurations, three of its standard errors are
    added point by point, and the largest counts. Standard errors come from derivatives and from
    repeated experiments, as those of torques (`TorqueErrors`).
    """
    potential = expanded(snapped.chain)
    if tolerance > 0:
        groups = maximal_groups(potential, tolerance)
    else:
        groups = [exact_symmetries(potential)]
    offsets = fit.chain.offsets
    bounded = [_bounded(group, fit, errors, snapped, potential) for group in groups]
    corrections = np.array([offsets - r.Y * offsets for r in bounded[0]])
    return ChainSymmetries(bounded[0], corrections, snapped, tuple(bounded[1:]))


def _bounded(
    group: SymmetryGroup,
    fit: ChainFit,
    errors: TorqueErrors,
    snapped: SnappedChain,
    potential: TrigonometricPolynomial,
) -> SymmetryGroup:
    bounds = _bounds(group, fit, errors, snapped, potential)
    return SymmetryGroup(
        [
            SymmetryRelation(r.A, r.unwrapped_d, r.Y, r.basis, r.is_identity, bound)
            for r, bound in zip(group, bounds, strict=True)
        ]
    )


def _bounds(
    group: SymmetryGroup,
    fit: ChainFit,
    errors: TorqueErrors,
    snapped: SnappedChain,
    potential: TrigonometricPolynomial,
) -> Iterator[Array]:
    n = group.n
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (POINTS, n))
    here = _Evaluated(fit, errors.replicas, q)
    special = snapped.chain
    torque, offsets = special.torque(q), fit.chain.offsets - special.offsets
    floor = FLOOR * max(float(np.abs(here.torque).max()), fit.samples.largest_torque)
    for relation in group:
        if relation.is_identity:
            yield np.zeros(n)
            continue
        there = _Evaluated(fit, errors.replicas, relation.configuration(q))
        Y = relation.Y
        proved = residual_bound(potential, relation.A, relation.unwrapped_d, Y)
        moved = there.torque - special.torque(relation.configuration(q))
        fitted = moved - Y * (here.torque - torque) - (offsets - Y * offsets)
        linear = np.linalg.norm(there.slopes - Y[:, None] * here.slopes, axis=2) * fit.spread
        error = linear
        if len(here.replicas):
            changed = there.replicas - there.torque - Y * (here.replicas - here.torque)
            error = np.maximum(linear, fit.spread * np.sqrt(np.mean(changed**2, axis=0)))
        measured = (np.abs(fitted) + DEVIATIONS * error).max(axis=0)
        yield np.maximum(np.abs(special.gains) * proved + measured, floor)


class _Evaluated:
    """Torques, their derivatives times the square root of the covariance, and the replicas'."""

    def __init__(self, fit: ChainFit, replicas: list[ChainParameters], q: Array) -> None:
        slopes = fit.chain.derivatives(q, raw_directions(fit.chain.n))
        self.torque = slopes.torque
        information = fit.information
        self.slopes = slopes.by_parameters()[:, :, information.free] @ information.factor
        self.replicas = np.array([chain.torque(q) for chain in replicas])
