"""Arms with cables and springs: a rigid chain, processes on what it leaves, and both refitted.

Usage: python -m benchmarks.chain.process [--seeds 10] [--write]

The arms are the built-in ones with a cable (a wave of twice the angle, of random phase) and a
spring at every joint, each of random size up to 4 % of the joint's largest torque, and links that
bend: a product of two neighbouring angles' waves of up to 2 %. Torques have noise of 0.2 % of the
arm's largest. Errors are against the torque without noise at 500 fresh poses of the same region
(2 rad about zero). With ``--write`` the table goes into docs/rigid-chain.md.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from benchmarks.shared.document import write_between
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.rigid.process.residual_process import ResidualProcess
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[2] / "docs" / "rigid-chain.md"
MARK = "python -m benchmarks.chain.process --write"

ROBOTS = ("2r", "ur5", "panda")
POSES = (15, 30, 60)
REACH, FRESH = 2.0, 500
CABLE, SPRING, BENDING, NOISE = 0.04, 0.04, 0.02, 0.002


@dataclass(frozen=True, eq=False)
class NearlyRigidArm:
    """The torque of an arm with cables, springs and bending.

    Attributes
    ----------
    gravity : GravityModel
        Of the rigid arm.
    peak : (n,) array
        Largest torque of each joint [N m].
    cables, phases, springs, bendings : (n,) arrays
        Sizes relative to the peaks; phases [rad].
    """

    gravity: GravityModel
    peak: Array
    cables: Array
    phases: Array
    springs: Array
    bendings: Array

    @classmethod
    def draw(cls, gravity: GravityModel, rng: np.random.Generator) -> NearlyRigidArm:
        """An arm of random sizes."""
        n = gravity.n
        q = np.random.default_rng(0).uniform(-np.pi, np.pi, (1000, n))
        peak = np.abs(gravity.torque(q)).max(axis=0)
        sizes = (rng.uniform(-size, size, n) for size in (CABLE, SPRING, BENDING))
        cables, springs, bendings = sizes
        return cls(gravity, peak, cables, rng.uniform(0, 2 * np.pi, n), springs, bendings)

    def torque(self, q: Array) -> Array:
        """At configurations (m, n) [rad], (m, n) [N m]."""
        beside = self.cables * np.sin(2.0 * q + self.phases) + self.springs * q / REACH
        beside = beside + self.bendings * np.sin(q) * np.cos(np.roll(q, 1, axis=1))
        return np.asarray(self.gravity.torque(q) + self.peak * beside)


def errors(robot: str, poses: int, seed: int) -> tuple[list[float], list[float]]:
    """RMS errors of the four ways [N m], and how often 1.645 and 3 standard errors hold."""
    rng = np.random.default_rng(seed)
    arm = NearlyRigidArm.draw(GravityModel(load_robot(robot)), rng)
    q, fresh = (rng.uniform(-REACH, REACH, (m, arm.gravity.n)) for m in (poses, FRESH))
    noise = NOISE * arm.peak.max() * rng.normal(size=q.shape)
    measured, true = arm.torque(q) + noise, arm.torque(fresh)
    chain = RigidChain(unknown_offsets=True, random_state=seed).fit(q, measured).fit_.chain
    rest = measured - chain.torque(q)
    processes = [ResidualProcess.fitted_to(j, q, rest[:, j]) for j in range(arm.gravity.n)]
    left = chain.torque(fresh) + np.stack([p.mean(fresh) for p in processes], axis=1)
    both = RigidChainProcess(random_state=seed).fit(q, measured)
    alone = SymmetricGaussianProcess(None).fit(q, measured)
    refitted = np.mean([model.torque(fresh) for model in both.models_], axis=0)
    found = [chain.torque(fresh), left, refitted, alone.predict(fresh)]
    held = [float("nan")] * 2
    if both.verdict_.accepted:
        ratio = np.abs(refitted - true) / np.maximum(both.standard_error(fresh), 1e-12)
        held = [float(np.mean(ratio <= limit)) for limit in (1.645, 3.0)]
    return [float(np.sqrt(np.mean((x - true) ** 2))) for x in found], held


def table(seeds: int, say: Callable[[str], None]) -> str:
    """The measurements in Markdown."""
    lines = [
        "| arm, poses | chain alone | process on what it leaves | both refitted | process alone "
        "| 1.645 and 3 standard errors hold |",
        "|---|---|---|---|---|---|",
    ]
    for robot in ROBOTS:
        for poses in POSES:
            found = [errors(robot, poses, seed) for seed in range(seeds)]
            median = np.median([rms for rms, _ in found], axis=0)
            held = np.array([held for _, held in found])
            judged = ~np.isnan(held[:, 0])
            covered = "not accepted"
            if judged.any():
                mean = 100.0 * held[judged].mean(axis=0)
                covered = f"{mean[0]:.1f} %, {mean[1]:.1f} % ({judged.sum()} of {seeds} accepted)"
            cells = [f"{robot}, {poses}", *(f"{x:.3g}" for x in median), covered]
            lines.append("| " + " | ".join(cells) + " |")
            say(lines[-1])
    return "\n".join(lines)


def main() -> int:
    """Print the table; with ``--write`` put it into the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args()
    text = table(options.seeds, print)
    if options.write:
        write_between(PAGE, MARK, text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
