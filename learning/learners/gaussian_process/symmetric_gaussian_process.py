"""Gaussian process whose functions all have a group's symmetries."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.spatial import KDTree
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Kernel, WhiteKernel

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.gaussian_process.smooth_process import smooth_mean
from isotorque.learning.learners.gaussian_process.symmetric_kernel import SymmetrisedPeriodicKernel
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.learning.statistics.poses import group_poses
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]

#: Covariances, or waves, of queries and samples computed together, to bound memory.
TOGETHER = 4_000_000
#: Nugget, relative to the amplitude, that keeps noise-free covariances invertible.
NUGGET = 1e-12
#: Share of the torque that rounding may cost in a sum of covariances.
LOSS = 1e-13
#: Length scales [rad] from the best of which the search starts.
LENGTHS = np.geomspace(0.25, 16.0, 13)
#: Where length scales are sought [rad]; from the usual distance of the samples on, but at least
#: from ``LENGTH_FOR_FEW``.
SHORTEST, LENGTH_FOR_FEW, LONGEST = 0.05, 0.5, 50.0


class SymmetricGaussianProcess(TorqueRegressor, SavedLearner):
    """scikit-learn's Gaussian process with `SymmetrisedPeriodicKernel`, exactly equivariant.

    Parameters
    ----------
    noise : float or None
        Standard deviation of the torques' errors [N m]; None: estimated with the other
        hyperparameters.
    length_scale : float or None
        Length scale on the torus [rad]; None: the one of largest marginal likelihood.
    restarts : int
        Further random starts of that search.
    group : SymmetryGroup or None
        Relations to exploit.
    random_state : int
        Seed of these starts.

    Attributes
    ----------
    processes_ : list of GaussianProcessRegressor
        One for each joint, with hyperparameters of its own: the torque of a wrist is rougher
        than that of a shoulder, and one length scale for both fits neither.
    waves_ : list of TrigonometricPolynomial or None
        The same means (in units of the scale of the torques) as waves, where the sum of covariances
        would cancel; None where it does not.

    Notes
    -----
    Prefer it where samples are dear, the torque may be more than rigid gravity (springs, bending),
    and it matters how sure the estimate is: ``predict`` gives standard deviations, which also say
    where to sample next. Fitting costs the cube of the number of samples, so up to a thousand or
    two; symmetric copies are in the kernel and add none. A symmetry that is not there is enforced
    all the same. ``RecursiveLeastSquares`` learns one by one at nearly the same accuracy.

    Examples
    --------
    >>> q = np.linspace(-3.0, 3.0, 12)[:, None]
    >>> pendulum = SymmetricGaussianProcess(noise=0.0).fit(q, 5.0 * np.cos(q))
    >>> mean, deviation = pendulum.predict(q + 0.2, return_std=True)
    >>> bool(np.abs(mean - 5.0 * np.cos(q + 0.2)).max() < 1e-3), deviation.shape
    (True, (12, 1))
    """

    def __init__(
        self,
        noise: float | None = 0.0,
        *,
        length_scale: float | None = None,
        restarts: int = 0,
        group: GroupArrays | None = None,
        random_state: int = 0,
    ) -> None:
        self.noise = noise
        self.length_scale = length_scale
        self.restarts = restarts
        self.group = group
        self.random_state = random_state

    def fit(self, X: Any, y: Any) -> SymmetricGaussianProcess:
        """Fit to samples, forgetting what was before.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].

        Returns
        -------
        SymmetricGaussianProcess
            Itself.

        Raises
        ------
        InputError
            If a number is NaN or infinite, or a parameter of the learner is unusable.
        """
        self._check_parameters()
        q, torque, _ = checked_samples(self, X, y, first=True)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        size = np.sqrt(np.mean(torque**2, axis=0))
        self._scale = np.where(size > 1e-9 * size.max(initial=0.0), size, 1.0)
        self._q, self._torque = q, torque
        self._shortest = _shortest_length(q)
        self._condition([None] * self.n_outputs_)
        self.n_samples_seen_ = len(q)
        return self

    def predict(self, X: Any, return_std: bool = False) -> Any:
        """Torques (m, n) [N m] estimated for configurations (m, n) [rad].

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        return_std : bool
            Whether to return standard deviations (m, n) [N m] beside.
        """
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        mean, deviation = np.zeros((2, len(q), self.n_outputs_))
        waves = max((len(found) for found in self.waves_ if found is not None), default=0)
        together = max(1, TOGETHER // max(len(self._q), waves))
        for joint, process in enumerate(self.processes_):
            for i in range(0, len(q), together):
                part = slice(i, i + together)
                mean[part, joint] = self._mean(joint, q[part])
                if return_std:
                    deviation[part, joint] = process.predict(q[part], True)[1]
        result = [mean * self._scale, deviation * self._scale]
        if self._flat:
            result = [x[:, 0] for x in result]
        return tuple(result) if return_std else result[0]

    def _mean(self, joint: int, q: Array) -> Array:
        """The mean of one joint, in units of its scale; quicker than scikit-learn's ``predict``."""
        waves = self.waves_[joint]
        if waves is not None:
            return waves.evaluate(q)
        weights, length_scale = self.covariance_sum(joint)
        if not weights.any():
            return np.zeros(len(q))
        kernel = SymmetrisedPeriodicKernel(self._coordinates, joint, length_scale)
        return np.asarray(kernel(q, self._q) @ weights)

    def _condition(self, thetas: list[Array | None]) -> None:
        """Condition each process on the samples; hyperparameters are sought where not given."""
        self.processes_, self.waves_ = [], []
        for joint, theta in enumerate(thetas):
            kernel = self._kernel(joint)
            if theta is not None:
                kernel.theta = theta
            process = GaussianProcessRegressor(
                kernel,
                alpha=self._variance(joint),
                optimizer=_search(len(self._q)) if theta is None else None,
                n_restarts_optimizer=self.restarts,
                random_state=self.random_state,
            )
            values = self._torque[:, joint] / self._scale[joint]
            with warnings.catch_warnings():
                # A hyperparameter at its bound (a torque that is zero, say) is no failure.
                warnings.simplefilter("ignore", ConvergenceWarning)
                process.fit(self._q, values)
            self.processes_.append(process)
            self.waves_.append(self._smooth(joint, values) if self._lost(joint) > LOSS else None)

    def _lost(self, joint: int) -> float:
        """What rounding may cost in the sum of covariances, in units of the torque's scale."""
        weights, _ = self.covariance_sum(joint)
        return float(np.finfo(float).eps * self._coordinates.order * np.abs(weights).sum())

    def _smooth(self, joint: int, values: Array) -> TrigonometricPolynomial | None:
        process, product = self.processes_[joint], self._product(joint)
        level = process.alpha + (process.kernel_.k2.noise_level if self.noise is None else 0.0)
        noise = level / product.k1.constant_value + NUGGET
        length_scale = product.k2.k1.length_scale
        return smooth_mean(self._coordinates, joint, length_scale, noise, self._q, values)

    def covariance_sum(self, joint: int) -> tuple[Array, float]:
        """The mean of one joint as a sum of kernels.

        Returns
        -------
        weights : (m,) array
            What each sample's `SymmetrisedPeriodicKernel` is multiplied with, in units of the
            scale of the torques.
        length_scale : float
            Of the kernel [rad].
        """
        product = self._product(joint)
        weights = product.k1.constant_value * self.processes_[joint].alpha_.ravel()
        return weights, float(product.k2.k1.length_scale)

    def _product(self, joint: int) -> Any:
        """Amplitude times periodic kernel and nugget, without the noise that was estimated."""
        kernel = self.processes_[joint].kernel_
        return kernel if self.noise is not None else kernel.k1

    def _kernel(self, joint: int) -> Kernel:
        bounds: Any = "fixed" if self.length_scale is not None else (self._shortest, LONGEST)
        periodic = SymmetrisedPeriodicKernel(
            self._coordinates, joint, self.length_scale or max(2.0, self._shortest), bounds
        )
        kernel = ConstantKernel(1.0, (1e-12, 1e10)) * (periodic + WhiteKernel(NUGGET, "fixed"))
        return kernel if self.noise is not None else kernel + WhiteKernel(1e-4, (1e-12, 1.0))

    def _variance(self, joint: int) -> float:
        noise = 0.0 if self.noise is None else self.noise
        # scikit-learn wants it positive; the nugget is in the kernel.
        return float((noise / self._scale[joint]) ** 2) + np.finfo(float).tiny

    def _arrays(self) -> dict[str, NDArray]:
        thetas = {f"theta_{i}": p.kernel_.theta for i, p in enumerate(self.processes_)}
        return {"q": self._q, "torque": self._torque, "scale": self._scale, **thetas}

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        self._q, self._torque, self._scale = arrays["q"], arrays["torque"], arrays["scale"]
        self._shortest = SHORTEST
        self._condition([arrays[f"theta_{i}"] for i in range(self.n_outputs_)])

    def _check_parameters(self) -> None:
        require(self, "noise", self.noise is None or 0 <= self.noise < np.inf, "None or >= 0")
        length = self.length_scale
        require(self, "length_scale", length is None or 0 < length < np.inf, "None or > 0")
        require(self, "restarts", self.restarts >= 0, "at least 0")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if self.group is not None and outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        self._coordinates = SymmetryCoordinates.of(self.group, joints)
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0


