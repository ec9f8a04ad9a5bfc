"""Start-up: processor time of the package and of short commands, each in a process of its own.

Usage: python -m benchmarks.start [--repeats 10]

User and system time of the whole process, the least of the repeats: other work on the machine can
only add to it.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys

IMPORT = ["-c", "import isotorque"]
DEMANDED: dict[str, tuple[list[str], float | None]] = {
    "python -c pass": (["-c", "pass"], None),
    "python -c 'import isotorque'": (IMPORT, 0.1),
    "isotorque robots": (["-m", "isotorque", "robots"], 0.4),
    "isotorque symmetries 2r": (["-m", "isotorque", "symmetries", "2r"], 0.8),
    "isotorque symmetries panda": (["-m", "isotorque", "symmetries", "panda"], None),
    "isotorque derive 2r": (["-m", "isotorque", "derive", "2r"], None),
    "isotorque domain 2r": (["-m", "isotorque", "domain", "2r"], None),
    "python -c 'import sympy'": (["-c", "import sympy"], None),
    "python -c 'import numba'": (["-c", "import numba"], None),
}
"""Arguments of Python, and the most it may take [s]."""


def main() -> int:
    """Print the table; return 1 if something takes longer than demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=10)
    repeats = parser.parse_args().repeats
    print("| process | processor time [s] | demanded [s] |\n| --- | --- | --- |")
    slow = False
    for name, (arguments, most) in DEMANDED.items():
        seconds = min(processor_time(arguments) for _ in range(repeats))
        slow |= most is not None and seconds > most
        print(f"| `{name}` | {seconds:.2f} | {'' if most is None else most} |")
    return int(slow)


def processor_time(arguments: list[str]) -> float:
    """Return user and system time [s] of a Python process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    sys.exit(main())
