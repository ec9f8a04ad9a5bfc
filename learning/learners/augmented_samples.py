"""Samples and all their symmetric copies."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, clone

from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor

Array = NDArray[np.float64]


class SymmetricSamples(TorqueRegressor, BaseEstimator):
    """Any scikit-learn regressor, fed with all symmetric copies of every sample.

    Parameters
    ----------
    regressor : estimator
        Anything with ``fit`` and ``predict``; ``partial_fit`` where samples arrive one by one.
    group : SymmetryGroup or None
        Relations to exploit.

    Notes
    -----
    The regressor sees the coordinates y = B q, wrapped to [-pi, pi): n_sym samples for one (the
    paper's section 4). Prefer this for learners that know nothing of symmetries; the learners of
    this package take a ``group`` themselves, which is faster and, for tied features, exact.
    """

    def __init__(self, regressor: Any, group: GroupArrays | None = None) -> None:
        self.regressor = regressor
        self.group = group

    def fit(self, X: Array, y: Array) -> SymmetricSamples:
        """Fit to configurations (m, n) [rad] and torques (m, n) [N m] and all their copies."""
        self.regressor_ = clone(self.regressor)
        self.coordinates_ = SymmetryCoordinates.of(self.group, np.shape(X)[1])
        self.n_features_in_ = np.shape(X)[1]
        self.regressor_.fit(*self._expanded(X, y))
        return self

    def partial_fit(
        self, X: Array, y: Array, sample_weight: Array | None = None
    ) -> SymmetricSamples:
        """Learn further samples; weights (m,) are handed on where given."""
        if not hasattr(self, "regressor_"):
            self.regressor_ = clone(self.regressor)
            self.coordinates_ = SymmetryCoordinates.of(self.group, np.shape(X)[1])
            self.n_features_in_ = np.shape(X)[1]
        more = {}
        if sample_weight is not None:
            more["sample_weight"] = np.tile(sample_weight, self.coordinates_.order)
        self.regressor_.partial_fit(*self._expanded(X, y), **more)
        return self

    def predict(self, X: Array) -> Array:
        """Torques (m, n) [N m] at configurations (m, n) [rad]."""
        return np.asarray(self.regressor_.predict(self.coordinates_.coordinates(X)))

    def _expanded(self, X: Array, y: Array) -> tuple[Array, Array]:
        copies, torques = self.coordinates_.copies(X, y)
        return copies.reshape(-1, copies.shape[-1]), torques.reshape(-1, torques.shape[-1])
