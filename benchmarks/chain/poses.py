"""Poses of the rigid chain measured: planned against random ones, and those an arm finds itself.

Usage: python -m benchmarks.chain.poses [--seeds 20] [--write]

Poses are planned from the robot file as a first guess (`isotorque plan ROBOT`), anywhere on the
torus; random ones are uniform over it. Medians over the seeds. Stable poses are those that the
discovery of `isotorque discover` settles in, open loop; poses nearer than 0.1 rad in every joint
count once. With --write the table goes into docs/rigid-chain.md. A quarter of an hour.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from benchmarks.chain.fit import NOISE, PAGE, Row, table
from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from benchmarks.shared.small_arms import SMALL_ARMS, write_arm
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.information import Information, parameter_mask
from isotorque.learning.learners.rigid.planning.pose_design import (
    NEIGHBOURS,
    PoseDesign,
    neighbours,
)
from isotorque.learning.learners.rigid.planning.pose_plan import plan_poses_within
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.scheme import Scheme
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.runs.from_data.chain_plan import REGION, chain_of_tree
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

Array = NDArray[np.float64]
PLANNED = (8, 10, 15)
RANDOM = range(9, 34)
"""Numbers of random poses."""
TEST = 400
"""Poses at which errors are looked at."""
KNOWN = 1e-6
"""Share of the largest torque: stable poses."""
MANY = 60
"""Poses of a design that stands for one of any number of them."""


def main() -> int:
    """Print the table; 1 if a row does not hold what is demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args()
    rows = []
    for row in measured(options.seeds):
        print(row.what, "|", row.measured, file=sys.stderr, flush=True)
        rows.append(row)
    print(table(rows))
    if options.write:
        write_between(PAGE, "python -m benchmarks.chain.poses --write", table(rows))
    return int(any(row.holds is False for row in rows))


def measured(seeds: int) -> Iterator[Row]:
    """All rows."""
    for name in ("3r", "panda", "ur5"):
        yield from planned_against_random(name, seeds)
    for name, demanded in (("2r", 8), ("3r", 8), ("ur5", 12), ("hanging-7", 15)):
        yield stable_poses(name, demanded, seeds)


def planned_against_random(name: str, seeds: int) -> Iterator[Row]:
    """How many random poses leave the errors that planned ones leave."""
    chain = chain_of_tree(load_robot(name).tree)
    high = np.full(chain.n, np.pi)
    test = np.random.default_rng(99).uniform(-high, high, (TEST, chain.n))

    def planned(seed: int, count: int) -> Array:
        region = np.random.default_rng(seed).uniform(-high, high, (REGION, chain.n))
        known = chain, parameter_mask(chain.n), _no_samples(chain.n)
        plan = plan_poses_within(*known, -high, high, region, count, random_state=seed)
        return plan.poses

    def at_random(seed: int, count: int) -> Array:
        return np.random.default_rng([seed, count]).uniform(-high, high, (count, chain.n))

    random = {m: _errors(chain, at_random, m, seeds, test) for m in RANDOM}
    design = PoseDesign.of(chain, parameter_mask(chain.n), _no_samples(chain.n), test)
    least = least_mean_error(design)
    for count in PLANNED:
        errors = _errors(chain, planned, count, seeds, test)
        as_good = [_as_good(random, k, errors[k]) for k in range(3)]
        bound = _as_good(random, 3, least / np.sqrt(count))
        yield Row(
            f"{name}: {count} planned poses, {NOISE} N m; random ones that leave the same largest "
            "standard error; the same largest error; the same RMSE (at most so many, whatever the "
            "design)",
            f"{as_good[0]}; {as_good[1]}; {as_good[2]} ({bound}); "
            f"errors {errors[0]:.2g}, {errors[1]:.2g}, {errors[2]:.2g} N m",
            f"{2 * count}",
            min(as_good[0], 2 * count) >= 2 * count,
        )


def _errors(
    chain: ChainParameters,
    poses: Callable[[int, int], Array],
    count: int,
    seeds: int,
    test: Array,
) -> Array:
    """Medians: largest standard error, largest error, RMSE, RMS standard error [N m], (4,)."""
    free, found = parameter_mask(chain.n), []
    # derivatives of a singular chain say too little; not the neighbours that were planned for
    near = neighbours(chain, 2 * NEIGHBOURS)[NEIGHBOURS:]
    truth = chain.torque(test)
    for seed in range(seeds):
        q = poses(seed, count)
        rng = np.random.default_rng([seed, count, 1])
        torque = chain.torque(q) + NOISE * rng.normal(size=q.shape)
        whitening = np.tile(np.eye(chain.n) / NOISE, (count, 1, 1))
        standard = [Information.of(c, q, whitening, free).standard_error(c, test) for c in near]
        largest = np.exp(np.mean([np.log(s.max()) for s in standard]))
        mean = np.exp(np.mean([np.log(np.sqrt(np.mean(s**2))) for s in standard]))
        learner = RigidChain(torque_noise=NOISE, random_state=seed).fit(q, torque)
        error = np.full(test.shape, np.inf)
        if learner.verdict_.accepted:
            error = learner.predict(test) - truth
        found.append([largest, np.abs(error).max(), np.sqrt(np.mean(error**2)), mean])
    return np.asarray(np.median(found, axis=0))


