"""Poses to measure where a recording has too few for a chain: which, and what is known already."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.planning.pose_plan import plan_poses_within
from isotorque.learning.learners.rigid.planning.poses_needed import most_parameters
from isotorque.runs.from_data.chain_plan import NOMINAL

Array = NDArray[np.float64]

REGION = 200
"""Random poses that stand for the region."""
UNCOUNTED = 2
"""Poses that are proposed where it cannot be counted how many are missing."""
LEAST_RANGE = 1.0
"""Joints that moved less [rad] are taken to be able to move as much, about where they were."""


@dataclass(frozen=True, eq=False)
class PosesToTake:
    """What would settle a chain that is not settled.

    Attributes
    ----------
    poses : (k, n) array
        To measure next [rad].
    known, numbers : int
        How many of the numbers of a chain the samples determine, were it the one that was found.
    """

    poses: Array
    known: int
    numbers: int


def poses_to_take(fit: ChainFit, seed: int = 0) -> PosesToTake | None:
    """The most telling poses for a chain of which there are too few samples.

    The best chain that was found serves as a first guess: it must not be used for torques, but
    poses that would tell much of it tell much of its rivals. Within the ranges that were recorded,
    where joints moved.

    Returns
    -------
    PosesToTake or None
        None where more poses are not what is missing.
    """
    if fit.verdict not in (FitStatus.TOO_FEW, FitStatus.AMBIGUOUS):
        return None
    samples = fit.samples
    low, high = samples.q.min(axis=0), samples.q.max(axis=0)
    wider = np.maximum(LEAST_RANGE - (high - low), 0.0) / 2.0
    low, high = low - wider, high + wider
    noise = samples.torque_noise
    if not noise.any() and not samples.angle_noise.any():
        noise = np.full(samples.n, NOMINAL * max(samples.largest_torque, 1e-9))
    region = np.random.default_rng(seed).uniform(low, high, (REGION, samples.n))
    plan = plan_poses_within(
        fit.chain,
        fit.model.free,
        samples.with_torque_noise(noise),
        low,
        high,
        region,
        fit.missing or UNCOUNTED,
        random_state=seed,
    )
    return PosesToTake(plan.poses, fit.information.rank, most_parameters(fit.model))
