"""The rigid chain measured: poses needed, errors, gains, calibration, times.

Usage: python -m benchmarks.chain.fit [--seeds 20] [--random 1000] [--only FUNCTION] [--write]

Poses are uniform over the torus (over the joint limits where said), noise is normal. Medians over
the seeds, the worst in brackets. Times are processor times. With --write the table goes into
docs/rigid-chain.md. A quarter of an hour; with --only, rows of some functions of this module alone,
the others stay as they stand. Relations: benchmarks.chain.relations.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from benchmarks.gravity_forms import LOOP
from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from benchmarks.shared.urdf_arms import EXAMPLE_ROBOTS, example_robots
from isotorque.learning.export.c_export import c_source
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from tests.learning.learners.rigid.random_chains import KINDS, random_chain, random_poses

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[2] / "docs" / "rigid-chain.md"
COMMAND = "python -m benchmarks.chain.fit --write"
HEAD = ["| | measured | demanded | holds |", "|---|---|---|---|"]
DEMANDED = 60.0 / 72.0
"""Time of exported C demanded, over the analytic model's: how fast a machine is cancels out."""
TURNS = 15
"""Times that compiled code is timed, in turns."""
EXACT = 1e-9
NOISE = 0.05


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    what: str
    measured: str
    demanded: str = ""
    holds: bool | None = None


Step = partial[Row | Iterator[Row]]
"""A function of this module and its arguments: one row, or several."""


