"""Batch learning from lattices: test error with and without symmetries, at equal samples and error.

Usage: python -m benchmarks.batch [--json] [--seeds 3] [--noise DEGREES] [--quick] [ROBOT ...]

Samples are Korobov lattices of the fundamental domain (symmetries ``exact``), of the whole torus
of the combinations of joints that matter (``free``: free directions known, no other symmetry), or
of all joint angles (``none``). Noise is an error of the measured joint angles. The test set is 1500
seeded configurations over all joint angles; RMSE over samples and joints with a torque, in N m.
Several seeds (shift of the lattice, starts of the network, noise) give median and range.

``trigonometric`` and ``parametric`` contain the truth; they stand in their own rows.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.kernel_ridge import KernelRidge
from sklearn.neural_network import MLPRegressor

from benchmarks.batch_tables import Row, equal_errors, tables
from learning.learners.gaussian_process import SymmetricGaussianProcess
from learning.learners.network import FeedForwardNetwork
from learning.learners.static_regressor import StaticRegressor
from learning.learners.trigonometric import EquivariantTrigonometric
from learning.sampling.lattice import lattice_samples
from learning.sampling.sampling_region import SamplingRegion
from learning.symmetry_use import SymmetricSamples
from symbolic.domain import FundamentalDomain
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup, identity
from symbolic.robots import load_robot
from symbolic.symmetries import primary_symmetries

DENSE = 1500
SAMPLES = {
    "2r": {"exact": (2, 4, 8, 16, 32, 64, 128, 255), "none": (8, 16, 32, 64, 128, 255, 510, 2040)},
    "3r": {"exact": (4, 8, 16, 32, 65, 150, 300), "none": (16, 32, 65, 150, 300, 855)},
    "ur5": {"exact": (4, 8, 16, 32), "free": (16, 32, 65, 150), "none": (32, 65, 150, 300)},
    "panda": {"exact": (90, 180), "free": (90, 180), "none": (180, 360)},
}
#: (robot, samples): error demanded of the network with its group, and the paper's.
DEMANDED = {
    ("2r", 255): (1e-4, 0.0051),
    ("2r", 64): (5e-4, None),
    ("3r", 65): (0.02, 0.28),
    ("3r", 300): (0.002, None),
}
#: Learners that are not run beyond so many samples, or joints: too slow for a few minutes.
MOST_SAMPLES = {"gaussian process": 600, "network, augmented": 70, "MLP (scikit-learn)": 300}
MOST_JOINTS = {"network": 6, "network, augmented": 3, "network, canonical": 3}


def circles(learner: Any) -> Any:
    """scikit-learn's learner on cosine and sine of the coordinates."""
    from sklearn.compose import TransformedTargetRegressor
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import FunctionTransformer, StandardScaler

    to_circles = FunctionTransformer(lambda y: np.concatenate([np.cos(y), np.sin(y)], axis=1))
    return TransformedTargetRegressor(
        make_pipeline(to_circles, learner), transformer=StandardScaler(with_mean=False)
    )


def learners(robot: str, samples: int, noise: float, seed: int) -> dict[str, Callable[[Any], Any]]:
    """A fresh learner for a group, by name; ``noise`` is the error of angles [rad]."""
    hidden = 30 if robot == "3r" and samples >= 150 else 18
    network = {"random_state": seed, "validation_fraction": 0.15 if noise else 0.0}

    def of_mode(mode: str) -> Callable[[Any], Any]:
        return lambda group: FeedForwardNetwork(hidden, symmetries=mode, group=group, **network)

    def multilayer(group: Any) -> Any:
        settings = {"solver": "lbfgs", "alpha": 1e-9, "max_iter": 2000, "tol": 1e-9}
        learner = MLPRegressor(
            hidden_layer_sizes=(hidden,), activation="tanh", random_state=seed, **settings
        )
        return SymmetricSamples(circles(learner), group)

    return {
        "network": of_mode("averaged"),
        "network, augmented": of_mode("augmented"),
        "network, canonical": of_mode("canonical"),
        "MLP (scikit-learn)": multilayer,
        "kernel ridge (scikit-learn)": lambda group: SymmetricSamples(
            circles(KernelRidge(alpha=1e-8 if not noise else 1e-2, kernel="rbf", gamma=0.1)), group
        ),
        "gaussian process": lambda group: SymmetricGaussianProcess(
            noise=None if noise else 0.0, group=group
        ),
        "trigonometric": lambda group: EquivariantTrigonometric(group=group),
        "parametric": lambda group: StaticRegressor(robot, group=group),
    }


