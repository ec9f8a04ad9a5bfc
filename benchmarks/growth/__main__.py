"""Measure how costs grow with joints, samples, prototypes and the order of the group.

Usage: python -m benchmarks.growth [--turns 9] [--no-pictures] [NAME ...]

NAME is joints, samples, prototypes or orders, all by default. Times are processor times of one
thread, medians of several turns in which the curves over one quantity alternate; points that take
seconds have fewer turns. The exponent is that of a power fitted by least squares, log time over log
x, to the upper half of the range of log x (three points at least), where costs that do not grow
dominate no longer; behind it stands its standard error. What grows exponentially has the factor
from one x to the next instead. The pictures go into docs/pictures.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")

import warnings
from pathlib import Path

from sklearn.exceptions import ConvergenceWarning

from benchmarks.growth import joints, orders, prototypes, samples
from benchmarks.growth.curves import Curve, Measured, measure
from benchmarks.growth.pictures import write_picture
from benchmarks.growth.table import table

PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
FAMILIES: dict[str, tuple[str, Callable[[], list[Curve]]]] = {
    "joints": ("joints", joints.curves),
    "samples": ("samples, queries", samples.curves),
    "prototypes": ("prototypes", prototypes.curves),
    "orders": ("order of the group", orders.curves),
}
"""Module, quantity and curves."""
REMARKS = f"""\
Exponents are fitted to the upper half of each range, with standard errors; a factor is that from
one joint to the next. A potential with n joints has up to (3^n - 1) / 2 frequencies, and random
arms have them all; a planar chain has n, and a group of order 2^(n + 1). Samples and queries are
of the 2R arm with its group of order 8. Online learners get samples in blocks of {samples.BLOCK}
and learn all of them: exponent 1 means that a sample costs the same however many came before. The
network takes a fixed number of steps. `RecursiveLeastSquares` keeps 1000 samples; until then it has
none to choose from, and a sample costs less. Prototypes are of the 2R arm without symmetries.
`LocalLinearMap` looks at as many prototypes however many there are, but samples far from each other
find them outside the processor's cache; along a path they do not. A sample that becomes a prototype
is put into a sorted list of all of them. Orders are those of nested subgroups of the group of the
planar arm with four joints, the number of samples and prototypes being the same."""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("names", nargs="*", help=f"{', '.join(FAMILIES)}; all by default")
    parser.add_argument("--turns", type=int, default=9, help="turns of each point")
    parser.add_argument("--no-pictures", action="store_true", help="write no pictures")
    options = parser.parse_args()
    unknown = set(options.names) - set(FAMILIES)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(FAMILIES)}")
    start = time.process_time()
    measured: dict[str, list[Measured]] = {}
    links = []
    for name in options.names or FAMILIES:
        quantity, curves = FAMILIES[name]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            found = measure(curves(), options.turns, lambda text: print(text, file=sys.stderr))
        measured[quantity] = found
        if not options.no_pictures:
            path = write_picture(PICTURES, name, quantity, found)
            links.append(f"![Processor time against {quantity}](pictures/{path.name})")
    minutes = (time.process_time() - start) / 60
    parts = [table(measured), REMARKS, *links, f"Measured in {minutes:.1f} minutes on one core."]
    print("\n\n".join(parts))


if __name__ == "__main__":
    main()