def main() -> int:
    """Print the table; 1 if a row does not hold what is demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--random", type=int, default=1000, help="random chains")
    parser.add_argument("--only", metavar="FUNCTION", help="of this module, such as exported_c")
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args()
    steps = measured(options.seeds, options.random)
    names = sorted({step.func.__name__ for step in steps})
    if options.only is not None and options.only not in names:
        raise InputError("command line", "--only", options.only, " or ".join(names))
    rows: list[Row] = []
    for step in steps:
        if options.only in (None, step.func.__name__):
            found = step()
            rows.extend([found] if isinstance(found, Row) else found)
            print(*lines(rows[-1:]), file=sys.stderr, flush=True)
    print(table(rows))
    if options.write:
        text = table(rows) if options.only is None else with_rows(PAGE.read_text("utf-8"), rows)
        write_between(PAGE, COMMAND, text)
    return int(any(row.holds is False for row in rows))


def table(rows: list[Row]) -> str:
    """Rows as Markdown."""
    return "\n".join([*HEAD, *lines(rows)])


def lines(rows: list[Row]) -> list[str]:
    """One line of Markdown each."""
    word = {True: "yes", False: "no", None: ""}
    return [f"| {row.what} | {row.measured} | {row.demanded} | {word[row.holds]} |" for row in rows]


def with_rows(page: str, rows: list[Row]) -> str:
    """The table of a page, rows of the same name replaced, others added."""
    old = page.partition(f"<!-- {COMMAND} -->")[2].partition(f"<!-- end of {COMMAND} -->")[0]
    kept = [line for line in old.splitlines() if line.startswith("|") and line not in HEAD]
    for row, line in zip(rows, lines(rows), strict=True):
        places = [k for k, other in enumerate(kept) if other.startswith(f"| {row.what} |")]
        if places:
            kept[places[0]] = line
        else:
            kept.append(line)
    return "\n".join([*HEAD, *kept])


def measured(seeds: int, chains: int) -> list[Step]:
    """All rows, each still to be measured."""
    steps: list[Step] = []
    for name, demanded in (("2r", 4), ("3r", 5), ("ur5", 6), ("panda", 8)):
        steps.append(partial(poses_needed, name, demanded, seeds, unknown=False))
    for name, demanded in (("ur5", 10), ("panda", 15)):
        steps.append(partial(poses_needed, name, demanded, seeds, unknown=True))
    steps += [partial(gains_and_offsets, name, seeds) for name in ("ur5", "panda")]
    steps.append(partial(panda_within_limits, seeds))
    for name, poses in (("ur5", 20), ("ur5", 40), ("panda", 20), ("panda", 40)):
        steps.append(partial(beside_known_kinematics, name, poses, seeds))
    for name, poses in (("2r", 20), ("3r", 20), ("ur5", 20), ("ur5", 40), ("panda", 20)):
        steps.append(partial(calibration, name, poses, seeds))
    for name, poses in (("2r", 20), ("ur5", 20), ("ur5", 40), ("panda", 20)):
        steps.append(partial(calibration, name, poses, seeds, stated=False))
    steps.append(partial(calibrations_of_examples, seeds))
    for name in ("ur5", "panda"):
        for poses, demanded in ((40, 0.05), (300, 0.3)):
            steps.append(partial(fit_time, name, poses, demanded, seeds))
    steps += [partial(random_chains, chains), partial(exported_c)]
    return steps


def poses_needed(name: str, demanded: int, seeds: int, *, unknown: bool) -> Row:
    """Fewest poses from which every seed gives the whole torus."""
    gravity = GravityModel(load_robot(name))
    n = gravity.n
    starts: list[int] = []
    for poses in range(3, demanded + 6):
        worst, starts = 0.0, []
        for seed in range(seeds):
            rng = np.random.default_rng(seed)
            q = random_poses(rng, poses, n)
            gains, offsets = np.ones(n), np.zeros(n)
            if unknown:
                gains, offsets = rng.uniform(0.5, 2.0, n), rng.normal(size=n)
            torque = gains * gravity.torque(q) + offsets
            learner = RigidChain(
                unknown_gains=unknown, unknown_offsets=unknown, random_state=seed
            ).fit(q, torque)
            if not learner.verdict_.accepted:
                worst = np.inf
                break
            test = random_poses(np.random.default_rng(99), 500, n)
            error = learner.predict(test) - gains * gravity.torque(test) - offsets
            worst = max(worst, np.abs(error).max() / np.abs(torque).max())
            if worst > EXACT:
                break
            starts.append(learner.fit_.starts)
        if worst <= EXACT:
            break
    what = f"noise-free poses until every seed errs by less than {EXACT:g} of the largest torque"
    if unknown:
        what += ", gains and offsets unknown"
    text = f"{poses} (error {worst:.1g}; {np.median(starts):.0f} starts, {max(starts)} at most)"
    return Row(f"{name}: {what}", text, f"{demanded}", poses <= demanded)


def gains_and_offsets(name: str, seeds: int) -> Row:
    """Ratios of gains and offsets from 40 poses in noise."""
    gravity = GravityModel(load_robot(name))
    n = gravity.n
    test = random_poses(np.random.default_rng(99), 500, n)
    loaded = np.abs(gravity.torque(test)).max(axis=0) > 5.0
    ratios, errors = [], []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        q, gains = random_poses(rng, 40, n), rng.uniform(0.5, 2.0, n)
        offsets = rng.normal(size=n)
        torque = gains * gravity.torque(q) + offsets + NOISE * rng.normal(size=q.shape)
        learner = RigidChain(
            torque_noise=NOISE, unknown_gains=True, unknown_offsets=True, random_state=seed
        ).fit(q, torque)
        chain = learner.chain_
        ratio = chain.gains[loaded] / gains[loaded]
        ratios.append(np.abs(ratio / ratio[0] - 1.0).max())
        errors.append(np.abs(chain.offsets - offsets).max())
    return Row(
        f"{name}: 40 poses, {NOISE} N m, gains and offsets unknown: ratios of gains above 5 N m; "
        "offsets",
        f"{_percent(ratios)}; {_spread(errors)} N m",
        "0.5 %; 0.03 N m",
        bool(np.median(ratios) <= 0.005 and np.median(errors) <= 0.03),
    )


def panda_within_limits(seeds: int) -> Row:
    """RMSE over the limits from 20 poses with noise on torques and angles, beside Cramer-Rao."""
    robot = load_robot("panda")
    gravity, (noise, angles) = GravityModel(robot), (0.1, np.deg2rad(0.1))
    errors, bounds = [], []
    test = _within_limits(robot, np.random.default_rng(99), 1000)
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        q = _within_limits(robot, rng, 20)
        torque = gravity.torque(q) + noise * rng.normal(size=q.shape)
        seen = q + angles * rng.normal(size=q.shape)
        learner = RigidChain(torque_noise=noise, angle_noise=angles, random_state=seed)
        learner.fit(seen, torque)
        errors.append(_rms(learner.predict(test) - gravity.torque(test)))
        bounds.append(_rms(learner.fit_.standard_error(test)))
    return Row(
        "panda: 20 poses within the limits, 0.1 N m and 0.1 degree: RMSE over the limits",
        f"{_spread(errors)} N m (Cramer-Rao {np.median(bounds):.3g})",
        "0.065 N m",
        bool(np.median(errors) <= 0.065),
    )


def beside_known_kinematics(name: str, poses: int, seeds: int) -> Row:
    """Error over that of least squares on Pinocchio's static regressor."""
    gravity = GravityModel(load_robot(name))
    test = random_poses(np.random.default_rng(99), 500, gravity.n)
    truth = gravity.torque(test)
    chain, known = [], []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        q = random_poses(rng, poses, gravity.n)
        torque = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
        learner = RigidChain(torque_noise=NOISE, random_state=seed).fit(q, torque)
        chain.append(_rms(learner.predict(test) - truth))
        known.append(_rms(StaticRegressor(name).fit(q, torque).predict(test) - truth))
    ratio = float(np.median(chain) / np.median(known))
    return Row(
        f"{name}: {poses} poses, {NOISE} N m: RMSE, beside least squares that knows the kinematics",
        f"{np.median(chain):.3g} N m, {ratio:.2f} times",
        "2 times",
        ratio <= 2.0,
    )


