"""Run ``isotorque run`` with default options on many arms; each must end with a report.

Usage: python -m benchmarks.run_arms [--write] [--jobs 2] [ARM ...]

The arms are the built-in ones, small ones with the features of well-known arms
(`benchmarks.shared.small_arms`) and, where example-robot-data is installed, its serial arms. Where
a file is refused with options that would work (grippers to be locked), it is run again with exactly
those. A run has to end with a report, exit status 0 or 1, within three minutes of processor time.
``--write`` puts the table into docs/robots.md.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from benchmarks.shared.document import write_between
from benchmarks.shared.small_arms import SMALL_ARMS, write_arm
from isotorque.symbolic.robots.builtin_robots import builtin_robots

PAGE = Path(__file__).parents[1] / "docs" / "robots.md"
DEMANDED_SECONDS = 180.0
SERIAL = (
    "asr_twodof_description/urdf/TwoDofs",
    "borinot_description/urdf/borinot_flying_arm_2",
    "double_pendulum_description/urdf/double_pendulum",
    "double_pendulum_description/urdf/double_pendulum_continuous",
    "double_pendulum_description/urdf/double_pendulum_simple",
    "hextilt_description/urdf/hextilt_flying_arm_5",
    "kinova_description/robots/kinova",
    "panda_description/urdf/panda",
    "so_arm_description/urdf/so100",
    "so_arm_description/urdf/so101",
    "talos_data/robots/talos_left_arm",
    "ur_description/urdf/ur10_joint_limited_robot",
    "ur_description/urdf/ur10_robot",
    "ur_description/urdf/ur3",
    "ur_description/urdf/ur3_gripper",
    "ur_description/urdf/ur3_joint_limited_robot",
    "ur_description/urdf/ur3_robot",
    "ur_description/urdf/ur5_gripper",
    "ur_description/urdf/ur5_joint_limited_robot",
    "ur_description/urdf/ur5_robot",
    "xarm_description/urdf/xarm7",
    "z1_description/urdf/z1",
)
"""Serial arms of example-robot-data, below its folder ``robots``, grippers included."""
OPTION = re.compile(r"--(?:lock|joints|tip)[ =](?:'[^']*'|\S+)")


@dataclass(frozen=True)
class Row:
    """End of a run.

    Attributes
    ----------
    arm : str
    options : tuple of str
        Options that the refusal of the bare file advised.
    status : int
        Exit status.
    seconds : float
        Processor time [s], that of refused attempts included.
    report : dict or None
        The run's report, if it ended with one.
    error : str
        What was said instead.
    """

    arm: str
    options: tuple[str, ...]
    status: int
    seconds: float
    report: dict[str, Any] | None
    error: str

    @property
    def holds(self) -> bool:
        """Whether it ended as demanded."""
        return self.report is not None and self.seconds < DEMANDED_SECONDS

    def cells(self) -> tuple[str, ...]:
        """The row of the table."""
        ends = f"{self.status}", f"{self.seconds:.0f}"
        name = self.arm + "".join(f" `{option}`" for option in self.options)
        if self.report is None:
            return name, "-", "-", "-", "-", "-", f"-, {self.error}", *ends
        setup, totals = self.report["setup"], self.report["totals"]
        model, poses = self.report["model"], totals["chain_poses"]
        rmse = "nothing learned" if model is None else f"{totals['rmse_torque']:.3g}"
        return (
            name,
            str(len(setup["joint_names"])),
            setup["physics"],
            f"{totals['relations_found']} of {totals['relations_true']}",
            str(totals["discovery_motions"]),
            "not accepted" if poses is None else str(poses),
            rmse,
            *ends,
        )


HEADS = (
    "arm",
    "joints",
    "physics",
    "relations",
    "motions to find them",
    "poses until a rigid chain knew the whole map",
    "torque RMSE [N m]",
    "exit",
    "processor time [s]",
)


def subjects(folder: Path) -> Iterator[tuple[str, str]]:
    """Name and ROBOT argument of every arm; small ones are written to ``folder``."""
    for robot in builtin_robots():
        yield robot.name, robot.name
    for name in SMALL_ARMS:
        yield name, str(write_arm(name, folder))
    root = example_robots()
    for path in SERIAL if root is not None else ():
        yield path.rsplit("/", 1)[-1] + ".urdf", f"{root}/{path}.urdf"


def example_robots() -> Path | None:
    """Folder of the robots of example-robot-data; None where it is not installed."""
    try:
        listed = metadata.files("example-robot-data") or []
    except metadata.PackageNotFoundError:
        return None
    for file in listed:
        if file.name == "TwoDofs.urdf":
            return Path(str(file.locate())).resolve().parents[2]
    return None


def run_arm(name: str, robot: str, folder: Path) -> Row:
    """Run one arm with default options, and with those that a refusal advises."""
    done, seconds = _attempt(robot, (), folder / name)
    advised = tuple(OPTION.findall(done.stderr)) if done.returncode == 2 else ()
    if advised:
        done, more = _attempt(robot, advised, folder / name)
        seconds += more
    report = json.loads(done.stdout) if done.returncode in (0, 1) and done.stdout else None
    said = done.stderr.replace(robot, name).strip()[-300:]
    return Row(name, advised, done.returncode, seconds, report, said)


def _attempt(robot: str, options: Sequence[str], out: Path) -> tuple[Any, float]:
    words = [word for option in options for word in shlex.split(option)]
    command = [sys.executable, "-m", "isotorque", "run", robot, "--out", str(out)]
    script = (
        "import resource, subprocess, sys\n"
        "code = subprocess.run(sys.argv[2:]).returncode\n"
        "used = resource.getrusage(resource.RUSAGE_CHILDREN)\n"
        "open(sys.argv[1], 'w').write(str(used.ru_utime + used.ru_stime))\n"
        "sys.exit(code)"
    )
    used = out.with_name(out.name + ".seconds")
    done = subprocess.run(
        [sys.executable, "-c", script, str(used), *command, "--quiet", "--json", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    return done, float(used.read_text())


def table(rows: Sequence[Row]) -> str:
    """Return the rows as a Markdown table, and how many of them hold."""
    lines = [HEADS, ("---",) * len(HEADS), *(row.cells() for row in rows)]
    held = sum(row.holds for row in rows)
    slowest = max(row.seconds for row in rows)
    poses = [row.report["totals"]["chain_poses"] for row in rows if row.report is not None]
    known = [count for count in poses if count is not None]
    passed = sum(row.status == 0 for row in rows)
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + (
        f"\n\n{held} of {len(rows)} runs ended with a report within"
        f" {DEMANDED_SECONDS:g} s of processor time, the slowest after {slowest:.0f} s."
        f" {passed} passed: the model is right to 1 % of each joint's largest torque. A rigid chain"
        f" knew the whole map in {len(known)} of them, after at most {max(known, default=0)} poses."
    )


def main() -> int:
    """Run the arms named, or all; print the table; return 1 if a run did not end as demanded."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arms", nargs="*", metavar="ARM")
    parser.add_argument("--write", action="store_true", help="put the table into docs/robots.md")
    parser.add_argument("--jobs", type=int, default=2, help="runs at the same time")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        chosen = [s for s in subjects(folder) if not given.arms or s[0] in given.arms]
        began = time.monotonic()

        def run(subject: tuple[str, str]) -> Row:
            row = run_arm(*subject, folder)
            print(f"{time.monotonic() - began:.0f} s:", *row.cells(), file=sys.stderr, flush=True)
            return row

        with ThreadPoolExecutor(given.jobs) as pool:
            rows = list(pool.map(run, chosen))
    text = table(rows)
    print(text)
    if given.write:
        write_between(PAGE, "runs of arms", text)
    return 0 if all(row.holds for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
