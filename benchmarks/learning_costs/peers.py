"""scikit-learn's learners that stand beside this package's, given the same relations."""

from __future__ import annotations

from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel
from sklearn.kernel_approximation import RBFSampler
from sklearn.linear_model import LinearRegression, SGDRegressor
from sklearn.multioutput import MultiOutputRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer

from benchmarks.batch.learners import circles
from isotorque.learning.learners.augmented_samples import SymmetricSamples
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

Array = np.ndarray


class OnlineCircles(RegressorMixin, BaseEstimator):
    """A learner with ``partial_fit`` on cosine and sine of the coordinates.

    Parameters
    ----------
    regressor : estimator
        Learns torques in units of ``scale``.
    scale : (n,) array
        Size of the torques [N m].
    features : transformer, optional
        What is made of cosine and sine, without looking at samples.
    """

    def __init__(self, regressor: Any, scale: Any, features: Any = None) -> None:
        self.regressor = regressor
        self.scale = scale
        self.features = features

    def partial_fit(self, X: Array, y: Array) -> OnlineCircles:
        """Learn further samples: coordinates (m, r) [rad], torques (m, n) [N m]."""
        if not hasattr(self, "regressor_"):
            self.regressor_ = clone(self.regressor)
            self.features_ = clone(self.features) if self.features is not None else None
            if self.features_ is not None:
                self.features_.fit(self._circles(X))
        self.regressor_.partial_fit(self._features(X), y / self.scale)
        return self

    def predict(self, X: Array) -> Array:
        """Torques (m, n) [N m] at coordinates (m, r) [rad]."""
        return np.asarray(self.regressor_.predict(self._features(X)) * self.scale)

    def _features(self, y: Array) -> Array:
        found = self._circles(y)
        return found if self.features_ is None else np.asarray(self.features_.transform(found))

    def _circles(self, y: Array) -> Array:
        return np.concatenate([np.cos(y), np.sin(y)], axis=1)


def online_network(group: SymmetryGroup, scale: Array) -> Any:
    """MLPRegressor, one step of Adam for a sample and its copies; settings the best of six."""
    network = MLPRegressor(
        hidden_layer_sizes=(100,),
        activation="tanh",
        learning_rate_init=3e-3,
        alpha=1e-9,
        random_state=0,
    )
    return SymmetricSamples(OnlineCircles(network, scale), group)


def online_features(group: SymmetryGroup, scale: Array) -> Any:
    """SGDRegressor on random Fourier features; settings the best of six."""
    linear = SGDRegressor(learning_rate="constant", eta0=0.5, penalty=None)
    sampler = RBFSampler(gamma=0.3, n_components=300, random_state=0)
    return SymmetricSamples(OnlineCircles(MultiOutputRegressor(linear), scale, sampler), group)


def gaussian_process(group: SymmetryGroup) -> Any:
    """GaussianProcessRegressor, its two hyperparameters those of largest likelihood."""
    return SymmetricSamples(circles(GaussianProcessRegressor(ConstantKernel() * RBF())), group)


def linear_regression(group: SymmetryGroup) -> Any:
    """LinearRegression on all 3^r products of 1, cosine and sine of the coordinates."""
    linear = LinearRegression(fit_intercept=False)
    return SymmetricSamples(make_pipeline(FunctionTransformer(products), linear), group)


def products(y: Array) -> Array:
    """All products of one of 1, cos, sin of each coordinate: (m, 3^r) of (m, r)."""
    found = np.ones((len(y), 1))
    for column in y.T:
        factors = np.stack([np.ones_like(column), np.cos(column), np.sin(column)], axis=1)
        found = (found[:, :, None] * factors[:, None]).reshape(len(y), -1)
    return found