def measure(name: str, seeds: int, noise_degrees: float, quick: bool) -> list[Row]:
    """Run all learners on one robot."""
    robot = load_robot(name)
    gravity = GravityModel(robot)
    exact = primary_symmetries(gravity.potential)
    groups: dict[str, SymmetryGroup | None] = {
        "exact": exact,
        "free": SymmetryGroup([identity(robot.n, exact.basis)]),
        "none": None,
    }
    dense = np.random.default_rng(2018).uniform(-np.pi, np.pi, (DENSE, robot.n))
    truth = gravity.torque(dense)
    active = np.abs(truth).max(axis=0) > 1e-9
    noise = np.deg2rad(noise_degrees)
    rows = []
    for kind, counts in SAMPLES[name].items():
        group = groups[kind]
        region = (
            SamplingRegion.of_box(np.tile([-np.pi, np.pi], (robot.n, 1)))
            if group is None
            else SamplingRegion.of_domain(FundamentalDomain(group))
        )
        for count in counts[:3] if quick else counts:
            for learner in learners(name, count, noise, 0):
                plain = kind != "exact" and learner.startswith("network,")
                slow = robot.n > MOST_JOINTS.get(learner, 7) or (
                    count > MOST_SAMPLES.get(learner, 5000)
                )
                if plain or slow:
                    continue
                errors, shares, seconds = [], [], []
                for seed in range(seeds):
                    rng = np.random.default_rng(seed)
                    q = lattice_samples(region, count, rng).q
                    torque = gravity.torque(q)
                    measured = q + noise * rng.normal(size=q.shape)
                    start = time.process_time()
                    fitted = learners(name, count, noise, seed)[learner](group)
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore", ConvergenceWarning)
                        fitted.fit(measured, torque)
                    seconds.append(time.process_time() - start)
                    error = (fitted.predict(dense) - truth)[:, active]
                    errors.append(float(np.sqrt(np.mean(error**2))))
                    by_joint = np.sqrt(np.mean(error**2, axis=0))
                    shares.append(float((by_joint / np.abs(truth[:, active]).max()).max()))
                judged = kind == "exact" and learner == "network" and not noise
                demanded, paper = (
                    DEMANDED.get((name, count), (None, None)) if judged else 2 * (None,)
                )
                rows.append(
                    Row(
                        robot=name,
                        learner=learner,
                        symmetries=kind,
                        samples=count,
                        noise_degrees=noise_degrees,
                        errors=errors,
                        share_of_max=statistics.median(shares),
                        seconds=statistics.median(seconds),
                        demanded=demanded,
                        paper=paper,
                    )
                )
                print(rows[-1], file=sys.stderr)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", default=list(SAMPLES), help="arms, all by default")
    parser.add_argument("--json", action="store_true", help="write JSON instead of tables")
    parser.add_argument("--seeds", type=int, default=3, help="seeds per entry")
    parser.add_argument("--noise", type=float, default=0.0, help="error of angles [degrees]")
    parser.add_argument("--quick", action="store_true", help="only the shortest curves")
    options = parser.parse_args()
    rows = []
    for name in options.robots:
        rows += measure(name, options.seeds, options.noise, options.quick)
    if options.json:
        print(
            json.dumps({"rows": [asdict(r) for r in rows], "equal": equal_errors(rows)}, indent=1)
        )
    else:
        print(tables(rows))


if __name__ == "__main__":
    main()
