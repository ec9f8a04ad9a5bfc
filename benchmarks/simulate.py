"""Time the settling of simulated arms, engine beside engine, in one process, taking turns.

Usage: python -m benchmarks.simulate [--json] [--turns 7] [--samples 300] [ROBOT ...]

Every sample starts at rest 0.1 rad from a stable equilibrium and settles under its torque, by the
same rule (velocity, acceleration, dwell) under the same damping.

* compiled, pinocchio: the two engines of the simulator, to the finished equilibrium.
* plain loop: Euler steps of 1 ms with pin.aba in Python, to the settle rule.
* MuJoCo: its integrator implicitfast with steps of 5 ms, to the settle rule.
* whole step / ABA: one adaptive step of the compiled engine (two evaluations of the dynamics, three
  linear systems, error control, limits) beside one evaluation of the articulated-body algorithm in
  C made for the robot, where there is a C compiler.

Times are processor times of this process, so other work on the machine adds little; ratios are
medians over turns of the ratio within a turn.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from benchmarks.peers.compiled_aba import time_compiled_aba
from benchmarks.peers.simulation_peers import (
    MUJOCO_STEP,
    check,
    mujoco_settle,
    near_starts,
    plain_settle,
)
from benchmarks.shared.clear_errors import clear_errors
from isotorque.learning.arm import OutcomeKind
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_simulation import RecordedSimulation
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot

try:
    import mujoco

    from benchmarks.peers.mujoco_arm import mujoco_arm
except ImportError:
    mujoco = None

ROBOTS = ("2r", "3r", "ur5", "panda")
DEMANDED_COMPILED = {"2r": 400.0, "3r": 400.0, "ur5": 500.0, "panda": 500.0}
DEMANDED_PINOCCHIO = 10.0
DEMANDED_STEP = {2: 15.0, 7: 6.0}
DEMANDED_SEQUENCE = 6.0
DEMANDED_RECORDED = 10.0
SEQUENCE = 54_000
STEP_TURNS = 40


def timed(work: Callable[[], Any], samples: int) -> float:
    """Return the seconds per sample."""
    start = time.process_time()
    work()
    return (time.process_time() - start) / samples


def measure(name: str, turns: int, samples: int) -> dict[str, Any]:
    robot = load_robot(name)
    compiled = SimulatedArm(robot)
    reference = SimulatedArm(robot, engine="pinocchio", home=compiled.home)
    starts = near_starts(compiled, samples)
    few, fewest = slice(max(samples // 20, 4)), slice(max(samples // 100, 3))
    model, data = robot.model, robot.model.createData()
    settled = compiled.settle_each(starts.q, starts.torques)
    steps = float(settled.steps.mean())
    ways: dict[str, Callable[[], float]] = {
        "compiled": lambda: timed(
            lambda: compiled.settle_each(starts.q, starts.torques), len(starts.q)
        ),
        "pinocchio": lambda: timed(
            lambda: reference.settle_each(starts.q[few], starts.torques[few]), few.stop
        ),
        "plain": lambda: timed(
            lambda: [
                plain_settle(compiled, model, data, q, t)
                for q, t in zip(starts.q[fewest], starts.torques[fewest], strict=True)
            ],
            fewest.stop,
        ),
    }
    if mujoco is not None:
        other = mujoco_arm(model, compiled.damping, timestep=MUJOCO_STEP)
        other_data = mujoco.MjData(other)
        ways["mujoco"] = lambda: timed(
            lambda: [
                mujoco_settle(compiled, other, other_data, q, t)
                for q, t in zip(starts.q[few], starts.torques[few], strict=True)
            ],
            few.stop,
        )
    aba = time_compiled_aba(model)
    check(compiled, model, data, starts, settled.q, fewest)
    taken: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(turns):
        for way, work in ways.items():
            taken[way].append(work())
    step, dynamics = [x / steps for x in taken["compiled"]], []
    if aba is not None:
        step = []
        for _ in range(STEP_TURNS):  # short turns: both meet the same state of the machine
            step.append(ways["compiled"]() / steps)
            dynamics.append(aba(int(5e-3 / step[-1])))
    return {
        "robot": name,
        "joints": robot.n,
        "steps_per_settle": steps,
        "seconds_per_settle": {way: statistics.median(taken[way]) for way in ways},
        "compiled_vs_plain": median_ratio(taken["plain"], taken["compiled"]),
        "compiled_vs_plain_demanded": DEMANDED_COMPILED.get(name),
        "pinocchio_vs_plain": median_ratio(taken["plain"], taken["pinocchio"]),
        "pinocchio_vs_plain_demanded": DEMANDED_PINOCCHIO,
        "mujoco_vs_plain": median_ratio(taken["plain"], taken.get("mujoco", [])),
        "step_seconds": statistics.median(step),
        "aba_seconds": statistics.median(dynamics) if dynamics else None,
        "step_vs_aba": median_ratio(step, dynamics),
        "step_vs_aba_demanded": DEMANDED_STEP.get(robot.n),
    }


def median_ratio(above: list[float], below: list[float]) -> float | None:
    """Return the median of the ratios within turns."""
    ratios = [a / b for a, b in zip(above, below, strict=False)]
    return statistics.median(ratios) if ratios else None


def measure_sequence() -> dict[str, Any]:
    """Time 54,000 sequential settled samples of the 2R arm, commanded from Python."""
    arm = SimulatedArm(load_robot("2r"))
    rng = np.random.default_rng(0)
    targets = arm.home + rng.uniform(-0.6, 0.6, (SEQUENCE, 2))
    torques = [arm.equations.gravity_torque(q) for q in targets]
    arm.apply(torques[0])
    start = time.process_time()
    settled = sum(arm.apply(torque).kind is OutcomeKind.SETTLED for torque in torques)
    seconds = time.process_time() - start
    recorded = measure_recorded(torques)
    return {
        "robot": "2r",
        "samples": SEQUENCE,
        "settled": settled,
        "sequence_seconds": seconds,
        "sequence_seconds_demanded": DEMANDED_SEQUENCE,
        "recorded_seconds": recorded,
        "recorded_seconds_demanded": DEMANDED_RECORDED,
    }


def measure_recorded(torques: list[Any]) -> float:
    """Time the same with every sample committed to disk before the next motion [s, wall clock]."""
    robot = load_robot("2r")
    arm = SimulatedArm(robot)
    info = RunInfo(robot.name, robot.digest, robot.joint_names)
    with (
        TemporaryDirectory() as folder,
        Recording.create(Path(folder) / "run.sqlite", info) as recording,
    ):
        recorded = RecordedSimulation(arm, recording)
        recorded.apply(torques[0])
        start = time.perf_counter()
        for torque in torques:
            recorded.apply(torque)
        return time.perf_counter() - start


def table(rows: list[dict[str, Any]], sequence: dict[str, Any] | None) -> str:
    head = ["robot", "compiled [us]", "pinocchio [us]", "MuJoCo [us]", "plain loop [us]"]
    head += ["compiled: times plain (demanded)", "pinocchio: times plain (demanded)"]
    head += ["steps", "whole step [ns]", "ABA [ns]", "step / ABA (demanded)"]
    lines = [" | ".join(head), " | ".join(["---"] * len(head))]
    for row in rows:
        cells = [row["robot"]]
        seconds = row["seconds_per_settle"]
        cells += [micro(seconds.get(way)) for way in ("compiled", "pinocchio", "mujoco", "plain")]
        cells.append(beside(row["compiled_vs_plain"], row["compiled_vs_plain_demanded"], ">="))
        cells.append(beside(row["pinocchio_vs_plain"], row["pinocchio_vs_plain_demanded"], ">="))
        cells.append(f"{row['steps_per_settle']:.0f}")
        cells.append(f"{1e9 * row['step_seconds']:.0f}")
        cells.append(f"{1e9 * row['aba_seconds']:.0f}" if row["aba_seconds"] else "")
        cells.append(beside(row["step_vs_aba"], row["step_vs_aba_demanded"], "<="))
        lines.append(" | ".join(cells))
    text = "\n".join(f"| {line} |" for line in lines)
    if sequence is not None:
        text += (
            f"\n\n{sequence['samples']} sequential settled samples of the 2R arm, from Python: "
            f"{sequence['sequence_seconds']:.2f} s (demanded: at most "
            f"{sequence['sequence_seconds_demanded']:.0f} s), with recording "
            f"{sequence['recorded_seconds']:.2f} s of wall clock (demanded: at most "
            f"{sequence['recorded_seconds_demanded']:.0f} s)"
        )
    return text


def micro(seconds: float | None) -> str:
    return "" if seconds is None else f"{1e6 * seconds:.4g}"


def beside(value: float | None, demanded: float | None, relation: str) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" + (f" ({relation} {demanded:g})" if demanded else "")


@clear_errors
def main() -> int:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", default=list(ROBOTS), help="arms, all by default")
    parser.add_argument("--json", action="store_true", help="write JSON instead of a table")
    parser.add_argument("--turns", type=int, default=7, help="turns of each engine")
    parser.add_argument("--samples", type=int, default=300, help="settled samples per turn")
    options = parser.parse_args()
    rows = []
    for name in options.robots:
        print(name, file=sys.stderr)
        rows.append(measure(name, options.turns, options.samples))
    sequence = measure_sequence() if "2r" in options.robots else None
    if options.json:
        print(json.dumps(rows + ([sequence] if sequence else []), indent=1))
    else:
        print(table(rows, sequence))
    return 0


if __name__ == "__main__":
    sys.exit(main())
