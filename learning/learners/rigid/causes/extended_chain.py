"""A rigid chain and causes beside it, fitted together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainDerivatives,
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import minimise
from isotorque.learning.learners.rigid.fitting.noise_estimate import (
    estimated_angle_noise,
    estimated_levels,
)
from isotorque.learning.learners.rigid.planning.information import Information
from isotorque.learning.statistics.causes.extension import ADDED, Shape, Term, added_torque

Array = NDArray[np.float64]

PASSES = 6
"""Times that columns which depend on the chain are computed anew, at most."""
SETTLED = 1e-4
"""Passes end when one changes the cost by a smaller share."""
LARGEST_SCALE, LARGEST_SAG, LARGEST_GAIN = 0.3, 0.3, 10.0
"""Causes beyond are no causes: relative error of angles, sag [rad, RMS], gain or its inverse."""
ENOUGH = 100
"""Samples from which the noise of angles is estimated, at most twice as many."""
COLUMNS_KEPT = 1e-5
"""Combinations of columns (of length 1) that count, relative to the largest singular value."""


@dataclass(frozen=True, eq=False)
class ExtendedChain:
    """A minimum of the squared errors of a chain with causes.

    Attributes
    ----------
    samples : ChainSamples
        What it was fitted to.
    directions : (m, n) array or None
        Signs of the last motion of every joint.
    terms : tuple of Term
        What there is beside the chain.
    chain : ChainParameters
        Without columns; with gains.
    values : dict of Term to (k,) array
        Unknowns of all terms but gains.
    cost : float
        Sum of squares of whitened torque errors.
    whitening : (m, n, n) array
        With which it was computed.
    nominal : (n,) array
        Gains that are no causes: those that are known.
    """

    samples: ChainSamples
    directions: Array | None
    terms: tuple[Term, ...]
    chain: ChainParameters
    values: dict[Term, Array]
    cost: float
    whitening: Array
    nominal: Array

    @cached_property
    def angles(self) -> Array:
        """Configurations (m, n) [rad] without what scale and compliance added to them."""
        return _angles(self.samples, self.values)

    @cached_property
    def slopes(self) -> ChainDerivatives:
        """Torques of the chain and their derivatives at the samples."""
        return self.chain.derivatives(self.angles, raw_directions(self.chain.n))

    def columns(self, terms: Sequence[Term]) -> Array:
        """Derivatives (m, n, k) of the measured torques by the unknowns of terms."""
        return _columns(terms, self.samples, self.directions, self.slopes, self.chain.gains)

    @cached_property
    def rows(self) -> Array:
        """Whitened derivatives (m n, p) by all unknowns, those of `terms` last."""
        own = np.concatenate([self.slopes.turned, self.slopes.leant], axis=2)
        every = np.concatenate([own, self.columns(self.terms)], axis=2)
        return (self.whitening @ every).reshape(self.samples.equations, -1)

    @cached_property
    def rest(self) -> Array:
        """Torques (m, n) [N m] that chain and causes leave."""
        torque = self.slopes.torque
        for term in self.terms:
            if term.shape in ADDED or term.shape is Shape.LOAD:
                torque = torque + self.columns([term]) @ self.values[term]
        return self.samples.torque - torque

    @cached_property
    def residual(self) -> Array:
        """What is left, whitened, (m n,)."""
        return np.einsum("kij,kj->ki", self.whitening, self.rest).ravel()

    @cached_property
    def basis(self) -> Array:
        """Orthonormal basis (m n, rank) of what the unknowns can explain."""
        size = np.linalg.norm(self.rows, axis=0)
        used = self.rows[:, size > 1e-7 * size.max(initial=0.0)]
        left, values, _ = np.linalg.svd(used / np.linalg.norm(used, axis=0), full_matrices=False)
        return np.asarray(left[:, values > COLUMNS_KEPT * values.max(initial=0.0)])

    @property
    def stiffness(self) -> Array:
        """Derivatives (m, n, n) of the torques by the angles [N m/rad]."""
        return self.slopes.stiffness

    def effect(self, terms: Sequence[Term]) -> Array:
        """Torques (m, n) [N m] that terms add."""
        result = np.zeros(self.samples.q.shape)
        for term in terms:
            if term.shape is Shape.GAIN:
                more = (self.chain.gains - self.nominal)[[term.place]]
            else:
                more = self.values[term]
            result += self.columns([term]) @ more
        return result

    @property
    def spare(self) -> int:
        """Degrees of freedom that are left."""
        return max(self.samples.equations - self.basis.shape[1], 1)

    def estimate(self, term: Term) -> tuple[Array, Array]:
        """Unknowns of one of the terms and their standard errors, as the whitening says.

        Those of a gain are relative to the nominal one.
        """
        first = 4 * self.chain.n
        for other in self.terms:
            width = _width(other, self.chain.n)
            if other == term:
                break
            first += width
        count = self.rows.shape[1]
        information = Information.of_rows(self.rows, np.ones(count, dtype=bool))
        error = np.sqrt(information.variance(np.eye(count)[first : first + width]))
        if term.shape is Shape.GAIN:
            nominal = self.nominal[[term.place]]
            return self.chain.gains[[term.place]] / nominal, error / np.abs(nominal)
        return self.values[term], error

    def plausible(self) -> bool:
        """Whether all causes are as small as causes are."""
        size = np.sqrt(np.mean(self.samples.torque**2, axis=0))
        gains = np.abs(self.chain.gains / self.nominal)
        for term in self.terms:
            gain = gains[term.place] if term.shape is Shape.GAIN else 1.0
            if not 1.0 / LARGEST_GAIN < gain < LARGEST_GAIN:  # 0: a sensor that does not read
                return False
            if term.shape is Shape.SCALE and abs(self.values[term][0]) > LARGEST_SCALE:
                return False
            sag = term.shape is Shape.COMPLIANCE
            if sag and abs(self.values[term][0]) * size[term.place] > LARGEST_SAG:
                return False
        return bool(np.isfinite(self.cost))

    def with_estimated_noise(self, angles_known: bool) -> ChainSamples:
        """The samples with the noise of torques, and of angles if not known, that is left."""
        samples = self.samples
        leverage = np.sum(self.basis**2, axis=1).reshape(samples.q.shape)
        if angles_known:
            levels = estimated_levels(samples, self.rest, leverage, self.slopes.stiffness)
            return samples.with_torque_noise(levels)
        exact = replace(samples, angle_noise=np.zeros(self.chain.n))
        levels = estimated_levels(exact, self.rest, leverage, self.slopes.stiffness)
        kept = np.maximum(1.0 - leverage.mean(axis=0), 1.0 / len(leverage))
        step = max(1, len(leverage) // ENOUGH)
        levels, angle = estimated_angle_noise(
            (self.rest / np.sqrt(kept))[::step], self.slopes.stiffness[::step], levels
        )
        return replace(samples, torque_noise=levels, angle_noise=np.full(self.chain.n, angle))


def fit_extended(
    samples: ChainSamples,
    directions: Array | None,
    terms: Sequence[Term],
    start: ChainParameters,
    whitening: Array,
    *,
    nominal: Array,
    near: ExtendedChain | None = None,
    iterations: int,
    progress: float,
) -> ExtendedChain:
    """Go from a start to a minimum.

    Parameters
    ----------
    samples : ChainSamples
        What is fitted.
    directions : (m, n) array or None
        Signs of the last motion of every joint.
    terms : sequence of Term
        What may be there beside the chain.
    start : ChainParameters
        Rotations and gains to start from.
    whitening : (m, n, n) array
        Of the torque errors.
    nominal : (n,) array
        Gains that are no causes.
    near : ExtendedChain, optional
        Causes to start from.
    iterations, progress
        As of `minimise`.

    Notes
    -----
    Terms that add to the torque are linear and eliminated with the levers. Errors of angles and
    loads are linear in the neighbourhood of a chain: their columns are computed anew until the
    cost settles.
    """
    terms = tuple(terms)
    n = start.n
    curved = [t for t in terms if t.shape in (Shape.SCALE, Shape.COMPLIANCE, Shape.LOAD)]
    linear = [t for t in terms if t.shape in ADDED]
    free = np.zeros(n, dtype=bool)
    free[[t.place for t in terms if t.shape is Shape.GAIN]] = True
    values = {} if near is None else {t: v for t, v in near.values.items() if t in curved}
    values = {t: values.get(t, np.zeros(_width(t, n))) for t in curved}
    chain, cost = replace(start, columns=(), coefficients=np.zeros(0)), np.inf
    known = bool(chain.levers.any())  # without levers no torque depends on angles
    for _ in range(PASSES if curved else 1):
        angles = _angles(samples, values)
        slopes = chain.derivatives(angles, raw_directions(n)) if curved and known else None
        used = linear + (curved if slopes is not None else [])
        extra = _columns(used, samples, directions, slopes, chain.gains)
        found = minimise(
            replace(samples, q=angles),
            chain,
            free,
            whitening,
            extra=extra,
            iterations=iterations,
            progress=progress,
            enough=0.0,
        )
        first = 0
        for term in used:
            width = _width(term, n)
            step = found.chain.coefficients[first : first + width]
            again = term.shape in (Shape.SCALE, Shape.COMPLIANCE)
            values[term] = values[term] + step if again else step
            first += width
        chain = replace(found.chain, coefficients=np.zeros(0))
        settled = abs(cost - found.cost) <= SETTLED * found.cost
        cost, known = found.cost, True
        if settled or not np.isfinite(cost):
            break
    return ExtendedChain(samples, directions, terms, chain, values, cost, whitening, nominal)


def _width(term: Term, joints: int) -> int:
    """Number of unknowns of a term."""
    return 2 * joints if term.shape is Shape.LOAD else 1


def _angles(samples: ChainSamples, values: dict[Term, Array]) -> Array:
    """Angles without the errors that terms put into them."""
    q = samples.q.copy()
    for term, value in values.items():
        if term.shape is Shape.SCALE:
            q[:, term.place] += value[0] * samples.q[:, term.place]
        elif term.shape is Shape.COMPLIANCE:
            q[:, term.place] -= value[0] * samples.torque[:, term.place]
    return q


def _columns(
    terms: Sequence[Term],
    samples: ChainSamples,
    directions: Array | None,
    slopes: ChainDerivatives | None,
    gains: Array,
) -> Array:
    """Derivatives (m, n, k) of the measured torques by the unknowns of terms."""
    m, n = samples.q.shape
    result = np.zeros((m, n, sum(_width(term, n) for term in terms)))
    c = 0
    for term in terms:
        j = term.place
        if term.shape in ADDED:
            result[:, j, c] = added_torque(term, samples.q, directions)
        else:
            assert slopes is not None
            if term.shape is Shape.GAIN:
                result[:, j, c] = slopes.gained[:, j, j]
            elif term.shape is Shape.SCALE:
                result[:, :, c] = slopes.stiffness[:, :, j] * samples.q[:, [j]]
            elif term.shape is Shape.COMPLIANCE:
                result[:, :, c] = -slopes.stiffness[:, :, j] * samples.torque[:, [j]]
            else:
                result[j:, :, c : c + 2 * n] = slopes.leant[j:]
        c += _width(term, n)
    return result