def calibration(name: str, poses: int, seeds: int, *, stated: bool = True) -> Row:
    """Coverage of the standard errors."""
    robot = _arm(name)
    assert robot is not None
    gravity = GravityModel(robot)
    test = random_poses(np.random.default_rng(99), 200, gravity.n)
    truth = gravity.torque(test)
    loaded = np.abs(truth).max(axis=0) > 1e-9
    ninety, three = [], []
    for seed in range(10 * seeds):
        rng = np.random.default_rng(seed)
        q = random_poses(rng, poses, gravity.n)
        torque = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
        learner = RigidChain(torque_noise=NOISE if stated else None, random_state=seed)
        learner.fit(q, torque)
        if not learner.verdict_.accepted:
            continue
        z = np.abs(learner.predict(test) - truth) / learner.standard_error(test)
        ninety.append(np.mean(z[:, loaded] < 1.645))
        three.append(np.mean(z[:, loaded] < 3.0))
    inside, within = float(np.mean(ninety)), float(np.mean(three))
    return Row(
        f"{name}: {poses} poses, {len(ninety)} seeds, noise {'stated' if stated else 'estimated'}: "
        "torques within 90 % bands; within three standard errors",
        f"{100 * inside:.1f} %; {100 * within:.2f} %",
        "87 to 93 %; 99.3 %" if stated else "",
        0.87 <= inside <= 0.93 and within >= 0.993 if stated else None,
    )


def calibrations_of_examples(seeds: int) -> Iterator[Row]:
    """The same for an arm of example-robot-data, where installed."""
    if _arm("xarm7") is not None:
        yield calibration("xarm7", 20, seeds)


def fit_time(name: str, poses: int, demanded: float, seeds: int) -> Row:
    """Processor time of a fit, all starts, in noise."""
    gravity = GravityModel(load_robot(name))
    seconds = []
    for seed in range(seeds + 1):
        rng = np.random.default_rng(seed)
        q = random_poses(rng, poses, gravity.n)
        torque = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
        learner = RigidChain(torque_noise=NOISE, random_state=seed)
        begin = time.process_time()
        learner.fit(q, torque)
        seconds.append(time.process_time() - begin)
    return Row(
        f"{name}: processor time of a fit to {poses} poses, all starts",
        f"{_spread(seconds[1:])} s",
        f"{demanded} s",
        bool(np.median(seconds[1:]) <= demanded),
    )


