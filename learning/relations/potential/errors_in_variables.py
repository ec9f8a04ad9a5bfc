"""Least squares for gravity coefficients when the angles are measured with errors too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
Frequencies = NDArray[np.int64]

DEPENDENT = 1e-9  # of the largest singular value of the scaled design
ITERATIONS = 12
HELD = 1e3  # weight of constants that are held at zero, relative to that of a torque


@dataclass(frozen=True)
class MeasurementNoise:
    """Standard deviations of independent errors of every measured value.

    Attributes
    ----------
    angle : float
        Of a joint angle [rad].
    torque : float
        Of a torque [N m].
    """

    angle: float
    torque: float

    def __post_init__(self) -> None:
        for name, value in (("angle", self.angle), ("torque", self.torque)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError("measurement noise", name, value, "a number >= 0")


class Undetermined(Exception):
    """The samples do not determine the potential; the message says what is missing."""


def torque_features(frequencies: Frequencies, q: Array) -> Array:
    """Gradients of cos(k.q) and sin(k.q), shape (N, n, 2 m), at q (N, n)."""
    phase = q @ frequencies.T
    return _features(frequencies, np.cos(phase), np.sin(phase))


def _features(frequencies: Frequencies, cosine: Array, sine: Array) -> Array:
    k = frequencies.T.astype(float)
    count, m = cosine.shape
    features = np.empty((count, len(k), 2 * m))
    np.multiply(sine[:, None], -k, out=features[:, :, :m])
    np.multiply(cosine[:, None], k, out=features[:, :, m:])
    return features


def solve(design: Array, target: Array, equations: int = 1) -> Array:
    """Least squares, columns scaled to one size; every sample gives so many equations.

    Raises
    ------
    Undetermined
        If the columns are linearly dependent.
    """
    size = np.sqrt(np.einsum("ij,ij->j", design, design))
    size = np.where(size > 0.0, size, 1.0)
    rows, seen = design / size, target
    width = design.shape[1]
    if len(rows) > 2 * width:  # the singular values of a triangular root take less arithmetic
        beside = np.concatenate([rows, seen[:, None]], axis=1)
        triangle = np.asarray(np.linalg.qr(beside, mode="r"))
        rows, seen = triangle[:, :width], triangle[:, width]
    solution, _, _, singular = np.linalg.lstsq(rows, seen, rcond=None)
    open_ones = int((singular <= DEPENDENT * singular[0]).sum())
    if not open_ones:
        return np.asarray(solution / size)
    raise Undetermined(
        f"at least {-(-open_ones // equations)} more samples in general position: the given "
        f"configurations leave {open_ones} combinations of the coefficients open (a joint that "
        "never moved, or a torque that was always the same)"
    )


def stiffness_matrices(frequencies: Frequencies, coefficients: Array, q: Array) -> Array:
    """Hessian of the potential, shape (N, n, n)."""
    phase = q @ frequencies.T
    return _stiffness(frequencies, coefficients, np.cos(phase), np.sin(phase))


def _stiffness(frequencies: Frequencies, coefficients: Array, cosine: Array, sine: Array) -> Array:
    m, n = frequencies.shape
    k = frequencies.astype(float)
    squares = (k[:, :, None] * k[:, None, :]).reshape(m, n * n)
    products = cosine @ (-coefficients[:m, None] * squares)
    products -= sine @ (coefficients[m:, None] * squares)
    return np.asarray(products.reshape(len(cosine), n, n))


@dataclass(frozen=True, eq=False)
class WeightedFit:
    """Coefficients and constants fitted to samples whose angles and torques both have errors.

    Attributes
    ----------
    estimate : (n + 2 m,) array
        Constant torque of every joint [N m], then the coefficients [J].
    root : (n + 2 m, n + 2 m) array
        Upper triangular root of the normal matrix.
    squares : float
        Weighted sum of squared residuals.
    log_volume : float
        Log determinants that the restricted likelihood adds to it.
    q : (N, n) array
        Angles corrected by their most probable errors [rad].
    whitening : (N, n, n) array
        Inverse Cholesky factors of the covariances of the torques' errors.
    design : (N n, n + 2 m) array
        Columns of constants and features, whitened.
    residual : (N n,) array
        Whitened.
    """

    estimate: Array
    root: Array
    squares: float
    log_volume: float
    q: Array
    whitening: Array
    design: Array
    residual: Array


def weighted_fit(
    q: Array,
    tau: Array,
    frequencies: Frequencies,
    start: Array,
    noise: MeasurementNoise,
    *,
    constants: bool = True,
) -> WeightedFit:
    """Fit coefficients to samples whose angles and torques both have errors.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Samples [rad], [N m].
    frequencies : (m, n) int array
    start : (n + 2 m,) array
        Constants and coefficients to start from.
    noise : MeasurementNoise
        Noise levels, up to a common factor.
    constants : bool
        Whether joints may have constant torques; otherwise these are held at zero.
    """
    count, n = q.shape
    estimate, true_q = start, q
    unit = np.eye(n)
    held = np.zeros((0 if constants else n, len(start)))
    for _ in range(ITERATIONS):
        phase = true_q @ frequencies.T
        cosine, sine = np.cos(phase), np.sin(phase)
        stiffness = _stiffness(frequencies, estimate[n:], cosine, sine)
        transposed = np.swapaxes(stiffness, 1, 2)
        variance = noise.torque**2 * unit + noise.angle**2 * stiffness @ transposed
        whitening = np.linalg.inv(np.linalg.cholesky(variance))
        target = tau - np.einsum("Nij,Nj->Ni", stiffness, q - true_q)
        columns = np.concatenate([whitening, whitening @ _features(frequencies, cosine, sine)], 2)
        design = columns.reshape(count * n, -1)
        white = (whitening @ target[:, :, None]).ravel()
        if len(held):  # as if constants had been measured: zero, far better than any torque
            held[:, :n] = HELD * np.abs(whitening).max() * unit
        previous = estimate
        estimate = solve(
            np.concatenate([design, held]), np.concatenate([white, np.zeros(len(held))]), n
        )
        residual = white - design @ estimate
        squares = float(residual @ residual)
        spread = float(np.sqrt(squares / max(1, white.size - design.shape[1])))
        back = np.swapaxes(whitening, 1, 2) @ residual.reshape(count, n, 1)
        error = -(noise.angle**2) * (transposed @ back)[:, :, 0]
        limit = 4.0 * noise.angle * max(spread, 1e-300)
        true_q = q - np.clip(error, -limit, limit)
        if np.abs(estimate - previous).max() <= 1e-10 * np.abs(estimate).max():
            break
    root: Array = np.asarray(np.linalg.qr(np.concatenate([design, held]), mode="r"))
    diagonals = np.diagonal(whitening, axis1=1, axis2=2)
    log_volume = 2.0 * float(np.log(np.abs(np.diag(root))).sum() - np.log(diagonals).sum())
    return WeightedFit(estimate, root, squares, log_volume, true_q, whitening, design, residual)