def least_mean_error(design: PoseDesign) -> float:
    """RMS standard error that no design goes below, times the root of its number of poses [N m].

    A design of many poses is moved to the least mean variance phi. By convexity no design, however
    many poses it has, weighted in whatever way, goes below ``phi^2 / d`` per pose, where d is
    largest variance gained per pose, anywhere on the torus (equivalence theorem of Kiefer and
    Wolfowitz for linear criteria, Fedorov 1972).
    """
    n = design.chains[0].n
    rng, shape = np.random.default_rng(0), (MANY, n)
    start = rng.uniform(-np.pi, np.pi, shape)

    def cost(x: Array) -> tuple[float, Array]:
        value, slope = design.value_and_slope(x.reshape(shape), 1.0)
        return value, slope.ravel()

    poses = minimize(cost, start.ravel(), jac=True, method="L-BFGS-B").x.reshape(shape)
    rows = design.rows(poses)
    values = []
    for k, covariance in enumerate(design.covariances(rows)):
        moment = design.slopes[k].T @ design.slopes[k] / len(design.slopes[k])
        phi = MANY * float(np.sum(covariance * moment))
        pull = MANY**2 * covariance @ moment @ covariance

        def gained(q: Array, k: int = k, pull: Array = pull) -> Array:
            row = design.rows(np.atleast_2d(q))[k]
            return np.sum((row @ pull) * row, axis=(1, 2))

        tried = rng.uniform(-np.pi, np.pi, (5000, n))
        best = tried[np.argsort(gained(tried))[-10:]]
        most = max(-minimize(lambda q, g=gained: -g(q)[0], q, method="L-BFGS-B").fun for q in best)
        values.append(phi**2 / most)
    return float(np.exp(np.mean(np.log(np.sqrt(values)))))


def stable_poses(name: str, demanded: int, seeds: int) -> Row:
    """Poses that an arm has to find by itself until it knows its torque on the whole torus."""
    with tempfile.TemporaryDirectory() as folder:
        robot = load_robot(write_arm(name, Path(folder)) if name in SMALL_ARMS else name)
    gravity = GravityModel(robot)
    test = np.random.default_rng(99).uniform(-np.pi, np.pi, (TEST, robot.n))
    truth = gravity.torque(test)
    largest = float(np.abs(truth).max())
    poses, motions, errors = [], [], []
    for seed in range(seeds):
        arm = SimulatedArm(robot, "open_loop")
        scheme = Scheme(arm, np.random.default_rng(seed), _no_learner)
        found, moved, error = float("inf"), 0, np.inf
        for _ in scheme.discover():
            moved += 1
            known = scheme.chain.learner
            if known is None:
                continue
            error = float(np.abs(known.predict(test) - truth).max()) / largest
            if error < KNOWN:
                found = scheme.chain.poses
                break
        poses.append(found)
        motions.append(moved)
        errors.append(error)
    return Row(
        f"{name}: stable poses alone, found by the arm itself in open loop, until it errs by less "
        f"than {KNOWN:g} of the largest torque on the whole torus; motions",
        f"{np.median(poses):.0f} ({max(poses):.0f}; error {max(errors):.0g}); "
        f"{np.median(motions):.0f} ({max(motions)})",
        f"{demanded} poses",
        float(np.median(poses)) <= demanded,
    )


def _no_learner(group: object, span: Array) -> Any:
    raise AssertionError("a discovery asks for no learner")


def _as_good(random: dict[int, Array], kind: int, error: float) -> int:
    """The fewest random poses that leave no larger an error."""
    return next((m for m, errors in random.items() if errors[kind] <= error), RANDOM.stop)


def _no_samples(joints: int) -> ChainSamples:
    nothing = np.zeros((0, joints))
    return ChainSamples(nothing, nothing, np.full(joints, NOISE), np.zeros(joints), np.zeros(0))


if __name__ == "__main__":
    sys.exit(clear_errors(main)())
