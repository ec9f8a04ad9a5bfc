"""Optimal design against a lattice: torque error of noisy samples, chosen or evenly spread.

Usage: python -m benchmarks.batch.design [--write] [--seeds 30] [ROBOT ...]

Angles are off by 0.5 degrees, torques by 0.02 N m. A quarter of the samples (at least four) are a
lattice in the BCTS; they give the first fit, from which the rest is chosen among 200 configurations
of another lattice. The same number of samples on one lattice stands beside. Errors on 800 seeded
configurations over all joint angles, RMS over the seeds; in brackets their middle half.
"""

from __future__ import annotations

import argparse
import os
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.optimal_design import d_optimal, least_variance
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

PAGE = Path(__file__).parents[2] / "docs" / "batch.md"
NOISE = MeasurementNoise(float(np.deg2rad(0.5)), 0.02)
SAMPLES = (8, 16, 32, 64)
CANDIDATES, DENSE, FIRST = 200, 800, 4


class Bench:
    """A robot whose torques are measured with noise."""

    def __init__(self, name: str) -> None:
        self.gravity = GravityModel(load_robot(name))
        self.group = primary_symmetries(self.gravity.potential)
        self.region = SamplingRegion.of_domain(FundamentalDomain(self.group))
        self.q = np.random.default_rng(2018).uniform(-np.pi, np.pi, (DENSE, self.gravity.n))
        self.truth = self.gravity.torque(self.q)

    def _lattice(self, count: int, rng: np.random.Generator) -> np.ndarray:
        return lattice_samples(self.region, count, rng, exact=False).q

    def _measured(self, q: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
        angles = q + NOISE.angle * rng.normal(size=q.shape)
        return [angles, self.gravity.torque(q) + NOISE.torque * rng.normal(size=q.shape)]

    def _learner(self, name: str) -> Any:
        if name == "trigonometric":
            return EquivariantTrigonometric(group=self.group)
        return SymmetricGaussianProcess(None, group=self.group)

    def _error(self, learner: Any) -> float:
        return float(np.sqrt(np.mean((learner.predict(self.q) - self.truth) ** 2)))

    def on_lattice(self, name: str, count: int, seed: int) -> float:
        """Error with all samples on one lattice."""
        rng = np.random.default_rng([seed, count])
        return self._error(self._learner(name).fit(*self._measured(self._lattice(count, rng), rng)))

    def designed(self, name: str, count: int, seed: int) -> float:
        """Error where most samples are chosen by what the first ones said."""
        rng = np.random.default_rng([seed, count])
        first = self._measured(self._lattice(max(FIRST, count // 4), rng), rng)
        candidates, more = self._lattice(CANDIDATES, rng), count - len(first[0])
        fit = self._learner(name).fit(*first)
        if name == "trigonometric":
            chosen = d_optimal(
                self.group,
                candidates,
                more,
                noise=NOISE,
                potential=fit.fitted_potential(),
                known=first[0],
            )
        else:
            chosen = least_variance(fit, candidates, more, noise=NOISE)
        both = [
            np.concatenate(pair) for pair in zip(first, self._measured(chosen.q, rng), strict=True)
        ]
        return self._error(self._learner(name).fit(*both))


def rms(errors: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(errors))))


def lattice_samples_for(error: float, curve: dict[int, float]) -> str:
    """How many lattice samples give an error, interpolated between the numbers tried."""
    counts = sorted(curve)
    if error < curve[counts[-1]]:
        return f"more than {counts[-1]}"
    logs = np.log([curve[n] for n in counts])
    return f"{np.exp(np.interp(-np.log(error), -logs, np.log(counts))):.0f}"


def table(names: list[str], seeds: int) -> str:
    """The comparison as Markdown."""
    head = ["robot", "learner", "samples", "lattice, RMSE [N m]", "optimal design, RMSE [N m]"]
    head += ["lattice samples for the same error"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for name in names:
        bench = Bench(name)
        for learner in ("trigonometric", "gaussian process"):
            chosen = SAMPLES if learner == "trigonometric" else SAMPLES[1:]
            lattice = {n: [bench.on_lattice(learner, n, s) for s in range(seeds)] for n in chosen}
            curve = {n: rms(errors) for n, errors in lattice.items()}
            for count in chosen[:-1]:
                errors = [bench.designed(learner, count, s) for s in range(seeds)]
                cells = [name, learner, str(count)]
                for found in (lattice[count], errors):
                    low, high = np.quantile(found, [0.25, 0.75])
                    cells.append(f"{rms(found):.2g} ({low:.2g} .. {high:.2g})")
                cells.append(lattice_samples_for(rms(errors), curve))
                lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


@clear_errors
def main() -> int:
    """Measure and print the table, or write it into its page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", default=["2r", "3r", "ur5"])
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args()
    text = table(options.robots, options.seeds)
    print(text)
    if options.write:
        write_between(PAGE, "design", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
