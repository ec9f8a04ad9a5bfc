"""The learners of the benchmark of batch learning."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from sklearn.kernel_ridge import KernelRidge
from sklearn.neural_network import MLPRegressor

from isotorque.learning.learners.augmented_samples import SymmetricSamples
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor

#: Learners that are not run beyond so many samples: too slow for a few minutes.
MOST_SAMPLES = {
    "gaussian process": 600,
    "network, augmented": 70,
    "network, canonical": 150,
    "MLP (scikit-learn)": 150,
}
#: The same where samples are noisy: the noise is estimated with the other hyperparameters.
MOST_NOISY_SAMPLES = {"gaussian process": 260}
#: Learners that are not run on more joints.
MOST_JOINTS = {"network": 6, "network, augmented": 3, "network, canonical": 3}
#: Learners compared with noise.
WITH_NOISE = (
    "network",
    "kernel ridge (scikit-learn)",
    "gaussian process",
    "trigonometric",
    "parametric",
)
#: Learners compared with learned symmetries.
WITH_LEARNED = ("network", "gaussian process", "trigonometric")


def circles(learner: Any) -> Any:
    """scikit-learn's learner on cosine and sine of the coordinates."""
    from sklearn.compose import TransformedTargetRegressor
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import FunctionTransformer, StandardScaler

    to_circles = FunctionTransformer(lambda y: np.concatenate([np.cos(y), np.sin(y)], axis=1))
    return TransformedTargetRegressor(
        make_pipeline(to_circles, learner), transformer=StandardScaler(with_mean=False)
    )


def multilayer(group: Any, hidden: int, seed: int = 0) -> Any:
    """MLPRegressor fitted by L-BFGS to all copies."""
    settings = {"solver": "lbfgs", "alpha": 1e-9, "max_iter": 2000, "tol": 1e-9}
    learner = MLPRegressor(
        hidden_layer_sizes=(hidden,), activation="tanh", random_state=seed, **settings
    )
    return SymmetricSamples(circles(learner), group)


def kernel_ridge(group: Any, alpha: float = 1e-8) -> Any:
    """KernelRidge fitted to all copies."""
    return SymmetricSamples(circles(KernelRidge(alpha=alpha, kernel="rbf", gamma=0.1)), group)


def learners(robot: str, samples: int, noise: float, seed: int) -> dict[str, Callable[[Any], Any]]:
    """A fresh learner for a group, by name; ``noise`` is the error of angles [rad]."""
    hidden = 30 if robot == "3r" and samples >= 150 else 18
    network = {"random_state": seed, "validation_fraction": 0.15 if noise else 0.0}

    def of_mode(mode: str) -> Callable[[Any], Any]:
        return lambda group: FeedForwardNetwork(hidden, symmetries=mode, group=group, **network)

    return {
        "network": of_mode("averaged"),
        "network, augmented": of_mode("augmented"),
        "network, canonical": of_mode("canonical"),
        "MLP (scikit-learn)": lambda group: multilayer(group, hidden, seed),
        "kernel ridge (scikit-learn)": lambda group: kernel_ridge(group, 1e-2 if noise else 1e-8),
        "gaussian process": lambda group: SymmetricGaussianProcess(
            noise=None if noise else 0.0, group=group
        ),
        "trigonometric": lambda group: EquivariantTrigonometric(group=group),
        "parametric": lambda group: StaticRegressor(robot, group=group),
    }


def runs(learner: str, joints: int, samples: int, kind: str, noise: float) -> bool:
    """Whether a learner is run with this many joints and samples, symmetries and noise."""
    if kind in ("none", "free") and learner.startswith("network,"):
        return False
    if kind == "learned" and learner not in WITH_LEARNED:
        return False
    most = MOST_SAMPLES.get(learner, 5000)
    if noise:
        if learner not in WITH_NOISE:
            return False
        most = MOST_NOISY_SAMPLES.get(learner, most)
    return joints <= MOST_JOINTS.get(learner, 7) and samples <= most
