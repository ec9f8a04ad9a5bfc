"""Batch learning from lattices: test error with and without symmetries, at equal samples and error.

Usage: python -m benchmarks.batch [--json] [--seeds 3] [--noise 0,0.1,0.5] [--write] [ROBOT ...]

Samples are Korobov lattices of the fundamental domain (symmetries ``exact``; ``learned`` where the
group was learned from other samples, as noisy as these), of the whole torus of the combinations of
joints that matter (``free``: free directions known, no other symmetry), or of all joint angles
(``none``). Noise is an error of the measured joint angles. The test set is 1500 seeded
configurations over all joint angles; RMSE over samples and joints with a torque, in N m; beside it
that on the paper's targets. Several seeds (shift of the lattice, starts of the network, noise) give
median and range.

``trigonometric`` and ``parametric`` contain the truth; they stand in their own rows. ``--write``
puts the tables into docs/batch.md.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
import warnings
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from sklearn.exceptions import ConvergenceWarning

from benchmarks.batch.learners import learners, runs
from benchmarks.batch.tables import Row, equal_errors, tables
from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import identity
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.paper_targets import paper_targets

PAGE = Path(__file__).parents[2] / "docs" / "batch.md"
DENSE = 1500
#: Samples tried, by robot and symmetries.
SAMPLES = {
    "2r": {
        "exact": (2, 4, 8, 16, 32, 64, 128, 255),
        "learned": (2, 16, 64, 255),
        "none": (8, 16, 32, 64, 128, 255, 510, 2040),
    },
    "3r": {
        "exact": (4, 8, 16, 32, 65, 150, 300),
        "learned": (4, 16, 65, 150),
        "none": (16, 32, 65, 150, 300, 855),
    },
    "ur5": {
        "exact": (4, 8, 16, 32, 65),
        "learned": (4, 16, 65),
        "free": (16, 32, 65, 150),
        "none": (32, 65, 150, 300),
    },
    "panda": {"exact": (90, 180, 360, 720), "free": (180, 360), "none": (180, 360)},
}
#: The same where samples are noisy.
NOISY = {
    "2r": {"exact": (16, 64, 255), "learned": (64,), "none": (64, 255)},
    "3r": {"exact": (16, 65, 150), "learned": (65,), "none": (65, 150, 300)},
    "ur5": {"exact": (16, 65), "learned": (65,), "none": (150,)},
}
#: Samples, not counted above, from which a group is learned: without and with noise.
TO_LEARN_GROUP = {"2r": (30, 120), "3r": (60, 200), "ur5": (300, 600)}
#: (robot, learner with its group, samples): error demanded, and the paper's.
DEMANDED: dict[tuple[str, str, int], tuple[float, float | None]] = {
    ("2r", "network", 255): (1e-4, 0.0051),
    ("2r", "network", 64): (5e-4, None),
    ("3r", "network", 65): (0.02, 0.28),
    ("3r", "network", 300): (0.002, None),
    ("2r", "trigonometric", 2): (1e-12, None),
    ("3r", "trigonometric", 4): (1e-12, None),
}


class Bench:
    """One robot, its true torques, and groups of several origins."""

    def __init__(self, name: str, noise_degrees: float) -> None:
        self.name, self.noise = name, float(np.deg2rad(noise_degrees))
        self.noise_degrees = noise_degrees
        robot = load_robot(name)
        self.n, self.gravity = robot.n, GravityModel(robot)
        self.exact = primary_symmetries(self.gravity.potential)
        q = np.random.default_rng(2018).uniform(-np.pi, np.pi, (DENSE, robot.n))
        sets = [("dense", q), *((str(len(t.q)), t.q) for t in paper_targets(robot)[:2])]
        self.targets = [(label, q, self.gravity.torque(q)) for label, q in sets]
        truth = self.targets[0][2]
        self.active = np.abs(truth).max(axis=0) > 1e-9
        self.largest = np.abs(truth[:, self.active]).max()

    def samples(self, q: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """What is measured at q: noisy angles, true torques."""
        return q + self.noise * rng.normal(size=q.shape), self.gravity.torque(q)

    def group(self, kind: str, seed: int) -> SymmetryGroup | None:
        """The group a learner is given."""
        if kind == "learned":
            rng = np.random.default_rng([seed, 1])
            count = TO_LEARN_GROUP[self.name][self.noise > 0]
            q = rng.uniform(-np.pi, np.pi, (count, self.n))
            return learn_relations(*self.samples(q, rng)).group
        if kind == "free":
            return SymmetryGroup([identity(self.n, self.exact.basis)])
        return self.exact if kind == "exact" else None

    def row(self, learner: str, kind: str, count: int, seeds: int) -> Row:
        """Fit and test one learner."""
        errors, shares, seconds, orders = [], [], [], []
        paper: dict[str, list[float]] = {label: [] for label, *_ in self.targets[1:]}
        for seed in range(seeds):
            group = self.group(kind, seed)
            orders.append(1 if group is None else group.order)
            region = (
                SamplingRegion.of_box(np.tile([-np.pi, np.pi], (self.n, 1)))
                if group is None
                else SamplingRegion.of_domain(FundamentalDomain(group))
            )
            rng = np.random.default_rng(seed)
            measured, torque = self.samples(lattice_samples(region, count, rng).q, rng)
            start = time.process_time()
            fitted = learners(self.name, count, self.noise, seed)[learner](group)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                fitted.fit(measured, torque)
            seconds.append(time.process_time() - start)
            for label, q, truth in self.targets:
                error = (fitted.predict(q) - truth)[:, self.active]
                rmse = float(np.sqrt(np.mean(error**2)))
                (errors if label == "dense" else paper[label]).append(rmse)
                if label == "dense":
                    by_joint = np.sqrt(np.mean(error**2, axis=0))
                    shares.append(float((by_joint / self.largest).max()))
        demanded: float | None = None
        printed: float | None = None
        if kind == "exact" and not self.noise:
            demanded, printed = DEMANDED.get((self.name, learner, count), (None, None))
        return Row(
            robot=self.name,
            learner=learner,
            symmetries=kind,
            samples=count,
            noise_degrees=self.noise_degrees,
            errors=errors,
            on_paper_targets={label: statistics.median(found) for label, found in paper.items()},
            share_of_max=statistics.median(shares),
            seconds=statistics.median(seconds),
            order=statistics.median(orders),
            demanded=demanded,
            paper=printed,
        )


def measure(name: str, seeds: int, noise_degrees: float, quick: bool) -> list[Row]:
    """Run all learners on one robot."""
    plan = (NOISY if noise_degrees else SAMPLES).get(name, {})
    bench = Bench(name, noise_degrees)
    rows = []
    for kind, counts in plan.items():
        for count in counts[:3] if quick else counts:
            for learner in learners(name, count, bench.noise, 0):
                if runs(learner, bench.n, count, kind, bench.noise):
                    rows.append(bench.row(learner, kind, count, seeds))
                    print(rows[-1], file=sys.stderr)
    return rows


def run(names: Sequence[str], seeds: int, noises: Sequence[float], quick: bool) -> list[Row]:
    """All rows.

    Raises
    ------
    InputError
        For a robot that no plan names.
    """
    for name in names:
        if name not in SAMPLES:
            raise InputError("command line", "robots", name, ", ".join(SAMPLES))
    return [row for noise in noises for name in names for row in measure(name, seeds, noise, quick)]


@clear_errors
def main() -> int:
    """Measure and print the tables, or write them into their page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", default=list(SAMPLES), help="arms, all by default")
    parser.add_argument("--json", action="store_true", help="write JSON instead of tables")
    parser.add_argument("--seeds", type=int, default=3, help="seeds per entry")
    parser.add_argument("--noise", default="0,0.1,0.5", help="errors of angles [degrees]")
    parser.add_argument("--quick", action="store_true", help="only the shortest curves")
    parser.add_argument("--write", action="store_true", help=f"put the tables into {PAGE.name}")
    options = parser.parse_args()
    noises = [float(x) for x in options.noise.split(",")]
    start = time.process_time()
    rows = run(options.robots, options.seeds, noises, options.quick)
    minutes = (time.process_time() - start) / 60
    if options.json:
        found = {"rows": [asdict(r) for r in rows], "equal": equal_errors(rows), "minutes": minutes}
        print(json.dumps(found, indent=1))
        return 0
    text = tables(rows) + f"\n\nMeasured in {minutes:.1f} minutes on one core."
    print(text)
    if options.write:
        write_between(PAGE, "batch", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
