"""Time the symmetry group with its proofs beside brute force, in one process, taking turns.

Usage: python -m benchmarks.groups [--json] [--turns 5] [ROBOT ...]

* isotorque: the complete group of a given potential, with proofs (`isotorque.primary_symmetries`).
* brute force: all integer matrices with entries in -2..2, from values of the torque alone
  (`isotorque.verify.testing.brute_force`): no proof, and no robot with a joint that gravity does
  not feel.

Both must find the same relations. Times are processor times; the ratio is the median over turns of
the ratio within a turn.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from benchmarks.shared.clear_errors import clear_errors
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.brute_force import brute_force_symmetries

ROBOTS = ("pendulum", "2r", "3r")


def measure(name: str, turns: int) -> dict[str, Any]:
    """Time one robot.

    Raises
    ------
    InputError
        If it has a joint that gravity does not feel.
    """
    robot = load_robot(name)
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    if group.rank < robot.n:
        raise InputError(name, "joints", f"{robot.n - group.rank} free", "none for brute force")
    mine: list[float] = []
    brute: list[float] = []
    same = True
    for turn in range(turns):
        potential = derive_potential(robot.tree)  # a fresh one: nothing is remembered
        start = time.process_time()
        primary_symmetries(potential)
        middle = time.process_time()
        found = brute_force_symmetries(gravity.torque, robot.n, np.random.default_rng(turn))
        brute.append(time.process_time() - middle)
        mine.append(middle - start)
        same &= len(found) == group.order and all(relation in group for relation in found)
    ratios = [slow / quick for slow, quick in zip(brute, mine, strict=True)]
    return {
        "robot": name,
        "order": group.order,
        "isotorque_seconds": statistics.median(mine),
        "brute_force_seconds": statistics.median(brute),
        "ratio": statistics.median(ratios),
        "same": same,
    }


@clear_errors
def main() -> int:
    """Print the table; return 1 if the two disagree."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("robots", nargs="*", default=list(ROBOTS))
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = [measure(name, options.turns) for name in options.robots]
    if options.json:
        print(json.dumps(found, indent=1))
    else:
        print("| robot | order | isotorque, with proofs [ms] | brute force [ms] | times | same |")
        print("| --- | --- | --- | --- | --- | --- |")
        for row in found:
            times = (1e3 * row["isotorque_seconds"], 1e3 * row["brute_force_seconds"])
            print(
                f"| {row['robot']} | {row['order']} | {times[0]:.2g} | {times[1]:.3g} "
                f"| {row['ratio']:.3g} | {'yes' if row['same'] else 'no'} |"
            )
    return int(not all(row["same"] for row in found))


if __name__ == "__main__":
    sys.exit(main())
