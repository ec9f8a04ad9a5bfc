"""Learn online on the simulated arm and count samples: ``python -m benchmarks.online``.

Every run is the whole scheme: symmetries and static torques are discovered by the arm itself
(those samples are counted apart), then it explores and learns. A threshold counts as reached at
the first evaluation after which the error stays below it to the end of the run. Errors are root
mean squares over joints and test configurations. Medians over seeds, the worst seed beside them.

``--write`` puts the table into docs/online.md. ``--keep DIR`` keeps finished runs, so that a
benchmark that was stopped goes on when the command is given again.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

from benchmarks.online.comparison import comparison_rows
from benchmarks.online.counted import three_joint_rows, two_joint_rows
from benchmarks.online.literal import literal_rows, mode_rows
from benchmarks.online.noise import noise_rows
from benchmarks.online.speed import speed_rows
from benchmarks.online.store import Store
from benchmarks.online.table import Row, table
from benchmarks.shared.document import write_between

PAGE = Path(__file__).parents[2] / "docs" / "online.md"

ROWS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "literal": literal_rows,
    "modes": mode_rows,
    "2r": two_joint_rows,
    "3r": three_joint_rows,
    "speed": speed_rows,
    "comparison": comparison_rows,
    "noise": noise_rows,
}


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--wide-seeds", type=int, default=10, help="seeds of the 3R in open loop")
    parser.add_argument("--few-seeds", type=int, default=5, help="seeds of comparisons and noise")
    parser.add_argument("--long-seeds", type=int, default=3, help="seeds of 54,000 samples")
    parser.add_argument("--mode-seeds", type=int, default=1, help="the same, geared and guided")
    parser.add_argument("--write", action="store_true", help="put the table into docs/online.md")
    parser.add_argument("--only", nargs="*", choices=list(ROWS), default=list(ROWS))
    parser.add_argument("--keep", type=Path, help="keep finished runs here; go on from them")
    options = parser.parse_args()
    options.store = Store(options.keep)
    rows: list[Row] = []
    for name in options.only:
        for row in ROWS[name](options):
            print(row.line(), file=sys.stderr, flush=True)
            rows.append(row)
    text = table(rows)
    print(text)
    if options.write:
        write_between(PAGE, "measured", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
