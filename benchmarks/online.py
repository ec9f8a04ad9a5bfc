"""Learn online on the simulated arm and count samples: the table of the online learners.

Usage: python -m benchmarks.online [--seeds 20] [--long-seeds 3] [--only ROW ...] [--long]

Every run is the whole scheme: symmetries and static torques are discovered by the arm itself
(those samples are counted apart), then it explores and learns. A threshold counts as reached at
the first evaluation after which the error stays below it to the end of the run. Errors are root
mean squares over joints and test configurations, on 1,500 of the whole torus ("dense", on the 3R
arm also its stable part: configurations with a stable member in their orbit) and on the paper's
66 grid and 90 scattered targets. Medians over seeds, the worst seed beside them.

--long adds the 300,000 samples of the literal learner (one seed, some minutes).
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from benchmarks.online_rows import Row, table
from isotorque.paper_targets import paper_targets
from learning.exploration.strategies import (
    DirectionSampling,
    Exploration,
    ExplorationSettings,
    GuidedDirectionSampling,
)
from learning.learners.local_linear_map import LocalLinearMap
from learning.learners.recursive_least_squares import RecursiveLeastSquares
from learning.physics import MeasurementNoise
from learning.scheme import Scheme, SchemeSettings
from learning.simulation.simulated_arm import SimulatedArm
from symbolic.domain import FundamentalDomain
from symbolic.gravity import GravityModel
from symbolic.robots import load_robot
from symbolic.symmetries import primary_symmetries
from verify.targets import dense_targets

FINE = 0.0053
COARSE_3R, FINE_3R = 0.26, 0.01
STABLE = 0.01  # least eigenvalue of the stiffness, as a share of the largest, of a stable one
LITERAL = ExplorationSettings(noise=0.01, step_width=0.15)
QUICK = ExplorationSettings(noise=0.01, step_width=0.3)
WIDE = ExplorationSettings(noise=0.02, step_width=0.5)


@dataclass(frozen=True)
class Truth:
    """A robot, its torque, and the sets on which learners are tested."""

    robot: Any
    gravity: GravityModel
    sets: dict[str, np.ndarray]

    @classmethod
    def of(cls, name: str) -> Truth:
        """A built-in robot with its test sets."""
        robot = load_robot(name)
        gravity = GravityModel(robot)
        dense = dense_targets(robot.limits, samples=1500).q
        sets = {"dense": dense}
        for target in paper_targets(robot):
            sets[str(len(target.q))] = target.q
        orbits = np.stack([dense @ r.A.T + r.d for r in primary_symmetries(gravity.potential)])
        stiffness = np.linalg.eigvalsh(gravity.stiffness(orbits))
        limit = STABLE * np.abs(stiffness).max()
        sets["stable"] = dense[(stiffness[..., 0] > limit).any(axis=0)]
        return cls(robot, gravity, sets)

    def error(self, learner: Any, name: str) -> float:
        """RMSE of a learner on one of the sets [N m]."""
        q = self.sets[name]
        return float(np.sqrt(np.mean((learner.predict(q) - self.gravity.torque(q)) ** 2)))


@dataclass(frozen=True)
class Run:
    """A finished run: errors by number of samples, and what exploration counted."""

    discovery: int
    curve: dict[str, list[tuple[int, float]]]
    exploration: Exploration

    def reached(self, name: str, threshold: float) -> float:
        """Samples after which the error stays below the threshold; infinity if it never does."""
        first = float("inf")
        for samples, error in reversed(self.curve[name]):
            if error > threshold:
                break
            first = samples
        return first


def explored(
    truth: Truth, exploration: Exploration, learner: Callable[[], Any], samples: int, every: int,
    sets: tuple[str, ...], discovery: int, steps: Iterator[Any],
) -> Run:  # fmt: skip
    curve: dict[str, list[tuple[int, float]]] = {name: [] for name in sets}
    seen = 0
    for _ in steps:
        settled = exploration.counts.settled
        if settled >= seen + every or exploration.counts.commands == samples:
            seen = settled
            for name in sets:
                curve[name].append((settled, truth.error(learner(), name)))
    return Run(discovery, curve, exploration)


def scheme_run(
    truth: Truth, make: Callable[[Any, Any], Any], settings: ExplorationSettings, samples: int,
    every: int, sets: tuple[str, ...], seed: int, noise: MeasurementNoise | None = None,
) -> Run:  # fmt: skip
    """Discover, explore, learn; errors every so many samples."""
    arm = SimulatedArm(truth.robot, noise=noise, rng=np.random.default_rng(seed + 1000))
    scheme = Scheme(
        arm, np.random.default_rng(seed), make,
        SchemeSettings(samples=samples, exploration=settings),
    )  # fmt: skip
    for _ in scheme.discover():
        pass
    steps = scheme.learn()
    first = next(steps)
    assert scheme.exploration is not None

    def all_steps() -> Iterator[Any]:
        yield first
        yield from steps

    return explored(
        truth, scheme.exploration, lambda: scheme.learner, samples, every, sets,
        len(scheme.samples[0]), all_steps(),
    )  # fmt: skip


def guided_run(truth: Truth, learner: Any, samples: int, every: int, seed: int) -> Run:
    """Explore with an arm that is placed and held; exact symmetries."""
    arm = SimulatedArm(truth.robot, physics="guided")
    group = primary_symmetries(truth.gravity.potential)
    exploration = GuidedDirectionSampling(
        arm, learner, np.random.default_rng(seed),
        domain=FundamentalDomain.near(group, arm.q),
        torque_range=np.abs(truth.gravity.torque(truth.sets["dense"])).max(axis=0),
        settings=ExplorationSettings(step_width=0.6),
    )  # fmt: skip
    return explored(
        truth, exploration, lambda: learner, samples, every, ("dense",), 0,
        exploration.steps(samples),
    )  # fmt: skip


def literal(group: Any, _: Any) -> LocalLinearMap:
    return LocalLinearMap(0.18, learning_rate=0.7, group=group)


def replayed(group: Any, _: Any) -> LocalLinearMap:
    return LocalLinearMap(
        0.3, kernel_width=2.5, inner_iterations=None, relaxation=0.6, replay=60, group=group
    )


def replayed_3r(group: Any, _: Any) -> LocalLinearMap:
    return LocalLinearMap(
        0.5, kernel_width=2.0, inner_iterations=None, relaxation=0.6, replay=60, group=group
    )


def joint(group: Any, _: Any) -> RecursiveLeastSquares:
    return RecursiveLeastSquares(group=group)


def spread(values: list[float], unit: str, digits: int) -> str:
    """Median and worst of what seeds gave."""
    return f"{statistics.median(values):.{digits}f}{unit} (worst {max(values):.{digits}f}{unit})"


def literal_rows(options: argparse.Namespace) -> Iterator[Row]:
    truth = Truth.of("2r")
    sets = ("66", "90", "dense")
    runs = [
        scheme_run(truth, literal, LITERAL, 54_000, 18_000, sets, seed)
        for seed in range(options.long_seeds)
    ]
    for name in sets:
        values = [run.curve[name][-1][1] for run in runs]
        yield Row(
            f"2R, literal LLM at 54,000 samples, {name}", "0.0053 Nm", "at most 0.0061 Nm", "",
            spread(values, " Nm", 4), statistics.median(values) <= 0.0061,
        )  # fmt: skip
    if options.long:
        run = scheme_run(truth, literal, LITERAL, 300_000, 100_000, sets, 0)
        for name in sets:
            value = run.curve[name][-1][1]
            yield Row(
                f"2R, literal LLM at 300,000 samples, {name}", "0.0024 Nm", "at most 0.003 Nm",
                "", f"{value:.4f} Nm (one seed)", value <= 0.003,
            )  # fmt: skip


def counted_row(
    what: str, paper: str, demanded: float, stretch: str, values: list[float], note: str = ""
) -> Row:
    return Row(
        what, paper, f"{demanded:.0f}", stretch, spread(values, "", 0) + note,
        statistics.median(values) <= demanded,
    )  # fmt: skip


def two_joint_rows(options: argparse.Namespace) -> Iterator[Row]:
    truth = Truth.of("2r")
    runs = [
        scheme_run(truth, replayed, QUICK, 3000, 100, ("dense", "90"), seed)
        for seed in range(options.seeds)
    ]
    for name in ("90", "dense"):
        yield counted_row(
            f"2R, LLM with kappa and replay: samples to 0.0053 Nm, {name}", "3,000", 2000, "1,000",
            [run.reached(name, FINE) for run in runs],
        )  # fmt: skip
    runs = [
        scheme_run(truth, joint, QUICK, 300, 5, ("dense",), seed) for seed in range(options.seeds)
    ]
    found = statistics.median(run.discovery for run in runs)
    yield counted_row(
        "2R, joint least squares: samples to 0.0053 Nm, dense, learned symmetries", "-", 120, "50",
        [run.reached("dense", FINE) for run in runs], f", after {found:.0f} of discovery",
    )  # fmt: skip


def three_joint_rows(options: argparse.Namespace) -> Iterator[Row]:
    truth = Truth.of("3r")
    runs = [
        scheme_run(truth, replayed_3r, WIDE, 3000, 100, ("stable",), seed)
        for seed in range(options.seeds)
    ]
    yield counted_row(
        "3R, LLM with kappa and replay: samples to 0.26 Nm, stable part", "14,000", 1500, "300",
        [run.reached("stable", COARSE_3R) for run in runs],
    )  # fmt: skip
    runs = [
        scheme_run(truth, joint, WIDE, 1000, 20, ("stable",), seed) for seed in range(options.seeds)
    ]
    for threshold, demanded, stretch in ((COARSE_3R, 200, "60"), (FINE_3R, 400, "150")):
        yield counted_row(
            f"3R, joint least squares, open loop: samples to {threshold} Nm, stable part", "-",
            demanded, stretch, [run.reached("stable", threshold) for run in runs],
        )  # fmt: skip
    group = primary_symmetries(truth.gravity.potential)
    guided = [
        guided_run(truth, RecursiveLeastSquares(group=group), 400, 10, seed)
        for seed in range(options.seeds)
    ]
    for threshold, demanded, stretch in ((COARSE_3R, 200, "60"), (FINE_3R, 400, "150")):
        yield counted_row(
            f"3R, joint least squares, guided: samples to {threshold} Nm, dense", "-", demanded,
            stretch, [run.reached("dense", threshold) for run in guided],
        )  # fmt: skip


def inadmissible_rows(options: argparse.Namespace) -> Iterator[Row]:
    truth = Truth.of("2r")
    shares, free, errors = [], [], []
    for seed in range(options.seeds):
        counts = scheme_run(truth, joint, QUICK, 1000, 1000, ("dense",), seed).exploration.counts
        shares.append(100.0 * counts.inadmissible / counts.commands)
        learner = literal(primary_symmetries(truth.gravity.potential), None)
        original = DirectionSampling(
            SimulatedArm(truth.robot), learner, np.random.default_rng(seed),
            torque_range=[24.5, 6.2], settings=ExplorationSettings(learn_inadmissible=True),
        )  # fmt: skip
        for _ in original.steps(1000):
            pass
        free.append(100.0 * original.counts.inadmissible / original.counts.commands)
        errors.append(truth.error(learner, "dense"))
    yield Row(
        "2R, inadmissible torques among 1,000 commands", "avoided", "under 1 %", "",
        spread(shares, " %", 1), statistics.median(shares) < 1.0,
    )  # fmt: skip
    yield Row(
        "2R, the same without constraints, and the model it leaves", "-", "47-82 %", "",
        f"{spread(free, ' %', 0)}; {spread(errors, ' Nm', 1)}", None,
    )  # fmt: skip


def noise_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Sensor noise of 0.1 degrees and 0.01 Nm against the Cramer-Rao bound."""
    truth = Truth.of("2r")
    noise = MeasurementNoise(angle=np.deg2rad(0.1), torque=0.01)
    for samples in (120, 500, 2000):
        errors, bounds = [], []
        for seed in range(min(options.seeds, 5)):
            recorded: list[np.ndarray] = []

            def make(group: Any, _: Any, recorded: list[np.ndarray] = recorded) -> Any:
                return Recorder(RecursiveLeastSquares(ridge=1e-5, group=group), recorded)

            run = scheme_run(truth, make, QUICK, samples, samples, ("dense",), seed, noise)
            errors.append(run.curve["dense"][-1][1])
            bounds.append(cramer_rao(truth, np.array(recorded), noise))
        yield Row(
            f"2R, 0.1 deg and 0.01 Nm of noise, {samples} samples, dense", "-", "-", "",
            f"{spread(errors, ' Nm', 4)}; Cramer-Rao bound {statistics.median(bounds):.4f} Nm",
            None,
        )  # fmt: skip