def random_chains(count: int) -> Row:
    """Random chains of 1 to 8 joints from ceil((4 n - 1) / n) + 3 poses."""
    accepted, wrong, starts = 0, 0, []
    for seed in range(count):
        rng = np.random.default_rng(seed)
        n, kind = 1 + seed % 8, KINDS[(seed // 8) % len(KINDS)]
        chain = random_chain(rng, n, kind)
        q = random_poses(rng, -(-(4 * n - 1) // n) + 3, n)
        learner = RigidChain(random_state=seed).fit(q, chain.torque(q))
        starts.append(learner.fit_.starts)
        if not learner.verdict_.accepted:
            continue
        accepted += 1
        test = random_poses(rng, 200, n)
        wrong += bool(np.abs(learner.predict(test) - chain.torque(test)).max() > 1e-8)
    return Row(
        f"{count} random chains of 1 to 8 joints ({', '.join(KINDS)}), ceil((4n - 1) / n) + 3 "
        "poses: accepted; accepted and wrong by more than 1e-8 N m",
        f"{accepted}; {wrong} ({max(starts)} starts at most)",
        "99.5 %; 0",
        accepted >= 0.995 * count and wrong == 0,
    )


def exported_c() -> Iterator[Row]:
    """Time of a call of the exported C of the snapped chain, beside the analytic model's."""
    if shutil.which("cc") is None:
        return
    robot = load_robot("panda")
    gravity = GravityModel(robot)
    q = random_poses(np.random.default_rng(0), 10, gravity.n)
    learner = RigidChain().fit(q, gravity.torque(q))
    assert learner.simplified()
    sources = {"chain": c_source(torque_form(learner)), "analytic": gravity_c(gravity)}
    times: dict[str, list[float]] = {name: [] for name in sources}
    with tempfile.TemporaryDirectory() as folder:
        for name, source in sources.items():
            inside = Path(folder) / name
            inside.mkdir()
            (inside / "gravity.c").write_text(source)
            (inside / "loop.c").write_text(LOOP)
            command = ["cc", "-O2", "gravity.c", "loop.c", "-lm", "-o", "loop"]
            subprocess.run(command, cwd=inside, check=True)
        for _ in range(TURNS):
            for name in sources:
                command = [str(Path(folder) / name / "loop"), str(gravity.n)]
                said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
                times[name].append(float(said.split()[0]))
    chain, analytic = min(times["chain"]), min(times["analytic"])
    yield Row(
        f"panda: exported C of the snapped chain, fastest of {TURNS} turns",
        f"{chain:.0f} ns, {chain / analytic:.2f} times the analytic model's",
        f"60 ns, {DEMANDED:.2f} times",
        chain <= DEMANDED * analytic,
    )


def _arm(name: str) -> Robot | None:
    if name not in EXAMPLE_ROBOTS:
        return load_robot(name)
    folder = example_robots()
    return None if folder is None else load_robot(folder / EXAMPLE_ROBOTS[name])


def _within_limits(robot: Robot, rng: np.random.Generator, count: int) -> Array:
    limits = np.array(robot.limits, dtype=float)
    low, high = limits if limits.shape == (2, robot.n) else limits.T
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    return np.asarray(rng.uniform(low, high, (count, robot.n)))


def _rms(error: Array) -> float:
    return float(np.sqrt(np.mean(error**2)))


def _spread(values: list[float]) -> str:
    return f"{np.median(values):.2g} ({max(values):.2g})"


def _percent(values: list[float]) -> str:
    return f"{100 * np.median(values):.2g} % ({100 * max(values):.2g} %)"


if __name__ == "__main__":
    sys.exit(clear_errors(main)())
