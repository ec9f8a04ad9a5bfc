"""Any regressor, taught from a dictionary of samples instead of the current sample only."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, clone

from isotorque.learning.learners.memory.sample_dictionary import SampleDictionary
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays
from isotorque.learning.learners.torque_score import TorqueRegressor

Array = NDArray[np.float64]


class DictionaryLearner(TorqueRegressor, BaseEstimator):
    """A regressor that learns from a ``SampleDictionary`` (the paper's outlook iv).

    Parameters
    ----------
    regressor : estimator
        With ``partial_fit``: learns every new sample and then ``replay`` samples drawn from the
        dictionary. With ``fit`` only: is fitted anew to the whole dictionary whenever a
        prediction is wanted after samples have come.
    budget : int
        Samples in the dictionary.
    replay : int
        Samples drawn per new one.
    group : SymmetryGroup or None
        Relations under which samples count as near each other; the regressor must exploit the
        symmetries by itself (``group`` of this package's learners, ``SymmetricSamples``).
    random_state : int
        Seed of the draws.

    Notes
    -----
    Prefer it where memory is bounded and the arm may linger: the dictionary keeps what is far
    apart, so old places are not forgotten. It also makes an online learner of a batch regressor.

    Examples
    --------
    >>> from sklearn.neighbors import KNeighborsRegressor
    >>> learner = DictionaryLearner(KNeighborsRegressor(1), budget=20)
    >>> q = np.linspace(-1.0, 1.0, 200)[:, None]
    >>> learner = learner.partial_fit(q, np.cos(q))
    >>> bool(np.abs(learner.predict(q) - np.cos(q)).max() < 0.1)
    True
    """

    def __init__(
        self,
        regressor: Any,
        budget: int = 500,
        replay: int = 10,
        group: GroupArrays | None = None,
        random_state: int = 0,
    ) -> None:
        self.regressor = regressor
        self.budget = budget
        self.replay = replay
        self.group = group
        self.random_state = random_state

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> DictionaryLearner:
        """Forget everything, then learn samples (m, n) [rad], (m, k) [N m] in their order."""
        if hasattr(self, "n_outputs_"):
            del self.n_outputs_
        return self.partial_fit(X, y, sample_weight)

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> DictionaryLearner:
        """Learn further samples in their order; arguments as in ``fit``."""
        first = not hasattr(self, "n_outputs_")
        if first:
            require(self, "replay", self.replay >= 0, "at least 0")
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=first)
        if first:
            self.regressor_ = clone(self.regressor)
            self.dictionary_ = SampleDictionary(self.budget, self.group)
            self._random = np.random.default_rng(self.random_state)
            self._flat = np.ndim(y) == 1
            self.n_outputs_ = torque.shape[1]
        online = hasattr(self.regressor_, "partial_fit")
        for sample in zip(q, torque, weights, strict=True):
            self.dictionary_.add(*sample)
            if online:
                self._teach(sample[0][None], sample[1][None], np.array([sample[2]]))
                if self.replay:
                    self._teach(*self.dictionary_.draw(self._random, self.replay))
        self._stale = not online
        return self

    def predict(self, X: Any) -> Array:
        """Torques (m, k) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        if self._stale:
            targets = self.dictionary_.torque
            self.regressor_.fit(self.dictionary_.q, targets[:, 0] if self._flat else targets)
            self._stale = False
        return np.asarray(self.regressor_.predict(q))

    def _teach(self, q: Array, torque: Array, weights: Array) -> None:
        self.regressor_.partial_fit(q, torque[:, 0] if self._flat else torque, weights)