def _shortest_length(q: Array) -> float:
    """Length scale that the samples can show at best [rad]: their usual distance.

    A shorter one would explain each sample by itself, and answer zero in between.
    """
    poses = group_poses(q)
    if poses.count < 2:
        return SHORTEST
    places = poses.configurations(q)
    circles = np.concatenate([np.cos(places), np.sin(places)], axis=1)
    nearest = KDTree(circles).query(circles, k=2)[0][:, 1]
    return float(np.clip(np.median(nearest), SHORTEST, LENGTH_FOR_FEW))


def _search(numbers: int) -> Callable[..., tuple[Array, float]]:
    """A search for hyperparameters, given how many numbers the process is to explain.

    The gradient search of scikit-learn stays where it starts if the covariance there cannot be
    inverted, or ends in a poor local optimum; so it starts from the best of some length scales,
    each with its best amplitude: the objective is ``(Q / s + numbers log s) / 2 + ..`` in the
    amplitude s, and its derivative by log s at s = 1 gives Q.
    """

    def search(objective: Callable[..., Any], theta: Array, bounds: Array) -> tuple[Array, float]:
        best, least = np.array(theta), np.inf
        lengths = np.log(LENGTHS) if len(theta) > 1 else [None]
        for length in lengths:
            trial = np.array(theta)
            trial[0] = 0.0
            if length is not None:
                trial[1] = length
            value, slope = objective(trial)
            squares = numbers - 2 * slope[0]
            if not np.isfinite(value) or squares <= 0:
                continue
            trial[0] = np.log(squares / numbers)
            trial = np.clip(trial, bounds[:, 0], bounds[:, 1])
            value = objective(trial, eval_gradient=False)
            if value < least:
                best, least = trial, value
        found = minimize(objective, best, jac=True, method="L-BFGS-B", bounds=bounds)
        return (found.x, found.fun) if found.fun < least else (best, least)

    return search