class Recorder:
    """A learner that also keeps the configurations it has learned."""

    def __init__(self, learner: Any, kept: list[np.ndarray]) -> None:
        self.learner, self.kept = learner, kept

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> Recorder:
        """Hand on, and keep the configurations."""
        self.kept.extend(X)
        self.learner.partial_fit(X, y, sample_weight)
        return self

    def predict(self, X: Any) -> Any:
        """Hand on."""
        return self.learner.predict(X)


def cramer_rao(truth: Truth, q: np.ndarray, noise: MeasurementNoise) -> float:
    """Least RMSE on the dense set of an unbiased estimate of the 2R arm's two parameters.

    g = A (cos q1, 0) + B (cos(q1 + q2), cos(q1 + q2)); angle errors act through the stiffness.
    """

    def design(x: np.ndarray) -> np.ndarray:
        upper, lower = np.cos(x[:, 0]), np.cos(x.sum(axis=1))
        return np.stack(
            [np.stack([upper, lower], axis=1), np.stack([0 * lower, lower], axis=1)], axis=1
        )

    stiffness = truth.gravity.stiffness(q)
    covariance = noise.torque**2 * np.eye(2) + noise.angle**2 * stiffness @ np.swapaxes(
        stiffness, 1, 2
    )
    rows = design(q)
    information = np.einsum("mji,mjk,mkl->il", rows, np.linalg.inv(covariance), rows)
    test = design(truth.sets["dense"])
    variance = np.einsum("mji,ik,mjk->mj", test, np.linalg.inv(information), test)
    return float(np.sqrt(variance.mean()))


