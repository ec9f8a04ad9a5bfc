"""Relations claimed and causes named, held against contaminated arms: the protocol.

Usage: python -m benchmarks.claims [--jobs 2] [--share 0.05 --seed 1] [--robots ur5 panda]
[--kinds spring friction] [--cache FILE] [--write docs/claims.md]

Every data set is an arm with one thing wrong, or nothing, at 20, 100 or 500 random poses. Of each,
relations are learned and held against what the arm measures, and causes are named. Without
--share, 300 data sets of every kind and robot; with it, a share of each, drawn by the seed. What is
done is kept in the cache, so that an interrupted run goes on. With --write the tables go into a
page, between its marks. At most three hours on two cores. Exit status 1 if a demand does not hold.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.claims.data_sets import POOLS, ROBOTS, settings
from benchmarks.claims.demands import demands
from benchmarks.claims.outcomes import Outcome, outcomes
from benchmarks.claims.page import report
from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.document import write_between
from isotorque.symbolic.common.errors import InputError

CACHE = Path("out/claims.jsonl")
NAME = "python -m benchmarks.claims --write docs/claims.md"
EVERY = 200
"""Progress is said after so many data sets."""


def measured(
    robots: Sequence[str] = ROBOTS,
    kinds: Sequence[str] = POOLS,
    *,
    share: float = 1.0,
    seed: int = 0,
    jobs: int = 2,
    cache: Path | None = None,
) -> list[Outcome]:
    """Outcomes of all data sets, or of a share, in their order.

    Raises
    ------
    InputError
        For a robot or kind that there is not, or a share beyond 0 to 1.
    """
    for field, given, there in (("robots", robots, ROBOTS), ("kinds", kinds, POOLS)):
        for name in given:
            if name not in there:
                raise InputError("command line", field, name, ", ".join(there))
    if not 0.0 < share <= 1.0:
        raise InputError("command line", "share", share, "more than 0, at most 1")
    chosen = list(settings(robots, kinds, share=share, seed=seed))
    found: dict[object, Outcome] = {}
    for outcome in outcomes(chosen, cache, jobs):
        found[outcome.setting] = outcome
        if len(found) % EVERY == 0:
            print(f"{len(found)} of {len(chosen)} data sets", file=sys.stderr, flush=True)
    return [found[setting] for setting in chosen]


@clear_errors
def main() -> int:
    """Print the tables; 1 if a demand does not hold."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--robots", nargs="+", default=list(ROBOTS), help=", ".join(ROBOTS))
    parser.add_argument("--kinds", nargs="+", default=list(POOLS), help=", ".join(POOLS))
    parser.add_argument("--share", type=float, default=1.0, help="of the data sets of every kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--cache", type=Path, default=CACHE, help="file that keeps what is done")
    parser.add_argument("--write", type=Path, metavar="FILE", help="page for the tables")
    options = parser.parse_args()
    if options.write is not None and NAME not in _text(options.write):
        raise InputError("command line", "write", str(options.write), f"a page with marks {NAME}")
    found = measured(
        options.robots,
        options.kinds,
        share=options.share,
        seed=options.seed,
        jobs=options.jobs,
        cache=options.cache,
    )
    text = report(found, _command(options))
    print(text)
    if options.write is not None:
        write_between(options.write, NAME, text)
    return int(not all(demand.holds for demand in demands(found)))


def _command(options: argparse.Namespace) -> str:
    """What the outcomes depend on, as it would be typed."""
    words = ["python -m benchmarks.claims"]
    for name, given, whole in (("robots", options.robots, ROBOTS), ("kinds", options.kinds, POOLS)):
        if tuple(given) != whole:
            words.append(f"--{name} {shlex.join(given)}")
    words += [f"--share {options.share:g}"] if options.share < 1.0 else []
    return " ".join([*words, f"--seed {options.seed}"])


def _text(page: Path) -> str:
    return page.read_text(encoding="utf-8") if page.is_file() else ""


if __name__ == "__main__":
    sys.exit(main())
