"""Derive gravity and symmetries of every URDF of example-robot-data.

Usage: python -m benchmarks.robots [--write] [--json] [--limit 25] [ROBOT ...]

Needs the package example-robot-data (extra ``robots``). One row per file: the joints that move,
those that had to be locked (prismatic, floating, planar and mimic joints), the blocks of joints
that share frequencies, the group's structure, and processor times of reading and deriving (with
the check against Pinocchio) and of the group with the proofs of its generators. The root link is
fixed. ROBOT is a part of a file's path. ``--write`` puts the table into docs/robots.md.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from benchmarks.shared.time_limit import OutOfTimeError, at_most
from benchmarks.shared.urdf_arms import example_robots
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import group_structure
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.robots.urdf.urdf_file import parse_urdf
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

PAGE = Path(__file__).parents[1] / "docs" / "robots.md"
SECTION = "written by python -m benchmarks.robots --write"
DEMANDED = 60
SLACK = 6
"""A robot is given up after this many limits by the wall clock, on however busy a machine."""


def files(names: list[str]) -> list[Path]:
    """Return the URDF files of example-robot-data whose path contains one of ``names``.

    Raises
    ------
    InputError
        If the package is not installed, or a name fits no file.
    """
    folder = example_robots()
    if folder is None:
        accepted = "the package installed: pip install example-robot-data"
        raise InputError("benchmark", "example-robot-data", "missing", accepted)
    every = sorted(folder.rglob("*.urdf"))
    for name in names:
        if not any(name in str(path.relative_to(folder)) for path in every):
            raise InputError("command line", "robots", name, f"part of a path in {folder.name}")
    return [
        path
        for path in every
        if not names or any(name in str(path.relative_to(folder)) for name in names)
    ]


def load_with_grippers_locked(path: Path) -> tuple[Robot, list[str]]:
    """Load a robot; where it is refused, once more with all but its revolute joints locked.

    Returns
    -------
    tuple
        The robot, and the names of the locked joints.
    """
    try:
        return load_robot(path), []
    except InputError:
        joints = parse_urdf(path.read_bytes(), str(path)).joints
        unsupported = [
            joint.name
            for joint in joints
            if joint.kind not in ("fixed", "revolute", "continuous") or joint.mimic is not None
        ]
        if not unsupported:
            raise
        return load_robot(path, lock=unsupported), unsupported


def measure(path: Path, limit: float) -> dict[str, Any]:
    """Derive one robot and its group."""
    row: dict[str, Any] = {"robot": path.stem, "within": False}
    try:
        with at_most(SLACK * limit):
            start = time.process_time()
            robot, locked = load_with_grippers_locked(path)
            row |= {"joints": robot.n, "locked": len(locked)}
            gravity = GravityModel(robot)
            row["frequencies"] = len(gravity.significant_potential)
            row["derive_seconds"] = time.process_time() - start
            start = time.process_time()
            group = primary_symmetries(gravity.potential)
            row |= {
                "order": group.order,
                "proved": group.exact,
                "blocks": len(group.direct_factors),
                "structure": group_structure(group),
                "symmetries_seconds": time.process_time() - start,
            }
            row["within"] = row["derive_seconds"] + row["symmetries_seconds"] <= limit
    except InputError as error:
        row["refused"] = str(error).split(": ", 1)[-1]
    except OutOfTimeError:
        pass
    return row


def table(rows: list[dict[str, Any]], limit: float) -> str:
    """Return the table, with what it amounts to above it."""
    within = sum(row["within"] for row in rows)
    head = ["robot", "joints", "locked", "frequencies", "blocks", "group", "proved"]
    head += ["derive [s]", "group [s]", f"within {limit:g} s"]
    lines = [f"{within} of {len(rows)} robots within {limit:g} s of processor time", ""]
    lines += [f"| {' | '.join(head)} |", f"| {' | '.join(['---'] * len(head))} |"]
    for row in rows:
        cells = [row["robot"], row.get("joints", ""), row.get("locked", "")]
        cells += [row.get("frequencies", ""), row.get("blocks", "")]
        refused = row.get("refused")
        cells.append(f"refused: {refused}" if refused else row.get("structure", "").split(":")[0])
        cells.append({True: "yes", False: "bounded", None: ""}[row.get("proved")])
        times = (row.get("derive_seconds"), row.get("symmetries_seconds"))
        cells += ["" if seconds is None else f"{seconds:.2f}" for seconds in times]
        cells.append("yes" if row["within"] else "no")
        lines.append(f"| {' | '.join(str(cell) for cell in cells)} |")
    return "\n".join(lines)


@clear_errors
def main() -> int:
    """Measure, print or write; return 1 if fewer robots than demanded are within the limit."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("robots", nargs="*", help="parts of paths, all robots by default")
    parser.add_argument("--limit", type=float, default=25.0, help="processor time of a robot [s]")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.add_argument("--write", action="store_true", help="write the table to docs/robots.md")
    options = parser.parse_args()
    rows = []
    for path in files(options.robots):
        print(path.stem, file=sys.stderr)
        rows.append(measure(path, options.limit))
    text = table(rows, options.limit)
    if options.write:
        write_between(PAGE, SECTION, text)
    print(json.dumps(rows, indent=1) if options.json else text)
    whole = not options.robots
    return int(whole and sum(row["within"] for row in rows) < DEMANDED)


if __name__ == "__main__":
    sys.exit(main())
