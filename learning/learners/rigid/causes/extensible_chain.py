"""Rigid chains as models that causes can be added to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from isotorque.learning.learners.rigid.causes.extended_chain import ExtendedChain, fit_extended
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.statistics.causes.extension import Extension, Kind, Shape, Term

Array = NDArray[np.float64]

STARTS = 20
"""Random starts of the chain alone, unless chi-square accepts one: two starts of five end in a
false minimum on a seven-joint arm, the same ones again and again."""
ACCEPTED = 0.05
"""A misfit as likely as this ends them."""
REWEIGHTINGS = 3
QUICK, THOROUGH = (15, 1e-6), (150, 1e-8)
"""Iterations and progress of fits to candidates, and of those that count."""
FRESH = 60
"""Iterations from a random start."""
SEARCHED = 80
"""Random starts fit no more poses, evenly taken; the best is then fitted to all."""
AGAIN = 3
"""Random starts with noise levels brought up to date."""
KINDS = (
    Kind.OFFSET,
    Kind.GAIN,
    Kind.SPRING,
    Kind.FRICTION,
    Kind.CABLE,
    Kind.SCALE,
    Kind.COMPLIANCE,
    Kind.PAYLOAD,
)


@dataclass(frozen=True, eq=False)
class ExtensibleChain:
    """Chains that explain samples, with causes.

    Attributes
    ----------
    samples : ChainSamples
        With noise levels, stated or estimated.
    family : ChainModel
        Parents of the joints and gains that are no causes.
    directions : (m, n) array or None
        Signs of the last motion of every joint.
    noise_known, angles_known : bool
        Whether the noise of torques, of angles, was stated.
    rng : numpy.random.Generator
        Of the random starts.
    """

    samples: ChainSamples
    family: ChainModel
    directions: Array | None
    noise_known: bool
    angles_known: bool
    rng: np.random.Generator
    kinds: tuple[Kind, ...] = KINDS

    @property
    def q(self) -> Array:
        """Configurations (m, n) [rad]."""
        return self.samples.q

    @property
    def torque(self) -> Array:
        """Torques (m, n) [N m]."""
        return self.samples.torque

    @property
    def noise(self) -> Array:
        """Standard deviation of the torque errors (n,) [N m]."""
        return np.maximum(self.samples.torque_noise, self.samples.floor)

    def alone(
        self,
        known: Sequence[ChainParameters] = (),
        terms: Sequence[Term] = (),
        starts: int = STARTS,
    ) -> ExtendedChain:
        """The best chain without causes that are to be found.

        Parameters
        ----------
        known : sequence of ChainParameters
            Where to start from first.
        terms : sequence of Term
            What it contains anyway.
        starts : int
            Random starts at most.
        """
        part = self._thinned()
        best: ExtendedChain | None = None
        spare = max(part.samples.equations - 4 * self.family.n + 1, 1)
        accepted = stats.chi2.isf(ACCEPTED, spare)
        for i in range(len(known) + starts):
            start = known[i] if i < len(known) else self.family.random_start(self.rng)
            found = part._from(start, terms)
            if np.isfinite(found.cost) and (best is None or found.cost < best.cost):
                best = found
            enough = self.noise_known and best is not None and best.cost < accepted
            if enough and i >= len(known):
                break
        assert best is not None
        return self.refitted(terms, best, thorough=True)

    def refitted(
        self, terms: Sequence[Term], near: ExtendedChain, *, thorough: bool = False
    ) -> ExtendedChain:
        """The minimum with these terms that lies near another."""
        free = [term.place for term in terms if term.shape is Shape.GAIN]
        gains = self.family.gains.copy()
        gains[free] = near.chain.gains[free]
        start = replace(near.chain, gains=gains)
        whitening = self.samples.whitening(near.chain if self.samples.angle_noise.any() else None)
        return self._fitted(terms, start, whitening, near, THOROUGH if thorough else QUICK)

    def others(
        self, extension: Extension, terms: Sequence[Term], count: int
    ) -> list[ExtendedChain]:
        """The best minimum of random starts; half of those of a gain change its sign."""
        if any(term.shape is Shape.LOAD for term in terms):
            return []  # it counts samples, and parts of them have other numbers
        part = self._thinned()
        found = []
        for i in range(count):
            start = self.family.random_start(self.rng)
            if extension.kind is Kind.GAIN and extension.joint is not None and i % 2 == 0:
                start.gains[extension.joint] *= -1.0
            found.append(part._from(start, terms))
        finite = [fit for fit in found if np.isfinite(fit.cost) and fit.plausible()]
        if not finite:
            return []
        best = min(finite, key=lambda fit: fit.cost)
        return [best if part is self else self.refitted(terms, best)]

    def reweighted(self, fitted: ExtendedChain) -> Self:
        """The same with the noise that a fit leaves; itself where the noise is known."""
        if self.noise_known:
            return self
        model = self
        for _ in range(REWEIGHTINGS):
            model = replace(model, samples=fitted.with_estimated_noise(self.angles_known))
            fitted = model.refitted(fitted.terms, fitted, thorough=True)
        return model

    def _thinned(self) -> Self:
        """The same with fewer samples, for searches."""
        m = len(self.samples.q)
        if m <= SEARCHED:
            return self
        taken = np.unique(np.linspace(0, m - 1, SEARCHED).round().astype(int))
        directions = None if self.directions is None else self.directions[taken]
        return replace(self, samples=self.samples.part(taken), directions=directions)

    def _from(self, start: ChainParameters, terms: Sequence[Term] = ()) -> ExtendedChain:
        """The minimum that a start leads to."""
        whitening = self.samples.whitening(start if start.levers.any() else None)
        found = self._fitted(terms, start, whitening, None, (FRESH, QUICK[1]))
        if self.samples.angle_noise.any() and np.isfinite(found.cost):
            for _ in range(REWEIGHTINGS):  # weights follow from the chain
                found = self.refitted(terms, found)
        return found

    def _fitted(
        self,
        terms: Sequence[Term],
        start: ChainParameters,
        whitening: Array,
        near: ExtendedChain | None,
        effort: tuple[int, float],
    ) -> ExtendedChain:
        return fit_extended(
            self.samples,
            self.directions,
            terms,
            start,
            whitening,
            nominal=self.family.gains,
            near=near,
            iterations=effort[0],
            progress=effort[1],
        )
