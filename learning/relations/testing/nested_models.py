"""F and chi-square tests of nested models: whether more functions explain more than chance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.potential.potential_fit import ROUNDING
from isotorque.learning.relations.testing.basis_functions import Functions
from isotorque.learning.statistics.tails import tail_probability

Array = NDArray[np.float64]
RATIOS = np.geomspace(0.01, 30.0, 8)  # torque noise over angle noise times slope
ROUNDS = 2
LEAST = 0.5  # of the median: the least deviation of any sample where the noise is estimated
DEPENDENT = 1e-9  # singular values below it, relative to the largest, are rounding


@dataclass(frozen=True, eq=False)
class Scales:
    """Scales of the errors of a joint's torques, sample by sample.

    Attributes
    ----------
    deviation : (N,) array
        Standard deviations of the errors [N m]; up to one common factor where ``known`` is not.
    known : bool
        Whether the noise was given.
    floor : float
        Arithmetic: errors below it are none [N m].
    """

    deviation: Array
    known: bool
    floor: float


@dataclass(frozen=True)
class Comparison:
    """A small model held against a larger one that contains it.

    Attributes
    ----------
    p_value : float
        Probability of such an improvement, or a larger one, if the small model is true.
    difference : float
        Root mean square, over the samples, of the difference of both fits [N m].
    resolution : float
        How large that difference would be by noise alone [N m].
    """

    p_value: float
    difference: float
    resolution: float


def rank_of(functions: Functions) -> int:
    """Number of independent functions among them, as far as the samples tell."""
    return _span(functions.values).shape[1]


def scales(
    functions: Sequence[Functions], torques: Array, noise: MeasurementNoise | None
) -> list[Scales]:
    """Errors of the samples of every joint, by the models that leave most open.

    Parameters
    ----------
    functions : sequence of n Functions
        Of the largest model of each joint.
    torques : (N, n) array
        Torques [N m].
    noise : MeasurementNoise, optional
        Noise levels where known. Otherwise the ratio of the noise of angles, which acts through
        the slopes of the torques, and of torques is taken to be one for all joints: that of the
        largest restricted likelihood.

    Notes
    -----
    Slopes come from a first fit, weighted by what follows from an unweighted one.
    """
    floor = ROUNDING * max(float(np.abs(torques).max(initial=0.0)), 1e-100)  # its square is > 0
    pairs = list(zip(functions, torques.T, strict=True))
    slopes = np.array([_slopes(f, tau, np.ones(len(tau))) for f, tau in pairs])
    deviations = slopes
    for _ in range(ROUNDS):
        if noise is not None:
            deviations = np.sqrt(noise.torque**2 + noise.angle**2 * slopes**2 + floor**2)
        else:
            deviations = _most_likely(functions, torques, slopes, floor)
        slopes = np.array(
            [_slopes(*pair, weight) for pair, weight in zip(pairs, deviations, strict=True)]
        )
    return [Scales(deviation, noise is not None, floor) for deviation in deviations]


def _most_likely(
    functions: Sequence[Functions], torques: Array, slopes: Array, floor: float
) -> Array:
    """Deviations (n, N), up to a factor, of the ratio with the largest restricted likelihood."""
    typical = max(float(np.sqrt(np.mean(slopes**2))), floor)
    bases = [_span(f.values) for f in functions]
    freedom = max(1, sum(basis.shape[0] - basis.shape[1] for basis in bases))

    def deviance(log_ratio: float) -> float:
        deviations = np.hypot(np.exp(log_ratio), slopes / typical)
        squares, volume = 0.0, float(np.log(deviations).sum())
        for basis, torque, deviation in zip(bases, torques.T, deviations, strict=True):
            span, root = np.linalg.qr(basis / deviation[:, None])
            white = torque / deviation
            rest = white - span @ (span.T @ white)
            squares += float(rest @ rest)
            volume += float(np.log(np.abs(np.diag(root))).sum())
        return freedom * float(np.log(max(squares / freedom, floor**2))) + 2.0 * volume

    ratios = np.log(RATIOS)
    start = int(np.argmin([deviance(ratio) for ratio in ratios]))
    bracket = ratios[max(0, start - 1)], ratios[min(len(ratios) - 1, start + 1)]
    best = minimize_scalar(deviance, bounds=bracket, method="bounded", options={"xatol": 0.05})
    deviations = np.hypot(np.exp(best.x), slopes / typical)
    # where the torque happens to be level the estimated noise is least sure: trust it less
    return np.asarray(np.maximum(deviations, LEAST * np.median(deviations, axis=1)[:, None]))


def compare(small: Functions, large: Functions, torque: Array, scale: Scales) -> Comparison | None:
    """Test a small model against a larger one; None where the samples cannot tell them apart."""
    weights = 1.0 / scale.deviation
    white = torque * weights
    wide = _span(large.values * weights[:, None])
    narrow = _span(small.values * weights[:, None])
    degrees = wide.shape[1] - narrow.shape[1]
    freedom = len(torque) - wide.shape[1]
    if degrees <= 0 or (freedom < 1 and not scale.known):
        return None
    fitted = wide @ (wide.T @ white)
    gain = fitted - narrow @ (narrow.T @ fitted)
    if scale.known:
        variance, freedom_of_test = 1.0, np.inf
    else:
        rest = white - fitted
        least = (scale.floor / np.sqrt(np.mean(scale.deviation**2))) ** 2
        variance, freedom_of_test = max(float(rest @ rest) / freedom, least), float(freedom)
    statistic = float(gain @ gain) / variance
    spread = np.sqrt(variance) * float(np.sqrt(np.mean(scale.deviation**2)))
    return Comparison(
        tail_probability(statistic, degrees, freedom_of_test),
        float(np.sqrt(np.mean((gain * scale.deviation) ** 2))),
        spread * float(np.sqrt(degrees / len(torque))),
    )


def _slopes(functions: Functions, torque: Array, deviation: Array) -> Array:
    """Length of the gradient of the fitted torque at every sample (N,) [N m / rad]."""
    weights = 1.0 / deviation
    solution = np.linalg.lstsq(functions.values * weights[:, None], torque * weights, DEPENDENT)[0]
    return np.asarray(np.linalg.norm(np.einsum("Npn,p->Nn", functions.slopes, solution), axis=1))


def _span(columns: Array) -> Array:
    """Orthonormal columns that span the same."""
    if not columns.shape[1]:
        return np.zeros((len(columns), 0))
    size = np.linalg.norm(columns, axis=0)
    left, singular, _ = np.linalg.svd(columns / np.where(size > 0, size, 1.0), full_matrices=False)
    return np.asarray(left[:, singular > DEPENDENT * max(singular[0], 1e-300)])
