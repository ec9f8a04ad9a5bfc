"""Feed-forward network with one hidden layer, fitted by Levenberg-Marquardt, with symmetries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.network.canonical_coordinates import CanonicalCoordinates
from isotorque.learning.learners.network.inputs import NetworkInputs
from isotorque.learning.learners.network.tanh_layer import TanhLayer
from isotorque.learning.learners.network.training import NetworkProblem, best_network
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

MODES = ("averaged", "augmented", "canonical")
INPUTS = ("sincos", "raw")
#: Units of the hidden layer evaluated together, to bound memory.
TOGETHER = 4_000_000


class FeedForwardNetwork(TorqueRegressor, SavedLearner):
    """One hidden layer of tanh units (the paper's section 6), with symmetries.

    Parameters
    ----------
    hidden : int
        Number of hidden units; the paper has 18 and 30.
    symmetries : {"averaged", "augmented", "canonical"}
        How a group is used. ``averaged``: the mean of the network over all symmetric copies of
        the input, exactly equivariant. ``augmented``: a plain network that learns all copies of
        every sample; equivariant as far as it has learned to be. ``canonical``: a plain network
        that learns and answers in the fundamental domain alone, to which everything is mapped.
    inputs : {"sincos", "raw"}
        Cosine and sine of the coordinates, or the coordinates themselves over pi, wrapped.
    restarts : int
        Random starts. Each is fitted for ``trial_iterations``; the one with the least training
        error is fitted to the end.
    trial_iterations, iterations : int
        Steps of Levenberg-Marquardt.
    tolerance : float
        Training error, relative to the size of the torques, that is enough.
    ridge : float
        Penalty on the squares of the weights, for noisy samples.
    validation_fraction : float
        Share of the samples held out, for noisy samples: the weights at their least error are
        kept and the search ends when it no longer falls (early stop). 0: none.
    group : SymmetryGroup or None
        Relations to exploit.
    random_state : int
        Seed of starts and of the choice of samples held out.

    Attributes
    ----------
    weights_ : (p,) array
        All weights, see `TanhLayer`.
    training_error_ : float
        Root mean square of the training error, each joint in units of its root mean square torque.
    n_iterations_ : int
        Steps taken from the start chosen.

    Notes
    -----
    Prefer it for smooth torque maps of unknown form with hundreds of samples at hand, all at once,
    and when a small model is wanted: some hundred numbers, evaluated in a microsecond. It fits
    noise-free samples to 1e-4 of the torque or better. ``EquivariantTrigonometric`` needs a
    handful of samples where the torque is rigid gravity; ``SymmetricGaussianProcess`` needs no
    restarts, says how sure it is and wants about as many samples; ``RecursiveLeastSquares`` and
    ``LocalLinearMap`` learn one by one.

    Of the modes, ``averaged`` is most accurate and cheapest to fit; its evaluation costs ``order``
    passes. ``canonical`` costs one pass, but may jump at the faces of the domain. ``augmented`` is
    the paper's recipe; it is the mode for symmetries that hold only roughly, and on the 2R arm it
    is better than ``averaged`` where samples give fewer equations than there are weights.

    Starts that fit soon also generalise best: choosing among 16 after 30 steps gave the 3R arm
    (65 samples, 18 units) errors of 4 to 18 mN m over four lattices and two seeds each; choosing
    among 3 at the end, which costs as much, 16 to 51 mN m over five lattices.

    References
    ----------
    The paper, sections 6 and 7.2. M. T. Hagan, M. B. Menhaj, "Training feedforward networks with
    the Marquardt algorithm", IEEE Trans. Neural Networks 5 (1994).

    Examples
    --------
    >>> q = np.linspace(-np.pi, np.pi, 20)[:, None]
    >>> pendulum = FeedForwardNetwork(hidden=3, restarts=2).fit(q, 5.0 * np.cos(q))
    >>> bool(np.abs(pendulum.predict(q) - 5.0 * np.cos(q)).max() < 1e-3)
    True
    """

    def __init__(
        self,
        hidden: int = 18,
        *,
        symmetries: str = "averaged",
        inputs: str = "sincos",
        restarts: int = 16,
        trial_iterations: int = 30,
        iterations: int = 400,
        tolerance: float = 1e-8,
        ridge: float = 0.0,
        validation_fraction: float = 0.0,
        group: GroupArrays | None = None,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.symmetries = symmetries
        self.inputs = inputs
        self.restarts = restarts
        self.trial_iterations = trial_iterations
        self.iterations = iterations
        self.tolerance = tolerance
        self.ridge = ridge
        self.validation_fraction = validation_fraction
        self.group = group
        self.random_state = random_state

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> FeedForwardNetwork:
        """Fit to samples, forgetting what was before.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].
        sample_weight : (m,) array_like, optional
            Weights of the squared errors.

        Returns
        -------
        FeedForwardNetwork
            Itself.

        Raises
        ------
        InputError
            If a number is NaN or infinite, or a parameter of the learner is unusable.
        """
        self._check_parameters()
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=True)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        size = np.sqrt(np.average(torque**2, axis=0, weights=weights if weights.any() else None))
        self._scale = np.maximum(size, 1e-9 * size.max()) if size.any() else np.ones(len(size))
        rng = np.random.default_rng(self.random_state)
        held_out = None
        if self.validation_fraction and len(q) > 1:
            order = rng.permutation(len(q))
            cut = min(len(q) - 1, max(1, round(self.validation_fraction * len(q))))
            held_out = self._problem(q[order[:cut]], torque[order[:cut]], weights[order[:cut]])
            q, torque, weights = q[order[cut:]], torque[order[cut:]], weights[order[cut:]]
        fit = best_network(
            self._problem(q, torque, weights),
            held_out,
            rng,
            restarts=self.restarts,
            trial_iterations=self.trial_iterations,
            iterations=self.iterations,
            tolerance=self.tolerance,
            ridge=self.ridge,
        )
        self.weights_ = fit.x
        self.training_error_ = fit.rms
        self.n_iterations_ = fit.iterations
        self.n_samples_seen_ = len(X)
        return self

    def predict(self, X: Any) -> Array:
        """Torques (m, n) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        parts = []
        for part in self._parts(q):
            x, signs, _ = self._inputs.of(part)
            parts.append(self._layer.values(self.weights_, x) * signs * self._scale)
        result = np.concatenate(parts)
        return result[:, 0] if self._flat else result

    def jacobian(self, X: Any) -> Array:
        """Stiffness d torque / d q, (m, n, n) [N m / rad]: the exact derivative of ``predict``."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        parts = []
        for part in self._parts(q):
            x, signs, dx = self._inputs.of(part, derivatives=True)
            slopes = self._layer.input_derivatives(self.weights_, x, dx)
            parts.append(slopes * (signs * self._scale)[:, :, None])
        return np.asarray(np.concatenate(parts) @ self._coordinates.basis)

    def _parts(self, q: Array) -> list[Array]:
        """Configurations in parts small enough to be evaluated at once."""
        together = max(1, TOGETHER // (len(self._layer.signs) * self.hidden))
        return [q[i : i + together] for i in range(0, len(q), together)]

    def _problem(self, q: Array, torque: Array, weights: Array) -> NetworkProblem:
        """What the network is to fit: inputs, targets in units of their size, root weights."""
        targets = torque / self._scale
        if self.symmetries == "augmented":
            order = self._coordinates.order
            copies, _ = self._coordinates.copies(q, q[:, :1] * 0)
            x = self._inputs.features(copies.reshape(-1, 1, copies.shape[-1]))
            targets = (self._signs[:, None] * targets).reshape(-1, targets.shape[1])
            return NetworkProblem(self._layer, x, targets, np.sqrt(np.tile(weights, order)))
        x, signs, _ = self._inputs.of(q)
        return NetworkProblem(self._layer, x, targets * signs, np.sqrt(weights))

    def _arrays(self) -> dict[str, NDArray]:
        return {"weights": self.weights_.copy(), "scale": self._scale.copy()}

    def _counters(self) -> dict[str, Any]:
        return {"training_error": float(self.training_error_), "iterations": self.n_iterations_}

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        if arrays["weights"].shape != (self._layer.size,):
            raise InputError(
                "saved network", "number of weights", arrays["weights"].size, str(self._layer.size)
            )
        self.weights_, self._scale = arrays["weights"], arrays["scale"]
        self.training_error_ = state["training_error"]
        self.n_iterations_ = state["iterations"]

    def _check_parameters(self) -> None:
        require(self, "symmetries", self.symmetries in MODES, ", ".join(MODES))
        require(self, "inputs", self.inputs in INPUTS, ", ".join(INPUTS))
        for name in ("hidden", "restarts", "trial_iterations", "iterations"):
            require(self, name, getattr(self, name) >= 1, "at least 1")
        for name in ("tolerance", "ridge"):
            require(self, name, 0 <= getattr(self, name) < np.inf, "a number >= 0")
        share = self.validation_fraction
        require(self, "validation_fraction", 0 <= share < 1, "0 <= number < 1")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if self.group is not None and outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        self._coordinates = SymmetryCoordinates.of(self.group, joints)
        self._signs = self._coordinates.Y if outputs == joints else np.ones((1, outputs))
        canonical = self.group is not None and self.symmetries == "canonical"
        averaged = self.symmetries == "averaged"
        self._inputs = NetworkInputs(
            self._coordinates,
            periodic=self.inputs == "sincos",
            averaged=averaged,
            canonical=CanonicalCoordinates(self._coordinates) if canonical else None,
        )
        self._layer = TanhLayer(
            self._inputs.count,
            int(self.hidden),
            outputs,
            self._signs if averaged else np.ones((1, outputs)),
        )
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0
