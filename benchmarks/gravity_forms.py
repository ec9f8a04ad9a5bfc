"""Time the two forms of the gravity torque, normal form and recursion, and count their operations.

Usage: python -m benchmarks.gravity_forms [--json] [--turns 5]

Nanoseconds per configuration, medians of CPU time taken in turns: in Python for one configuration
and within a batch, Pinocchio called from Python beside it; in C within a loop, called from C. The
counted operations are the rule by which C and CasADi take one form or the other.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin

from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import (
    GravityProgram,
    expanded_program,
    recursion_program,
)
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import load_robot

SINGLE, BATCH = 2000, 20_000

LOOP = """
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
void isotorque_gravity(const double *q, double *tau);
int main(int argc, char **argv)
{
    const int n = atoi(argv[1]), calls = 300000;
    double q[64], tau[64], sum = 0.0;
    for (int i = 0; i < n; i++) q[i] = 0.1 * (argc + i);
    const clock_t start = clock();
    for (int k = 0; k < calls; k++) {
        isotorque_gravity(q, tau);
        for (int i = 0; i < n; i++) { q[i] += 1e-3; sum += tau[i]; }
    }
    printf("%.6g %.17g\\n", 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / calls, sum);
    return 0;
}
"""


def nanoseconds(call: Callable[[], Any], configurations: int, repeats: int = 1) -> float:
    start = time.process_time_ns()
    for _ in range(repeats):
        call()
    return (time.process_time_ns() - start) / configurations


def in_c(gravity: GravityModel, program: GravityProgram, folder: Path) -> Callable[[], float]:
    """Compile the form; return a function that runs the loop and gives ns per call."""
    (folder / "gravity.c").write_text(gravity_c(gravity, program))
    (folder / "loop.c").write_text(LOOP)
    binary = folder / f"loop-{gravity.name}-{program.cost}"
    command = ["cc", "-O2", "gravity.c", "loop.c", "-lm", "-o", binary.name]
    subprocess.run(command, cwd=folder, check=True)

    def run() -> float:
        command = [str(binary), str(gravity.n)]
        out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return float(out.split()[0])

    return run


def measure(name: str, turns: int, folder: Path) -> dict[str, Any]:
    robot = load_robot(name)
    gravity = GravityModel(robot)
    potential, chain = gravity.significant_potential.to_float(), gravity.chain
    programs = {
        "normal form": expanded_program(potential),
        "recursion": recursion_program(chain),
    }
    batch = np.random.default_rng(0).uniform(-np.pi, np.pi, (BATCH, robot.n))
    one, data = batch[0].copy(), robot.model.createData()
    pinocchio = pin.computeGeneralizedGravity
    ways: dict[str, Callable[[], float]] = {
        "one, normal form": lambda: nanoseconds(lambda: potential.gradient(one), SINGLE, SINGLE),
        "one, recursion": lambda: nanoseconds(lambda: gravity.torque(one), SINGLE, SINGLE),
        "one, Pinocchio": lambda: nanoseconds(
            lambda: pinocchio(robot.model, data, one), SINGLE, SINGLE
        ),
        "batch, normal form": lambda: nanoseconds(lambda: potential.gradient(batch), BATCH),
        "batch, recursion": lambda: nanoseconds(lambda: gravity.torque(batch), BATCH),
        "batch, Pinocchio": lambda: nanoseconds(
            lambda: [pinocchio(robot.model, data, q) for q in batch], BATCH
        ),
    }
    if shutil.which("cc"):
        ways |= {f"C, {form}": in_c(gravity, p, folder) for form, p in programs.items()}
    for way in ways.values():
        way()
    times: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(turns):
        for way, run in ways.items():
            times[way].append(run())
    return {
        "robot": name,
        "frequencies": len(potential),
        "operations": {form: program.cost for form, program in programs.items()},
        "nanoseconds": {way: statistics.median(t) for way, t in times.items()},
    }


def table(rows: list[dict[str, Any]]) -> str:
    ways = list(rows[0]["nanoseconds"])
    head = ["robot", "frequencies", "operations: normal form", "recursion"]
    head += [f"{way} [ns]" for way in ways]
    lines = [" | ".join(head), " | ".join(["---"] * len(head))]
    for row in rows:
        cells = [row["robot"], row["frequencies"], *row["operations"].values()]
        cells += [f"{row['nanoseconds'][way]:.3g}" for way in ways]
        lines.append(" | ".join(map(str, cells)))
    return "\n".join(f"| {line} |" for line in lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", action="store_true", help="write JSON instead of a table")
    parser.add_argument("--turns", type=int, default=5, help="measurements of each way")
    options = parser.parse_args()
    rows = []
    with TemporaryDirectory() as folder:
        for robot in builtin_robots():
            print(robot.name, file=sys.stderr)
            rows.append(measure(robot.name, options.turns, Path(folder)))
    print(json.dumps(rows, indent=1) if options.json else table(rows))


if __name__ == "__main__":
    main()