def speed_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Processor time of an update with all symmetric copies, samples along a path."""
    for name, radius, demanded, stretch, paper in (
        ("2r", 0.18, 10.0, "2 us", "120 ms"),
        ("3r", 0.5, 150.0, "15 us", "1.8 s"),
    ):
        truth = Truth.of(name)
        group = primary_symmetries(truth.gravity.potential)
        rng = np.random.default_rng(0)
        n = truth.robot.n
        q = np.cumsum(rng.normal(0, 0.1, (24_000, n)), axis=0)
        torque = truth.gravity.torque(q)
        learner = LocalLinearMap(radius, group=group).fit(q, torque)
        few = learner.n_prototypes_
        best = best_time(
            lambda learner=learner, q=q, t=torque: learner.partial_fit(q[:4000], t[:4000])
        )
        cost = 1e6 * best / 4000
        yield Row(
            f"{name.upper()}, update of the LLM, all {len(group)} copies, {few} prototypes", paper,
            f"{demanded:.0f} us", stretch, f"{cost:.1f} us", cost <= demanded,
        )  # fmt: skip
        exact = RecursiveLeastSquares(group=group)
        start = time.process_time()
        for i in range(400):
            exact.partial_fit(q[i : i + 1], torque[i : i + 1])
            exact.predict(q[i : i + 1])
        cost = 1e3 * (time.process_time() - start) / 400
        yield Row(
            f"{name.upper()}, update and prediction of joint least squares, amortised", "-",
            "1 ms", "", f"{cost:.2f} ms", cost <= 1.0,
        )  # fmt: skip


def best_time(work: Callable[[], Any]) -> float:
    times = []
    for _ in range(5):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


ROWS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "literal": literal_rows,
    "2r": two_joint_rows,
    "3r": three_joint_rows,
    "speed": speed_rows,
    "inadmissible": inadmissible_rows,
    "noise": noise_rows,
}


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--long-seeds", type=int, default=3)
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--only", nargs="*", choices=list(ROWS), default=list(ROWS))
    options = parser.parse_args()
    rows: list[Row] = []
    for name in options.only:
        for row in ROWS[name](options):
            print(row.line(), file=sys.stderr, flush=True)
            rows.append(row)
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
