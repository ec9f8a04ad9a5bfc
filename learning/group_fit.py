"""A fitted potential held against a symmetry group: test, and joint refinement of d."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from learning.potential_fit import FittedPotential, Frequencies, tail_probability
from symbolic.relations import wrap

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_OFFSET = 0.3
"""Offsets of one A and Y that differ by less [rad] are estimates of one offset."""


@dataclass(frozen=True, eq=False)
class CandidateGroup:
    """Relations y -> A y + d in y = B q coordinates that may form a group.

    Attributes
    ----------
    basis : (r, n) int array
        B.
    A : (G, r, r) array
        Linear parts.
    d : (G, r) array
        Offsets [rad], exact or estimated.
    Y : (G, n) array
        Torque signs.
    """

    basis: Ints
    A: Array
    d: Array
    Y: Array

    def __len__(self) -> int:
        """Order."""
        return len(self.Y)

    def take(self, keep: NDArray[np.bool_] | NDArray[np.intp]) -> CandidateGroup:
        """Some of the relations."""
        return CandidateGroup(self.basis, self.A[keep], self.d[keep], self.Y[keep])

    def is_identity(self) -> NDArray[np.bool_]:
        """Which of the relations are the identity, shape (G,)."""
        near = np.abs(wrap(self.d)).max(axis=1, initial=0.0) < SAME_OFFSET
        linear = (np.abs(self.A - np.eye(self.d.shape[1])) < 1e-6).all(axis=(1, 2))
        return near & linear & (self.Y == 1.0).all(axis=1)

    def products(self, tolerance: float = SAME_OFFSET) -> tuple[NDArray[np.intp], Array]:
        """Multiplication table (G, G), -1 where a product is missing, and its defects.

        The defect of (i, j), shape (G, G, r), is A_i d_j + d_i - d_ij [rad]: how far the estimated
        offsets miss the composition law.
        """
        A = np.einsum("gij,hjk->ghik", self.A, self.A)
        d = np.einsum("gij,hj->ghi", self.A, self.d) + self.d[:, None]
        Y = self.Y[:, None] * self.Y[None]
        table = np.full((len(self), len(self)), -1, dtype=np.intp)
        defects = np.zeros(d.shape)
        nearest = np.full(table.shape, tolerance)
        for index in range(len(self)):
            defect = wrap(d - self.d[index])
            size = np.abs(defect).max(axis=-1, initial=0.0)
            match = (self.Y[index] == Y).all(axis=-1) & (size < nearest)
            match &= (np.abs(A - self.A[index]) < 1e-6).all(axis=(-2, -1))
            table[match], nearest[match] = index, size[match]
            defects[match] = defect[match]
        return table, defects

    def composed(self, tolerance: float = SAME_OFFSET) -> CandidateGroup | None:
        """Same relations with offsets that obey the composition law, or None if not closed.

        `tolerance` is how far the given offsets may miss it [rad].

        Notes
        -----
        The defects c(i, j) are a 2-cocycle; d_i - mean over j of c(i, j) composes exactly. Small
        errors of the offsets are averaged over the group, which is the joint refinement under
        d_ij = A_i d_j + d_i.
        """
        table, defects = self.products(tolerance)
        if (table < 0).any():
            return None
        return CandidateGroup(self.basis, self.A, wrap(self.d - defects.mean(axis=1)), self.Y)


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
    Potentials with the given symmetries are the image of the Reynolds average (theory.md, section
    2). A finite group allows no other change of its offsets than a shift of the origin,
    d_i -> d_i - (I - A_i) x, since H^1(G, R^r) = 0. Coefficients in the image and x are fitted
    together to the unrestricted coefficients with their covariance (Gauss-Newton); the remaining
    misfit is chi-square distributed, or F where the noise level was estimated.
    """
    coordinates, inside = _coordinates(fit.frequencies, group.basis)
    average = _reynolds(fit.frequencies, coordinates, inside, group)
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
    coordinates, inside = _coordinates(fit.frequencies, group.basis)
    m = len(fit.frequencies)
    inverse = np.linalg.inv(fit.root)
    size = np.abs(fit.frequencies).astype(float)
    bound = np.empty((len(group), size.shape[1]))
    rms = np.empty_like(bound)
    for i in range(len(group)):
        pulled = _pull_back(fit.frequencies, coordinates, inside, group, i)
        difference = np.eye(2 * m) - pulled
        residual = difference @ fit.coefficients
        error = np.linalg.norm(difference @ inverse, axis=1)
        limit = np.hypot(
            np.hypot(residual[:m], residual[m:]), deviations * np.hypot(error[:m], error[m:])
        )
        bound[i] = limit @ size
        rms[i] = np.sqrt(0.5 * limit**2 @ size**2)
    return bound, rms


def _coordinates(frequencies: Frequencies, basis: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """Coordinates c with k = c B, and for which frequencies they exist."""
    rows = basis.astype(float)
    raw = frequencies @ np.linalg.pinv(rows) if len(rows) else np.zeros((len(frequencies), 0))
    coordinates = np.round(raw).astype(np.int64)
    inside = (coordinates @ basis == frequencies).all(axis=1)
    coordinates[~inside] = 0
    return coordinates, inside


def _pull_back(
    frequencies: Frequencies,
    coordinates: Ints,
    inside: NDArray[np.bool_],
    group: CandidateGroup,
    i: int,
) -> Array:
    """Matrix of C_k -> s_k exp(-i k.d) C_{s_k Y k} on (a, b); zero where k has no image.

    A potential with the symmetry is a fixed point.
    """
    m = len(frequencies)
    place = {k.tobytes(): j for j, k in enumerate(np.ascontiguousarray(frequencies))}
    target = coordinates @ group.A[i] @ group.basis
    flipped = frequencies * group.Y[i].astype(np.int64)
    matrix = np.zeros((2 * m, 2 * m))
    phase = coordinates @ group.d[i]
    for row in np.flatnonzero(inside):
        if np.abs(target[row] - flipped[row]).max() < 1e-6:
            s = 1
        elif np.abs(target[row] + flipped[row]).max() < 1e-6:
            s = -1
        else:
            continue
        k = s * flipped[row]
        column, mirror = place.get(k.tobytes()), 1
        if column is None:
            column, mirror = place.get((-k).tobytes()), -1
        if column is None:
            continue
        cosine, sine = s * np.cos(phase[row]), s * np.sin(phase[row])
        matrix[row, column], matrix[row, m + column] = cosine, -mirror * sine
        matrix[m + row, column], matrix[m + row, m + column] = sine, mirror * cosine
    return matrix


def _reynolds(
    frequencies: Frequencies,
    coordinates: Ints,
    inside: NDArray[np.bool_],
    group: CandidateGroup,
) -> Array:
    """Average of the pull-backs: projector onto potentials with all symmetries of the group."""
    m = len(frequencies)
    total = np.zeros((2 * m, 2 * m))
    alive = np.ones(2 * m, dtype=bool)
    for i in range(len(group)):
        pulled = _pull_back(frequencies, coordinates, inside, group, i)
        alive &= pulled.any(axis=1)
        total += pulled
    total[~alive] = 0.0
    return total / len(group)


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
