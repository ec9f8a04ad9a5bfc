"""A fitted potential held against a symmetry group: test, and joint refinement of d."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.relations.potential.pull_backs import PullBacks
from isotorque.learning.statistics.tails import tail_probability
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup, Ints

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GroupFit:
    """Best potential with exactly the symmetries of a group, and what the data say of it.

    Attributes
    ----------
    group : CandidateGroup
        With refined offsets.
    offset_errors : (G, r) array
        Standard errors of the offsets [rad].
    coefficients : (2 m,) array
        Of the symmetric potential, in the order of the fit's.
    p_value : float
        Probability of a misfit at least as large if the group is the true one.
    """

    group: CandidateGroup
    offset_errors: Array
    coefficients: Array
    p_value: float


def fit_group(fit: FittedPotential, group: CandidateGroup) -> GroupFit:
    """Restrict a fitted potential to the symmetries of a group.

    Parameters
    ----------
    fit : FittedPotential
    group : CandidateGroup
        Closed, offsets composing exactly (`CandidateGroup.composed`).

    Returns
    -------
    GroupFit

    Notes
    -----
    Potentials with the given symmetries are the image of the Reynolds average (docs/theory.md,
    "Primary symmetries: the complete list"). A finite group allows no other change of its offsets
    than a shift of the origin, d_i -> d_i - (I - A_i) x, since H^1(G, R^r) = 0. Coefficients in the
    image and x are fitted together to the unrestricted coefficients with their covariance
    (Gauss-Newton); the remaining misfit is chi-square distributed, or F where the noise level was
    estimated.
    """
    pull_backs = PullBacks(fit.frequencies, group)
    coordinates, average = pull_backs.coordinates, pull_backs.average()
    values, vectors = np.linalg.eigh((average + average.T) / 2)
    basis = vectors[:, values > 0.5]
    rank = group.d.shape[1]
    origin = np.zeros(rank)
    target = fit.root @ fit.coefficients
    for _ in range(20):
        shift = _rotation(coordinates @ origin)
        moved = fit.root @ (shift @ basis)
        weights = np.linalg.lstsq(moved, target, rcond=None)[0]
        symmetric = shift @ (basis @ weights)
        slope = fit.root @ _rotation_slope(symmetric, coordinates)
        jacobian = np.concatenate([moved, slope], axis=1)
        step = np.linalg.lstsq(jacobian, target - fit.root @ symmetric, rcond=1e-9)[0]
        change = np.clip(step[basis.shape[1] :], -0.2, 0.2)
        origin = origin + change
        if np.abs(change).max(initial=0.0) < 1e-14:
            break
    misfit = target - fit.root @ symmetric
    parameters = int(np.linalg.matrix_rank(jacobian, tol=1e-9 * np.linalg.norm(jacobian, 2)))
    statistic = float(misfit @ misfit)
    p_value = tail_probability(statistic, len(target) - parameters, fit.freedom)
    lever = np.eye(rank) - group.A
    offsets = wrap(group.d - lever @ origin)
    covariance = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-12)[basis.shape[1] :][
        :, basis.shape[1] :
    ]
    variance = np.einsum("gij,jk,gik->gi", lever, covariance, lever)
    refined = CandidateGroup(group.basis, group.A, offsets, group.Y)
    return GroupFit(refined, np.sqrt(np.maximum(variance, 0.0)), symmetric, p_value)


def torque_uncertainty(
    fit: FittedPotential, group: CandidateGroup, deviations: float
) -> tuple[Array, Array]:
    """How wrong each relation can be, as far as the unrestricted fit can tell.

    Parameters
    ----------
    fit : FittedPotential
    group : CandidateGroup
    deviations : float
        Number of standard errors added to every residual coefficient.

    Returns
    -------
    bound : (G, n) array
        Bound over all q on the torque error of each relation [N m].
    rms : (G, n) array
        Root mean square over all q of the same [N m].
    """
    pull_backs = PullBacks(fit.frequencies, group)
    m = len(fit.frequencies)
    inverse = np.linalg.inv(fit.root)
    size = np.abs(fit.frequencies).astype(float)
    bound = np.empty((len(group), size.shape[1]))
    rms = np.empty_like(bound)
    for i in range(len(group)):
        pulled = pull_backs.matrix(i)
        difference = np.eye(2 * m) - pulled
        residual = difference @ fit.coefficients
        error = np.linalg.norm(difference @ inverse, axis=1)
        limit = np.hypot(
            np.hypot(residual[:m], residual[m:]), deviations * np.hypot(error[:m], error[m:])
        )
        limit[~pulled[:m].any(axis=1)] *= 2.0  # both sides of the relation have the term alone
        bound[i] = limit @ size
        rms[i] = np.sqrt(0.5 * limit**2 @ size**2)
    return bound, rms


def _rotation(phase: Array) -> Array:
    """Matrix of C_k -> C_k exp(i phase_k) on (a, b)."""
    m = len(phase)
    c, s = np.diag(np.cos(phase)), np.diag(np.sin(phase))
    matrix = np.empty((2 * m, 2 * m))
    matrix[:m, :m], matrix[:m, m:] = c, s
    matrix[m:, :m], matrix[m:, m:] = -s, c
    return matrix


def _rotation_slope(coefficients: Array, coordinates: Ints) -> Array:
    """Derivative of (a, b) by the shift x of the origin, shape (2 m, r)."""
    m = len(coordinates)
    turned = np.concatenate([coefficients[m:], -coefficients[:m]])
    return turned[:, None] * np.concatenate([coordinates, coordinates])
