"""Standard errors of the torque that a fitted chain predicts, calibrated."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters, torques_of
from isotorque.learning.learners.rigid.fitting.chain_search import minimise
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

REPLICATES = 100


class TorqueErrors:
    """Standard errors of predicted torques, from derivatives and from repeated experiments.

    Parameters
    ----------
    fit : ChainFit
        An accepted fit.
    seed : int
        Of the repeated experiments.

    Notes
    -----
    Where axes are parallel or vertical the chain is singular: one of its numbers loses its
    meaning, and the linear standard error says too little there (its 90 % band covers 80 to 84 %
    on the ur5). The experiment is therefore repeated: noise of the stated or estimated size is
    added to the torques of the fitted chain, the chain fitted again, a hundred times (parametric
    bootstrap). The larger of both standard errors counts, torque by torque; where noise was
    estimated it is larger by `ChainFit.spread`. Coverage: docs/rigid-chain.md.

    References
    ----------
    Efron, Tibshirani, An Introduction to the Bootstrap, 1993, chapter 6.
    """

    def __init__(self, fit: ChainFit, seed: int = 0) -> None:
        self._fit, self._seed = fit, seed

    def standard_error(self, q: Array) -> Array:
        """Of the torques at q (m, n) [rad], (m, n) [N m]; inf where samples leave them open."""
        fit = self._fit
        linear = fit.standard_error(q)
        replicas = self.replicas
        if not replicas:
            return linear
        changes = torques_of(replicas, q) - fit.chain.torque(q)
        return np.maximum(linear, fit.spread * np.sqrt(np.mean(changes**2, axis=0)))

    @cached_property
    @single_thread()
    def replicas(self) -> list[ChainParameters]:
        """Chains fitted to repeated experiments; none where the samples are exact."""
        fit = self._fit
        samples, rng = fit.samples, np.random.default_rng(self._seed)
        if not (samples.torque_noise.any() or samples.angle_noise.any()):
            return []
        torque = fit.chain.torque(samples.q)
        # noise with the covariance whose inverse factor the whitening is
        colouring = np.linalg.inv(fit.whitening)
        found = []
        for _ in range(REPLICATES):
            noise = np.einsum("kij,kj->ki", colouring, rng.standard_normal(torque.shape))
            repeated = replace(samples, torque=torque + noise)
            found.append(minimise(repeated, fit.chain, fit.model.free_gains, fit.whitening).chain)
        return found
