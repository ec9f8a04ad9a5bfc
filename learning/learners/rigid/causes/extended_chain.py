"""A rigid chain and causes beside it, fitted together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import minimise
from isotorque.learning.statistics.causes.extended_fit import (
    ExtendedFit,
    Slopes,
    cause_columns,
    width,
)
from isotorque.learning.statistics.causes.extension import ADDED, Shape, Term
from isotorque.learning.statistics.noise_levels import estimated_levels, noise_left

Array = NDArray[np.float64]

PASSES = 6
"""Times that columns which depend on the chain are computed anew, at most."""
SETTLED = 1e-4
"""Passes end when one changes the cost by a smaller share."""


@dataclass(frozen=True, eq=False)
class ExtendedChain(ExtendedFit):
    """A minimum of the squared errors of a chain with causes.

    Attributes
    ----------
    samples : ChainSamples
        What it was fitted to.
    chain : ChainParameters
        Without columns; with gains.
    """

    samples: ChainSamples
    chain: ChainParameters

    @property
    def q(self) -> Array:
        """Configurations (m, n) as measured [rad]."""
        return self.samples.q

    @property
    def torque(self) -> Array:
        """Torques (m, n) [N m]."""
        return self.samples.torque

    @property
    def gains(self) -> Array:
        """Measured over true torques, (n,)."""
        return self.chain.gains

    @cached_property
    def slopes(self) -> Slopes:
        """Torques of the chain and their derivatives at the samples."""
        return _slopes(self.chain, _angles(self.samples, self.values))

    def with_estimated_noise(self, angles_known: bool) -> ChainSamples:
        """The samples with the noise of torques, and of angles if not known, that is left."""
        samples = self.samples
        leverage = np.sum(self.basis**2, axis=1).reshape(samples.q.shape)
        if angles_known:
            leaning = self.stiffness * samples.angle_noise
            levels = estimated_levels(self.rest, leverage, samples.weights, leaning)
            return samples.with_torque_noise(levels)
        levels, angle = noise_left(self.rest, leverage, samples.weights, self.stiffness)
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
    values = {t: values.get(t, np.zeros(width(t, 2 * n))) for t in curved}
    chain, cost = replace(start, columns=(), coefficients=np.zeros(0)), np.inf
    known = bool(chain.levers.any())  # without levers no torque depends on angles
    for _ in range(PASSES if curved else 1):
        angles = _angles(samples, values)
        slopes = _slopes(chain, angles) if curved and known else None
        used = linear + (curved if slopes is not None else [])
        extra = cause_columns(used, samples.q, samples.torque, directions, slopes)
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
            count = width(term, 2 * n)
            step = found.chain.coefficients[first : first + count]
            again = term.shape in (Shape.SCALE, Shape.COMPLIANCE)
            values[term] = values[term] + step if again else step
            first += count
        chain = replace(found.chain, coefficients=np.zeros(0))
        settled = abs(cost - found.cost) <= SETTLED * found.cost
        cost, known = found.cost, True
        if settled or not np.isfinite(cost):
            break
    return ExtendedChain(directions, terms, values, nominal, cost, whitening, samples, chain)


def _angles(samples: ChainSamples, values: dict[Term, Array]) -> Array:
    """Angles without the errors that terms put into them."""
    q = samples.q.copy()
    for term, value in values.items():
        if term.shape is Shape.SCALE:
            q[:, term.place] += value[0] * samples.q[:, term.place]
        elif term.shape is Shape.COMPLIANCE:
            q[:, term.place] -= value[0] * samples.torque[:, term.place]
    return q


def _slopes(chain: ChainParameters, angles: Array) -> Slopes:
    """Torques of a chain and their derivatives at angles (m, n) [rad]."""
    found = chain.derivatives(angles, raw_directions(chain.n))
    own = np.concatenate([found.turned, found.leant], axis=2)
    gained = np.diagonal(found.gained, axis1=1, axis2=2)
    return Slopes(found.torque, own, gained, found.stiffness, found.leant)
