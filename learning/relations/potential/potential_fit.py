"""Gravity potential fitted to static samples, with the uncertainty of its coefficients."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
    WeightedFit,
    solve,
    stiffness_matrices,
    torque_features,
    weighted_fit,
)
from isotorque.learning.statistics.tails import tail_probability
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]
Frequencies = NDArray[np.int64]

ROUNDING = 1e-9  # of the largest torque: residuals below it are where a motion ended, not noise
EXACT = 1e-7  # of the largest torque: samples that a potential alone explains so well have no
# constant torques above it, though they are too few to fit any
NOISE_RATIOS = (0.01, 0.1, 1.0, 10.0)  # torque noise over angle noise times stiffness


@dataclass(frozen=True, eq=False)
class WhitenedSamples:
    """Samples and a fit in units of one standard deviation of the noise.

    Attributes
    ----------
    q : (N, k) array
        Angles of the joints that the potential knows, corrected by their probable errors [rad].
    joints : (k,) int array
        Which joints these are.
    whitening : (N, k, k) array
        What torques are multiplied with.
    design : (N k, k + 2 m) array
        Columns of the constants and of the coefficients.
    residual : (N k,) array
        What the fit leaves.
    root : (k + 2 m, k + 2 m) array
        Upper triangular root of the normal matrix of the design.
    floor : float
        Mean square of what arithmetic leaves, in these units.
    measured_q, measured_torque : (N, k) arrays
        As measured, nothing corrected [rad], [N m].
    """

    q: Array
    joints: NDArray[np.intp]
    whitening: Array
    design: Array
    residual: Array
    root: Array
    floor: float
    measured_q: Array
    measured_torque: Array

    def torques(self, whitened: Array) -> Array:
        """Torques (N, k) [N m] of whitened ones (N k,)."""
        count, k, _ = self.whitening.shape
        found = np.linalg.solve(self.whitening, whitened.reshape(count, k, 1))
        return np.asarray(found[:, :, 0])


@dataclass(frozen=True, eq=False)
class FittedPotential:
    """Least-squares estimate of U(q) = sum a_k cos(k.q) + b_k sin(k.q) from its gradient.

    Attributes
    ----------
    frequencies : (m, n) int array
        Frequencies k offered to the fit, one of each pair +-k, no constant.
    coefficients : (2 m,) array
        All a_k, then all b_k [J].
    root : (2 m, 2 m) array
        W with W^T W = inverse covariance of the coefficients.
    freedom : float
        Degrees of freedom the noise level was estimated with; infinite where it was given.
    noise : MeasurementNoise
        Estimated or given noise levels.
    samples : int
        Number of different samples used.
    offsets, offset_errors : (n,) arrays
        Constant torque of every joint beside the potential's, and its standard error [N m].
    whitened : WhitenedSamples
        What the fit leaves over, for a closer look (`lack_of_fit`).
    """

    frequencies: Frequencies
    coefficients: Array
    root: Array
    freedom: float
    noise: MeasurementNoise
    samples: int
    offsets: Array
    offset_errors: Array
    whitened: WhitenedSamples

    @property
    def potential(self) -> TrigonometricPolynomial:
        """The fitted potential, all offered terms included."""
        m = len(self.frequencies)
        return TrigonometricPolynomial(
            self.frequencies, self.coefficients[:m], self.coefficients[m:]
        )

    @property
    def covariance(self) -> Array:
        """Covariance of the coefficients, shape (2 m, 2 m) [J^2]."""
        inverse = np.linalg.inv(self.root)
        return inverse @ inverse.T

    @property
    def standard_error(self) -> Array:
        """Standard errors of the coefficients, shape (2 m,) [J]."""
        return np.sqrt(np.diag(self.covariance))

    def without_constants(self, joints: NDArray[np.intp]) -> FittedPotential:
        """The fit if no joint but these has a constant torque."""
        samples = self.whitened
        k = len(samples.joints)
        absent = np.flatnonzero(~np.isin(samples.joints, joints))
        present = np.setdiff1d(np.arange(len(samples.root)), absent)
        span, root = np.linalg.qr(samples.root[:, present])
        estimate = np.concatenate([self.offsets[samples.joints], self.coefficients])
        found = np.linalg.solve(root, span.T @ (samples.root @ estimate))
        free = k - len(absent)
        offsets, errors = np.zeros((2, len(self.offsets)))
        kept = samples.joints[present[:free]]
        offsets[kept] = found[:free]
        errors[kept] = np.linalg.norm(np.linalg.inv(root)[:free], axis=1)
        return replace(
            self,
            coefficients=found[free:],
            root=root[free:, free:],
            offsets=offsets,
            offset_errors=errors,
        )

    def rms_torque(self) -> Array:
        """Root mean square torque over the whole torus, shape (n,) [N m]."""
        m = len(self.frequencies)
        power = self.coefficients[:m] ** 2 + self.coefficients[m:] ** 2
        return np.sqrt(0.5 * power @ self.frequencies.astype(float) ** 2)


def all_frequencies(n: int, joints: ArrayLike | None = None) -> Frequencies:
    """All k in {-1, 0, 1}^n but 0, one of each pair +-k.

    Parameters
    ----------
    n : int
        Number of joints.
    joints : (n,) array of bool, optional
        Where False, k_j = 0.

    Examples
    --------
    >>> all_frequencies(2).tolist()
    [[0, 1], [1, -1], [1, 0], [1, 1]]
    """
    used = np.ones(n, dtype=bool) if joints is None else np.asarray(joints, dtype=bool)
    count = int(used.sum())
    box = np.array(list(itertools.product((-1, 0, 1), repeat=count)), dtype=np.int64)
    frequencies = np.zeros((len(box) // 2, n), dtype=np.int64)
    frequencies[:, used] = box[len(box) // 2 + 1 :]
    return frequencies


def fit_potential(
    q: Array, tau: Array, frequencies: Frequencies, noise: MeasurementNoise | None = None
) -> FittedPotential:
    """Fit a potential to static samples.

    Parameters
    ----------
    q : (N, n) array
        Configurations [rad].
    tau : (N, n) array
        Torques that held them [N m].
    frequencies : (m, n) int array
        Frequencies the potential may have.
    noise : MeasurementNoise, optional
        Noise levels where known; estimated from the residuals otherwise.

    Returns
    -------
    FittedPotential

    Raises
    ------
    Undetermined
        If there are too few samples, or they leave combinations of coefficients open.

    Notes
    -----
    Every sample gives n equations for the 2 m coefficients (docs/theory.md) and a constant
    torque for each joint: a cable that pulls, friction that always points one way, an amplifier's
    zero; left out, it would bend the coefficients and pass for noise. Samples too few for constants
    are enough where a potential alone explains them exactly, one equation more than coefficients:
    a constant would show. An error of the
    angles acts on the torque through the stiffness H, so residuals are weighted by the inverse of
    ``sigma_torque^2 I + sigma_angle^2 H H^T``, and the angles themselves are corrected by their
    most probable error before the next step (Gauss-Newton for the errors-in-variables problem
    [1]_); otherwise the noise would shrink the coefficients. Where the levels are not given, their
    ratio is the one of `NOISE_RATIOS` with the largest restricted likelihood [2]_, and their size
    follows from the residuals.

    References
    ----------
    .. [1] W. A. Fuller, "Measurement Error Models", Wiley 1987, section 3.2.
    .. [2] H. D. Patterson, R. Thompson, "Recovery of inter-block information when block sizes are
       unequal", Biometrika 58 (1971).

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-np.pi, np.pi, (6, 2))
    >>> truth = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> fit = fit_potential(q, truth.gradient(q), all_frequencies(2))
    >>> bool((fit.potential - truth).sup_bound() < 1e-11)
    True
    """
    q, tau = _different(q, tau)
    touched = np.asarray(frequencies.any(axis=0))  # the equations of other joints say 0 = 0
    equations = int(touched.sum())
    unknowns = 2 * len(frequencies) + equations
    freedom = len(q) * equations - unknowns
    least = -(-(unknowns + 1) // max(1, equations))
    offered, frequencies = frequencies, frequencies[:, touched]
    q, tau = q[:, touched], tau[:, touched]
    largest = max(float(np.abs(tau).max(initial=0.0)), 1e-300)
    few = len(q) < least
    if few and not (noise is None and _needs_no_constants(q, tau, frequencies, largest)):
        raise Undetermined(
            f"{least - len(q)} more samples: {len(q)} different ones were given, {least} determine "
            f"{unknowns - equations} coefficients and {equations} constants and check them"
        )
    if few:
        freedom += equations
        start = np.concatenate([np.zeros(equations), _start(q, tau, frequencies, constants=False)])
    else:
        start = _start(q, tau, frequencies)
    if noise is not None:
        floor = MeasurementNoise(noise.angle, float(np.hypot(noise.torque, ROUNDING * largest)))
        found = weighted_fit(q, tau, frequencies, start, floor)
        return _fitted(offered, touched, found, 1.0, np.inf, floor, largest, q, tau)
    stiffness = stiffness_matrices(frequencies, start[equations:], q)
    typical = max(float(np.sqrt(np.mean(stiffness**2))), 1e-300)
    best: tuple[float, WeightedFit, float, float] | None = None
    for ratio in NOISE_RATIOS:
        shape = MeasurementNoise(1.0 / typical, ratio)
        found = weighted_fit(q, tau, frequencies, start, shape, constants=not few)
        variance = max(found.squares / freedom, (ROUNDING * largest / ratio) ** 2)
        deviance = freedom * np.log(variance) + found.log_volume
        if best is None or deviance < best[0]:
            best = (deviance, found, float(np.sqrt(variance)), ratio)
    assert best is not None
    _, found, size, ratio = best
    level = MeasurementNoise(size / typical, size * ratio)
    return _fitted(offered, touched, found, size, float(freedom), level, largest, q, tau)


def _needs_no_constants(q: Array, tau: Array, frequencies: Frequencies, largest: float) -> bool:
    """Whether a potential alone explains more equations than it has coefficients, exactly."""
    if tau.size <= 2 * len(frequencies):
        return False
    coefficients = _start(q, tau, frequencies, constants=False)
    left = tau - torque_features(frequencies, q) @ coefficients
    return float(np.abs(left).max()) <= EXACT * largest


def _start(q: Array, tau: Array, frequencies: Frequencies, *, constants: bool = True) -> Array:
    """Constants, unless there are none, and coefficients by ordinary least squares."""
    count, n = q.shape
    columns = torque_features(frequencies, q)
    if constants:
        unit = np.broadcast_to(np.eye(n), (count, n, n))
        columns = np.concatenate([unit, columns], axis=2)
    return solve(columns.reshape(count * n, -1), tau.ravel(), n)


def _fitted(
    offered: Frequencies,
    touched: NDArray[np.bool_],
    found: WeightedFit,
    size: float,
    freedom: float,
    noise: MeasurementNoise,
    largest: float,
    q: Array,
    tau: Array,
) -> FittedPotential:
    """State a fit whose weights were right up to a factor: ``size`` is one standard deviation."""
    n = int(touched.sum())
    root = found.root / size
    inverse = np.linalg.inv(root)
    offsets, errors = np.zeros((2, len(touched)))
    offsets[touched] = found.estimate[:n]
    errors[touched] = np.linalg.norm(inverse[:n], axis=1)
    whitening = found.whitening / size
    rounding = np.mean(whitening.sum(axis=2) ** 2) * (ROUNDING * largest) ** 2
    samples = WhitenedSamples(
        found.q,
        np.flatnonzero(touched),
        whitening,
        found.design / size,
        found.residual / size,
        root,
        float(rounding),
        q,
        tau,
    )
    return FittedPotential(
        offered,
        found.estimate[n:],
        root[n:, n:],  # the constants come first: what is left is the root without them
        freedom,
        noise,
        len(found.q),
        offsets,
        errors,
        samples,
    )


def present_frequencies(fit: FittedPotential, level: float) -> NDArray[np.bool_]:
    """Which coefficient pairs (a_k, b_k) differ from zero at a level, shape (m,)."""
    m = len(fit.frequencies)
    covariance = fit.covariance
    p_values = np.empty(m)
    for i in range(m):
        pair = fit.coefficients[[i, m + i]]
        block = covariance[np.ix_([i, m + i], [i, m + i])]
        p_values[i] = tail_probability(float(pair @ np.linalg.solve(block, pair)), 2, fit.freedom)
    return p_values < level / m


def _different(q: Array, tau: Array) -> tuple[Array, Array]:
    """Leave out samples that repeat an earlier one; they would feign a check of the fit."""
    direction = np.concatenate([np.cos(q), np.sin(q)], axis=1)
    key = np.round(np.concatenate([direction, tau / max(np.abs(tau).max(), 1e-300)], axis=1), 9)
    _, first = np.unique(key + 0.0, axis=0, return_index=True)
    first.sort()
    return q[first], tau[first]
