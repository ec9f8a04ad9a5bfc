"""Levers of silent joints that no sample would have felt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters, torques_of
from isotorque.learning.learners.rigid.planning.information import probe_poses
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

SILENT = 1e-9
"""A joint is silent if its torque stays below this share of the largest,"""
SILENT_NOISE = 2.0
"""or below so many times the noise (both RMS)."""
UNFELT = 0.05
"""A lever is not felt whose torque at the samples is below this share of that elsewhere (RMS)."""
STARTS = 6
PROGRESS = 1e-2
"""A search ends when a step changes the square of the share, or the axes, by less: shares agree to
0.002 with those found to rounding (48 random arms of 2 to 6 joints), a twentieth is asked for."""
MOST_SAMPLES = 60
SMALL = 0.05
"""Torques of a lever of 1 N m below this everywhere mean nothing [N m]."""
STEP = 1e-6
"""Of differences."""


@single_thread()
def unfelt_lever(fit: ChainFit) -> int | None:
    """Find a joint that held no torque, though its link may have a lever that samples do not feel.

    Parameters
    ----------
    fit : ChainFit
        An accepted fit.

    Returns
    -------
    int or None
        The joint, from 0.

    Notes
    -----
    A link without lever has an axis of any direction, so its chain is found with some random one,
    with which every lever would have been felt. But poses may be special: a forearm that always
    hangs needs no torque. So for joints at the end of the chain that held no torque, axes are
    looked for with which a lever is not felt at the samples, and is elsewhere.
    """
    silent = _silent_at_end(fit)
    samples = fit.samples
    last = len(samples.q) - 1
    taken = np.unique(np.linspace(0, last, MOST_SAMPLES).round().astype(int))
    for joint in silent:
        free = [j for j in silent if j <= joint]
        if _share_felt(fit.chain, joint, free, samples.q[taken]) < UNFELT:
            return int(joint)
    return None


def _silent_at_end(fit: ChainFit) -> list[int]:
    """Joints without torque that carry none with torque."""
    samples = fit.samples
    size = np.sqrt(np.mean(samples.torque**2, axis=0))
    limit = np.maximum(SILENT * samples.largest_torque, SILENT_NOISE * samples.torque_noise)
    quiet = size <= limit
    parents = fit.chain.parents
    for joint in range(len(parents) - 1, -1, -1):
        if not quiet[joint] and parents[joint] >= 0:
            quiet[parents[joint]] = False
    return [int(j) for j in np.flatnonzero(quiet)]


def _share_felt(chain: ChainParameters, joint: int, free: list[int], q: Array) -> float:
    """Least torque of a lever at the samples, relative to that elsewhere, whatever the axes."""
    probes = probe_poses(chain.n)
    every = np.concatenate([probes, q])

    def shares(trials: Array) -> Array:
        """Torques (r, N n) at the samples, for directions of the lever and axes (r, p)."""
        axes = Rotation.from_rotvec(trials[:, 1:].reshape(-1, 3)).as_matrix()
        axes = axes.reshape(len(trials), len(free), 3, 3)
        chains = []
        for angle, turned in zip(trials[:, 0], axes, strict=True):
            rotations, levers = chain.rotations.copy(), np.zeros((chain.n, 2))
            rotations[free], levers[joint] = turned, (np.cos(angle), np.sin(angle))
            chains.append(replace(chain, rotations=rotations, levers=levers, gains=one))
        torques = torques_of(chains, every)
        elsewhere = np.sqrt(np.mean(np.sum(torques[:, : len(probes)] ** 2, axis=2), axis=1))
        felt = torques[:, len(probes) :].reshape(len(trials), -1)
        small = elsewhere[:, None] < SMALL
        return np.where(small, 1.0, felt / (elsewhere[:, None] * np.sqrt(len(q))))

    def slopes(x: Array) -> Array:
        """Differences: all of them in one evaluation."""
        found = shares(x + STEP * np.eye(len(x) + 1, len(x), -1))
        return (found[1:] - found[0]).T / STEP

    one, chain = np.ones(chain.n), replace(chain, columns=(), coefficients=np.zeros(0))
    rng = np.random.default_rng(0)
    least = 1.0
    for _ in range(STARTS):
        axes = Rotation.random(len(free), random_state=rng).as_rotvec().ravel()
        start = np.concatenate([rng.uniform(-np.pi, np.pi, 1), axes])
        found = least_squares(
            lambda x: shares(x[None])[0], start, slopes, ftol=PROGRESS, xtol=PROGRESS, max_nfev=40
        )
        least = min(least, float(np.linalg.norm(found.fun)))
        if least < UNFELT:
            break
    return least
