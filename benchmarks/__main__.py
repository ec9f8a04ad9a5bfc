"""Run benchmarks and write docs/benchmarks.md: ``python -m benchmarks [NAME ...]``.

Without names: those with a title here, some ten minutes. Other benchmarks (see the files beside
this one) take longer, are run by name, and are not written to the page.
"""

from __future__ import annotations

import platform
import subprocess
import sys
from importlib import metadata
from pathlib import Path

TITLES = {
    "derive": "Deriving gravity and its symmetries",
    "groups": "Groups beside brute force",
    "gravity_forms": "Evaluating the gravity torque",
    "simulate": "Simulating",
    "learning_costs": "Learning: updates, predictions, fits",
    "growth": "How costs grow",
    "start": "Starting",
}
PACKAGES = ("numpy", "numba", "pin", "sympy", "casadi", "adam-robotics", "mujoco", "scikit-learn")
PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"


def main() -> int:
    """Run each benchmark in a process of its own; return 1 if one failed."""
    sections, failed = [_heading()], False
    named = sys.argv[1:]
    for name in named or TITLES:
        title = TITLES.get(name, name)
        print(f"== {title}", file=sys.stderr)
        command = [sys.executable, "-m", f"benchmarks.{name}"]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        print(done.stdout)
        failed |= done.returncode != 0
        command_line = f"python -m benchmarks.{name}"
        sections.append(f"## {title}\n\n`{command_line}`\n\n{done.stdout.strip()}\n")
    if not failed and not named:
        PAGE.write_text("\n".join(sections))
        print(f"written: {PAGE}")
    return int(failed)


def _heading() -> str:
    versions = []
    for package in PACKAGES:
        try:
            versions.append(f"{package} {metadata.version(package)}")
        except metadata.PackageNotFoundError:
            versions.append(f"{package} not installed")
    return (
        "# Benchmarks\n\nWritten by `make bench`. "
        "Ratios are firm, absolute times are this machine's.\n\n"
        f"{platform.machine()}, Python {platform.python_version()}; {', '.join(versions)}.\n"
    )


if __name__ == "__main__":
    sys.exit(main())
