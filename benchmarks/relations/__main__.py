"""Learning relations from recordings: how many samples and torques the whole group takes.

Usage: python -m benchmarks.relations [--seeds 100] [--json] [--write]

*Both methods* (what ``isotorque relations`` does) and *pairing* alone get recordings of level sets:
all configurations of random |torque|, each kept with a probability drawn from 30-60 %.
*Identification* gets what an arm without a controller can rest at (stable configurations, uniform
over them). Angles have independent normal errors; torques are exact; nobody tells the learner the
noise level. A run is right if it finds the whole group and nothing else, offsets within 1e-9 rad
(exact angles) or 0.2 deg. With --write the table goes into docs/relations.md. About ten minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from dataclasses import asdict
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from benchmarks.relations.rows import SECONDS, Case, Row, run
from benchmarks.shared.document import write_between

PAGE = Path(__file__).parents[2] / "docs" / "relations.md"

NOISY = "95 % of seeds, precision 0.99"
CASES = (
    Case("both methods", "2r", 6, 0.0, "8 of 8"),
    Case("both methods", "3r", 4, 0.0, "16 of 16"),
    Case("both methods", "4r-planar", 3, 0.0, "32 of 32", share_of_seeds=0.1),
    Case("both methods", "ur5", 4, 0.0, "16, modulo free directions", share_of_seeds=0.5),
    Case("both methods", "2r", 12, 0.5, NOISY, least_right=0.95, least_precision=0.99),
    Case("both methods", "3r", 8, 0.5, NOISY, least_right=0.95, least_precision=0.99),
    Case("identification", "2r", 5, 0.0, "8 of 8"),
    Case("identification", "3r", 10, 0.0, "16 of 16"),
    Case("identification", "4r-planar", 21, 0.0, "32 of 32", share_of_seeds=0.2),
    Case("identification", "ur5", 10, 0.0, "16, modulo free directions"),
    Case("identification", "2r", 20, 0.1, "8 of 8, none false"),
    Case("identification", "3r", 60, 0.1, "16 of 16, none false"),
    Case("pairing", "2r", 6, 0.0),
    Case("pairing", "3r", 4, 0.0),
    Case("pairing", "4r-planar", 3, 0.0, share_of_seeds=0.05),
    Case("pairing", "ur5", 4, 0.0, share_of_seeds=0.5),
    Case("pairing", "2r", 12, 0.5, share_of_seeds=0.5),
    Case("pairing", "3r", 8, 0.5, share_of_seeds=0.2),
    Case("both methods", "2r", 12, 0.5, share_of_seeds=0.5, snap=False),
    Case("both methods", "3r", 8, 0.5, share_of_seeds=0.5, snap=False),
)
HEAD = [
    "method",
    "robot",
    "given",
    "noise [deg]",
    "whole group",
    "precision",
    "false (torque error)",
    "worst d [deg]",
    "seen in pairs",
    "CPU s, median (most)",
    "demanded",
    "holds",
]


def main(arguments: list[str] | None = None) -> int:
    """Print the table in Markdown, or as JSON; 1 if a row does not hold what is demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args(arguments)
    rows = []
    for case in CASES:
        print(f"{case.method}, {case.robot}, {case.count}, {case.degrees} deg", file=sys.stderr)
        rows.append(run(case, max(1, round(case.share_of_seeds * options.seeds))))
    if options.json:
        print(json.dumps([asdict(row) | {"holds": row.holds} for row in rows], indent=1))
    else:
        print(table(rows))
    if options.write:
        write_between(PAGE, "python -m benchmarks.relations --write", table(rows))
    return int(any(row.holds is False for row in rows))


def table(rows: list[Row]) -> str:
    """Rows as Markdown, with the sum of all false relations below."""
    lines = [HEAD, ["---"] * len(HEAD), *map(_cells, rows)]
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    runs, claimed = sum(row.seeds for row in rows), sum(row.claimed for row in rows)
    false = sum(row.false for row in rows)
    worst = max(row.false_torque_error for row in rows)
    error = f", torque error up to {worst:.2g} Nm" if false else ""
    return (
        f"{text}\n\nFalse relations in all {runs} runs: {false} of {claimed} claimed{error}. "
        f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}."
    )


def _cells(row: Row) -> list[str]:
    case = row.case
    kind = "stable samples" if case.method == "identification" else "torques"
    wrong = f"{row.false} ({row.false_torque_error:.2g} Nm)" if row.false else "0"
    limit = f", under {SECONDS[case.robot]:g} s" if case.robot in SECONDS else ""
    return [
        case.method,
        case.robot,
        f"{case.count} {kind}",
        f"{case.degrees:g}",
        f"{row.right} of {row.seeds}",
        f"{row.precision:.4g}",
        wrong,
        f"{np.rad2deg(row.worst_offset):.2g}{'' if case.snap else ' (not rounded)'}",
        f"{row.observed:.1f}",
        f"{row.seconds:.2g} ({row.most_seconds:.2g})",
        case.demanded + limit if case.demanded else "-",
        {True: "yes", False: "no", None: ""}[row.holds],
    ]


if __name__ == "__main__":
    sys.exit(main())
