"""Noisy sensors: the learning curve beside the Cramer-Rao bound of the parametric model."""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks.online.learners import QUICK, joint_for_noise
from benchmarks.online.runs import Plan, Run, scheme_run
from benchmarks.online.table import Row, spread
from benchmarks.online.truth import Truth
from isotorque.learning.simulator.settings import SensorNoise

NOISE = SensorNoise(angle=np.deg2rad(0.1), torque=0.01)
SAMPLES = (60, 120, 250, 500, 1000, 2000)


class Recorder:
    """A learner that also keeps the configurations it has learned."""

    def __init__(self, learner: Any) -> None:
        self.learner = learner
        self.kept: list[np.ndarray] = []

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> Recorder:
        """Hand on, and keep the configurations."""
        self.kept.extend(X)
        self.learner.partial_fit(X, y, sample_weight)
        return self

    def predict(self, X: Any) -> Any:
        """Hand on."""
        return self.learner.predict(X)


def noise_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Errors at some numbers of samples, 0.1 degrees and 0.01 Nm of noise, dense set."""
    truth = Truth.of("2r")
    plan = Plan(SAMPLES[-1] + 300, 10, ("dense",))
    errors: dict[int, list[float]] = {samples: [] for samples in SAMPLES}
    bounds: dict[int, list[float]] = {samples: [] for samples in SAMPLES}
    for seed in range(options.few_seeds):
        run, visited = options.store.get(
            f"noise-{seed}", lambda seed=seed: _noisy_run(truth, plan, seed)
        )
        for samples in SAMPLES:
            errors[samples].append(next(e for n, e in run.curve["dense"] if n >= samples))
            bounds[samples].append(cramer_rao(truth, visited[:samples], NOISE))
    for samples in SAMPLES:
        found, bound = errors[samples], statistics.median(bounds[samples])
        yield Row(
            f"2R, noise of 0.1 deg and 0.01 Nm: joint least squares, {samples} samples, dense",
            "-",
            "-",
            "",
            f"{spread(found, ' Nm', 4)}, {len(found)} seeds; Cramer-Rao bound {bound:.4f} Nm, "
            f"{statistics.median(found) / bound:.1f} times it",
        )


def _noisy_run(truth: Truth, plan: Plan, seed: int) -> tuple[Run, np.ndarray]:
    recorders: list[Recorder] = []

    def make(group: Any, _: Any) -> Recorder:
        recorders.append(Recorder(joint_for_noise(group)))
        return recorders[-1]

    run = scheme_run(truth, make, QUICK, plan, seed, noise=NOISE)
    return run, np.array(recorders[-1].kept)


def cramer_rao(truth: Truth, q: np.ndarray, noise: SensorNoise) -> float:
    """Least RMSE on the dense set of an unbiased estimate of the 2R arm's two parameters.

    Parameters
    ----------
    truth : Truth
        The 2R arm.
    q : (m, 2) array
        Configurations at which torque and angles were measured once [rad].
    noise : SensorNoise
        Standard deviations of the measurements.

    Returns
    -------
    float
        The bound [N m].

    Notes
    -----
    g = A (cos q1, 0) + B (cos(q1 + q2), cos(q1 + q2)); angle errors act through the stiffness.
    """
    stiffness = truth.gravity.stiffness(q)
    covariance = noise.torque**2 * np.eye(2) + noise.angle**2 * stiffness @ np.swapaxes(
        stiffness, 1, 2
    )
    rows = _design(q)
    information = np.einsum("mji,mjk,mkl->il", rows, np.linalg.inv(covariance), rows)
    test = _design(truth.sets["dense"])
    variance = np.einsum("mji,ik,mjk->mj", test, np.linalg.inv(information), test)
    return float(np.sqrt(variance.mean()))


def _design(q: np.ndarray) -> np.ndarray:
    """Torques (m, 2) per unit of A and of B, shape (m, 2, 2)."""
    upper, lower = np.cos(q[:, 0]), np.cos(q.sum(axis=1))
    zero = np.zeros_like(lower)
    return np.stack([np.stack([upper, lower], 1), np.stack([zero, lower], 1)], axis=1)
