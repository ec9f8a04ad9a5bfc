"""Relations by the rigid chain: of arms from a few poses in noise, and of a 3R arm by itself.

Usage: python -m benchmarks.chain.relations [--seeds 100] [--discoveries 20] [--write]

Poses are uniform over the torus, noise is normal; the noise of poses is stated, that of a discovery
nobody tells. A seed is right if every relation that is claimed keeps its bound at 500 other poses.
The order of the group shall be at least that of the arm's exact group, and no more than that of
its largest group within a tolerance of six times the largest standard error of any torque. With
--write the table goes into docs/rigid-chain.md. An hour.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from benchmarks.shared.urdf_arms import example_robots
from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings
from isotorque.learning.relations.identification.identify import identify
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[2] / "docs" / "rigid-chain.md"
NAME = "python -m benchmarks.chain.relations --write"

BUILT_IN = ("3r", "ur5", "panda")
EXAMPLES = {
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
}
POSES = (30, 15)
NOISE, ANGLE_NOISE = 0.05, float(np.deg2rad(0.1))
DEVIATIONS = 6.0
STEP = 0.02
"""Tolerances are rounded down to multiples of this [N m]: groups of few of them are derived."""
PROBES = 500
KEPT, AT_LEAST = 0.99, 0.9
MOTIONS = 60, 30
TELLING = 40
"""Torques that a discovery chooses, `--set discovery.telling=40`: its sensors err."""
MOST_MOTIONS, EVERY = 400, 15
FOR_GOOD = 3
"""Looks in a row that find all relations."""


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    what: str
    measured: str
    demanded: str
    holds: bool | None


def main(arguments: list[str] | None = None) -> int:
    """Print the table; 1 if a row does not hold what is demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--discoveries", type=int, default=20, help="seeds of the 3R arm by itself")
    parser.add_argument("--first", type=int, default=0, help="first seed (another one to develop)")
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args(arguments)
    first = options.first
    rows = []
    for row in measured(range(first, first + options.seeds), first, options.discoveries):
        print(row.what, "|", row.measured, file=sys.stderr, flush=True)
        rows.append(row)
    print(table(rows))
    if options.write:
        write_between(PAGE, NAME, table(rows))
    return int(any(row.holds is False for row in rows))


def measured(seeds: range, first: int, discoveries: int) -> Iterator[Row]:
    """All rows."""
    if discoveries:
        yield by_itself(range(first, first + discoveries))
    for poses in POSES if len(seeds) else ():
        for name in (*BUILT_IN, *EXAMPLES):
            if arm(name) is not None:
                yield from_poses(name, poses, seeds)


@cache
def arm(name: str) -> GravityModel | None:
    """An arm; None where it is not installed."""
    if name not in EXAMPLES:
        return GravityModel(load_robot(name))
    folder = example_robots()
    return None if folder is None else GravityModel(load_robot(folder / EXAMPLES[name]))


@cache
def order_within(name: str, steps: int) -> int:
    """Order of the largest group of an arm within a tolerance, in steps of `STEP`."""
    gravity = arm(name)
    assert gravity is not None
    if not steps:
        return primary_symmetries(gravity.potential).order
    return max(group.order for group in maximal_groups(gravity.potential, STEP * steps))


def from_poses(name: str, poses: int, seeds: range) -> Row:
    """Claims from random poses in noise: bounds, and orders between both limits."""
    gravity = arm(name)
    assert gravity is not None
    exact = order_within(name, 0)
    test = np.random.default_rng(99).uniform(-np.pi, np.pi, (PROBES, gravity.n))
    truth = gravity.torque(test)
    kept, orders, bounds, least, most = 0, [], [], 0, 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (poses, gravity.n))
        torque = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
        found = identify(q, torque, noise=MeasurementNoise(0.0, NOISE))
        errors = [
            np.abs(gravity.torque(r.configuration(test)) - r.Y * truth).max(axis=0) - r.bound
            for r in found.group
        ]
        kept += bool(np.max(errors) <= 1e-12)
        orders.append(found.order)
        bounds.append(max(r.bound.max() for r in found.group))
        least += found.order >= exact
        if found.order <= exact:
            most += 1
        elif found.chain is not None:
            largest = float(found.chain.standard_error(test).max())
            most += found.order <= order_within(name, int(DEVIATIONS * largest / STEP))
    count = len(seeds)
    holds = kept >= KEPT * count and min(least, most) >= AT_LEAST * count
    return Row(
        f"{name}: {poses} poses, {NOISE} N m: seeds in which every relation keeps its bound; whose "
        f"order is at least the exact group's ({exact}); at most that within 6 standard errors",
        f"{kept} of {count} (bounds {np.median(bounds):.2g} N m); {least}; {most} (median order "
        f"{np.median(orders):.0f})",
        "99 %; 90 %; 90 %" + (" (stretch)" if poses != POSES[0] else ""),
        bool(holds),
    )


def by_itself(seeds: range) -> Row:
    """Motions of a discovery in open loop until all relations of the 3R are known for good."""
    robot = load_robot("3r")
    gravity = arm("3r")
    assert gravity is not None
    group = primary_symmetries(gravity.potential)
    settings = SchemeSettings(discovery=DiscoverySettings(telling=TELLING))
    needed, whole, false = [], dict.fromkeys(MOTIONS, 0), 0
    for seed in seeds:
        known = []
        noise = SensorNoise(ANGLE_NOISE, NOISE)
        simulated = SimulatedArm(robot, noise=noise, rng=np.random.default_rng([seed, 1]))
        scheme = Scheme(simulated, np.random.default_rng([seed, 2]), _no_learner, settings)
        for motions, _ in enumerate(scheme.discover(), 1):
            if motions % EVERY == 0:
                found = learn_relations(*scheme.samples)
                false += sum(relation not in group for relation in found.group)
                known.append(found.order == group.order)
            if motions >= MOST_MOTIONS or (len(known) >= FOR_GOOD and all(known[-FOR_GOOD:])):
                break
        missing = [i for i, right in enumerate(known) if not right]
        first = missing[-1] + 1 if missing else 0
        needed.append(EVERY * (first + 1) if first < len(known) else np.inf)
        for motions in MOTIONS:  # one that has ended knows what it knew then
            whole[motions] += known[: motions // EVERY][-1]
    counts = ", ".join(f"{whole[m]} of {len(seeds)} after {m} motions" for m in MOTIONS)
    return Row(
        f"3r by itself in open loop (`--set discovery.telling={TELLING}`), 0.1 degree and {NOISE} "
        "N m, nobody tells the noise: all "
        f"{group.order} relations known, and others that are claimed",
        f"{counts}; for good after {np.median(needed):.0f} ({max(needed):.0f}) motions; {false}",
        f"all after {MOTIONS[0]} (stretch {MOTIONS[1]}); 0",
        whole[MOTIONS[0]] == len(seeds) and not false,
    )


def _no_learner(*_: object) -> None:
    """Discovery alone needs none."""


def table(rows: list[Row]) -> str:
    """Rows as Markdown."""
    word = {True: "yes", False: "no", None: ""}
    lines = [
        f"| {row.what} | {row.measured} | {row.demanded} | {word[row.holds]} |" for row in rows
    ]
    return "\n".join(["| | measured | demanded | holds |", "|---|---|---|---|", *lines])


if __name__ == "__main__":
    sys.exit(clear_errors(main)())
