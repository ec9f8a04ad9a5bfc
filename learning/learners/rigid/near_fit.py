"""Models like one that was fitted, fitted to a part of its samples: what poses left out show."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_search import minimise
from isotorque.learning.learners.rigid.process.rigid_chain_process import (
    ChainWithProcesses,
    RigidChainProcess,
    conditioned,
)
from isotorque.learning.learners.rigid.rigid_chain import RigidChain

Array = NDArray[np.float64]


class NearFit(Protocol):
    """A model to be fitted again, near where it was."""

    def fit(self, q: Array, torque: Array) -> Self:
        """Fit to samples (m, n) [rad], [N m]."""

    def predict(self, q: Array) -> Array:
        """Torques (m, n) [N m] at configurations (m, n) [rad]."""


class HasNear(Protocol):
    """A learner that knows itself what is near it."""

    def near(self) -> NearFit:
        """A model to be fitted again."""


class NearChain:
    """A rigid chain near another, with the same constants, springs and gains beside it.

    Parameters
    ----------
    found : ChainFit
        Of all samples; its noise counts.
    """

    def __init__(self, found: ChainFit) -> None:
        self._found, self._chain = found, found.chain

    def fit(self, q: Array, torque: Array) -> NearChain:
        """Fit to samples."""
        samples = replace(self._found.samples, q=q, torque=torque, weights=np.ones(len(q)))
        near = self._found.chain
        whitening = samples.whitening(near if samples.angle_noise.any() else None)
        self._chain = minimise(samples, near, self._found.model.free_gains, whitening).chain
        return self

    def predict(self, q: Array) -> Array:
        """Torques of the chain."""
        return self._chain.torque(q)


class NearChainWithProcesses:
    """Chains with processes near others, hyperparameters as they are.

    Parameters
    ----------
    models : tuple of ChainWithProcesses
        Their mean is predicted.
    q, torque : (m, n) arrays
        Samples that they were fitted to; others are a part of them [rad], [N m].
    """

    def __init__(self, models: tuple[ChainWithProcesses, ...], q: Array, torque: Array) -> None:
        self._all, self._models, self._q, self._torque = models, models, q, torque

    def fit(self, q: Array, torque: Array) -> NearChainWithProcesses:
        """Fit to a part of the samples."""
        kept = (self._q[:, None] == q[None]).all(axis=2).any(axis=1)
        self._models = tuple(
            model.without(~kept, self._torque)
            if model.processes
            else conditioned(model.chain, (), q, torque)
            for model in self._all
        )
        return self

    def predict(self, q: Array) -> Array:
        """Mean torques of the models."""
        return np.asarray(np.mean([model.torque(q) for model in self._models], axis=0))


def near_fit(learner: RigidChain | RigidChainProcess | HasNear) -> NearFit:
    """A model like one that was fitted, to be fitted to a part of its samples, friction taken off.

    Causes beside gravity and the levels of the noise stay what all samples showed; everything else
    is fitted anew. That is fast, and what poses left out of such fits show is nearly as honest as
    if everything had been looked for again.

    Examples
    --------
    >>> q = np.random.default_rng(0).uniform(-3.0, 3.0, (8, 2))
    >>> lower = 6.13 * np.cos(q.sum(axis=1))
    >>> torque = np.stack([18.39 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> near = near_fit(RigidChain().fit(q, torque)).fit(q[:6], torque[:6])
    >>> bool(np.abs(near.predict(q[6:]) - torque[6:]).max() < 1e-9)
    True
    """
    if isinstance(learner, RigidChain):
        return NearChain(learner.fit_)
    if isinstance(learner, RigidChainProcess):
        return NearChainWithProcesses(learner.models_, *learner.samples_)
    return learner.near()
