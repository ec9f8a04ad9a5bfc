"""Searches from one start after the other, and what is said of the best."""

from __future__ import annotations

from typing import Any

import numpy as np

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit, fit_at
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import (
    ChainModel,
    SearchedChain,
    best_of,
    search,
)
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus


class StartSearch:
    """Starts one after the other; the minima they lead to.

    Attributes
    ----------
    samples : ChainSamples
        What is fitted.
    model : ChainModel
        What is free.
    asked_gains : (n,) bool array
        Which gains were unknown at first.
    found : list of SearchedChain
        Minima so far.
    starts, most : int
        Random starts so far, and at most.
    """

    def __init__(
        self, samples: ChainSamples, model: ChainModel, rng: np.random.Generator, most: int
    ) -> None:
        self.samples, self.model, self.most = samples, model, most
        self.asked_gains = model.free_gains
        self._rng = rng
        self.found: list[SearchedChain] = []
        self.starts = 0
        self._looked_at = 0

    @property
    def exhausted(self) -> bool:
        """Whether no more starts are allowed."""
        return self.starts >= self.most

    def try_start(self, start: ChainParameters, *, warm: bool = False) -> SearchedChain:
        """Go to the minimum that a start leads to, and keep it."""
        least = min((f.cost for f in self.found), default=np.inf)
        found = search(
            self.samples, start, self.model.free_gains, worthwhile=4.0 * least, warm=warm
        )
        if np.isfinite(found.cost):
            self.found.append(found)
        return found

    def try_random(self) -> SearchedChain:
        """The same from random rotations."""
        self.starts += 1
        return self.try_start(self.model.random_start(self._rng))

    def not_looked_at(self) -> list[SearchedChain]:
        """Minima that this was not asked for before."""
        new = self.found[self._looked_at :]
        self._looked_at = len(self.found)
        return new

    def begin_anew(self, model: ChainModel) -> None:
        """Forget all minima, and look for others with another model."""
        self.model, self.found, self._looked_at = model, [], 0

    def best(self) -> SearchedChain:
        """The minimum that costs least so far."""
        if not self.found:  # no start led anywhere: zero levers
            start = self.model.random_start(self._rng)
            whitening = self.samples.whitening()
            rest = np.einsum("kij,kj->ki", whitening, self.samples.torque)
            return SearchedChain(start, float(np.sum(rest**2)), whitening)
        return best_of(self.found)

    def result(self, verdict: FitStatus, found: SearchedChain, **more: Any) -> ChainFit:
        """What is known of a minimum, with a verdict."""
        return fit_at(
            found.chain, self.samples, self.model, self.asked_gains, verdict, self.starts, **more
        )

    def refused(self, verdict: FitStatus, remark: str, **more: Any) -> ChainFit:
        """The best minimum, which is not accepted, and why."""
        return self.result(verdict, self.best(), remark=remark, **more)
