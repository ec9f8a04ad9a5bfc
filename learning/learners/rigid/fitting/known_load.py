"""What a known load tells of gains: the factor that all joints have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

ROUNDING = 1e-6
"""Torques that the load leaves unexplained, relative to the largest: rounding ..."""
DEVIATIONS = 6.0
"""... or so many times their noise (RMS)."""
OPEN_VALUE = 1e-6
"""Singular values below, relative to the largest, and shares of a lever, are not determined."""
OPEN_SHARE = 0.1
"""A gain that is known no better than so (standard error, relative) is not known."""


@dataclass(frozen=True)
class LoadedGain:
    """The gain of the joint whose link carries a known load.

    Attributes
    ----------
    gain : float
        Measured torque over true torque [1/(N m)].
    standard_error : float
        Of it.
    """

    gain: float
    standard_error: float


@single_thread()
def gain_from_load(
    fit: ChainFit,
    q: ArrayLike,
    torque: ArrayLike,
    joint: int,
    moment: float,
    where: str = "load",
    replicas: Sequence[ChainParameters] = (),
) -> LoadedGain:
    """Find the gain of a joint from a second recording, with a known load on its link.

    Parameters
    ----------
    fit : ChainFit
        Accepted chain of the arm without the load, gains known up to a common factor.
    q, torque : (m, n) array_like
        Configurations [rad] and measured torques with the load.
    joint : int
        Number of the joint whose link carries the load.
    moment : float
        Weight of the load times the distance of its centre from the axis of that joint [N m]: the
        most that the load can add to its torque.
    where : str
        Names the recording in errors.
    replicas : sequence of ChainParameters
        Chains of repeated experiments (`TorqueErrors.replicas`): they tell how much the error of
        the chain, of its last axes above all, adds to that of the gain.

    Notes
    -----
    A load adds to the lever of its own link the vector weight times position, of which the part
    across the axis is ``moment`` long, and something to the levers of the links before. All are
    linear in the torques that the load adds. That the gains are positive in their common factor
    is taken for granted: no load tells a reversed current from a reversed arm.

    Raises
    ------
    InputError
        If the additional torques are not those of a load on that link, or tell too little.
    """
    angles, measured = np.asarray(q, dtype=float), np.asarray(torque, dtype=float)
    n = fit.chain.n
    slopes = fit.chain.derivatives(angles, raw_directions(n)).leant.reshape(-1, 2 * n)
    added = (measured - fit.chain.torque(angles)).ravel()
    largest = float(np.abs(measured).max(initial=0.0))
    noise = np.maximum(fit.samples.torque_noise, ROUNDING / DEVIATIONS * largest)
    leaning = np.sum((fit.chain.stiffness(angles) * fit.samples.angle_noise) ** 2, axis=2)
    # the chain errs as well; where it does not know a torque, that torque does not count
    weights = (noise**2 + leaning + fit.standard_error(angles) ** 2).ravel() ** -0.5
    _, values, rows = np.linalg.svd(slopes * weights[:, None])
    kept = np.zeros(2 * n, dtype=bool)
    kept[: len(values)] = values > OPEN_VALUE * values.max()
    if np.abs(rows[~kept][:, 2 * joint : 2 * joint + 2]).max(initial=0.0) > OPEN_VALUE:
        accepted = f"more poses than {len(angles)}, in which joint {joint + 1} carries the load"
        lever = f"lever of the load at joint {joint + 1}"
        raise InputError(where, lever, "not determined", accepted)
    half = (rows[kept] / values[kept[: len(values)], None]).T
    covariance = half @ half.T
    levers = covariance @ (slopes.T @ (added * weights**2))
    rest = (added - slopes @ levers) * weights
    if np.sqrt(np.mean(rest**2)) > DEVIATIONS:
        left = np.sqrt(np.mean((added - slopes @ levers) ** 2))
        value = f"leaves {left:.3g} (RMS) of the torques unexplained"
        raise InputError(where, "load", value, "the same arm and sensors, with more weight alone")
    vectors = levers.reshape(n, 2)
    size = np.linalg.norm(vectors, axis=1)
    spread = np.sqrt([np.trace(covariance[2 * j : 2 * j + 2, 2 * j : 2 * j + 2]) for j in range(n)])
    beyond = [j for j in range(joint + 1, n) if size[j] > DEVIATIONS * spread[j]]
    if beyond:
        value = f"on the link of joint {beyond[-1] + 1}, beyond joint {joint + 1}"
        raise InputError(where, "load", value, f"a load on the link of joint {joint + 1}")
    if not spread[joint] < OPEN_SHARE * size[joint]:
        value = f"{size[joint]:.3g}, known to {spread[joint]:.2g} in {len(angles)} poses"
        accepted = "more poses, a heavier load, or one farther from the axis"
        raise InputError(where, f"lever of the load at joint {joint + 1}", value, accepted)
    gain = float(fit.chain.gains[joint] * size[joint] / moment)
    error = gain * spread[joint] / size[joint]
    others = []
    for chain in replicas:
        slopes = chain.derivatives(angles, raw_directions(n)).leant.reshape(-1, 2 * n)
        added = (measured - chain.torque(angles)).ravel()
        levers = np.linalg.lstsq(slopes * weights[:, None], added * weights, rcond=OPEN_VALUE)[0]
        size_there = np.linalg.norm(levers[2 * joint : 2 * joint + 2])
        others.append(chain.gains[joint] * size_there / moment - gain)
    if others:
        error = np.hypot(error, np.sqrt(np.mean(np.square(others))))
    if not error < OPEN_SHARE * abs(gain):
        accepted = "more poses of both recordings, or less noise"
        found = f"{gain:.3g} +- {error:.2g}"
        raise InputError(where, f"gain of joint {joint + 1}", found, accepted)
    return LoadedGain(gain, float(error))
