"""Time the learners' updates, predictions and batch fits beside other learners, taking turns.

Usage: python -m benchmarks.learning_costs [--json] [--turns 5] [ROBOT ...]

All are given the exact symmetries of the arm: the learners of this package as their group,
scikit-learn's as all symmetric copies of every sample. In each turn every contestant runs once;
times are medians of processor time on one core. A ratio is the peer's time over that of the learner
in brackets, the median of the ratios within turns. The error beside is that on 1000 configurations
over all joint angles: a fast fit of a bad model is no peer.

* LLM: the local linear map as printed (Eq. 17-22); "one call": many samples handed over at once.
* LLM_it: the same with samples learned to convergence, wide kernels and 60 replayed samples.
* least squares: recursive least squares, solved anew after every sample.
* literal LLM: the printed equations in NumPy, with loops over the prototypes or array operations.
* Pinocchio: computeGeneralizedGravity in a loop. It knows the truth and learns nothing.

A contestant that has used up its processor time in the first turns skips the others.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

from sklearn.exceptions import ConvergenceWarning

from benchmarks.learning_costs.contests import (
    Bench,
    Contestant,
    fit_contest,
    prediction_contests,
    update_contest,
)
from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.time_limit import OutOfTimeError, at_most

ROBOTS = ("2r", "3r", "ur5")
KNOWN = 400  # samples learned before updates are timed
FITTED = (64, 255)
PATIENCE = 5.0  # seconds after which a contestant skips the remaining turns
LIMIT = 20.0  # seconds after which a run is given up
NOTES = {
    "Updates": "One sample with all its symmetric copies, after {options.known} samples; errors "
    "after these.",
    "Predictions": "LLM and least squares after {options.known} samples over all joint angles, the "
    "others fitted to {options.fitted[0]} on a lattice in the fundamental domain.",
    "Batch fits": "Fits to a lattice in the fundamental domain, scikit-learn's to all copies. "
    "The network has 16 random starts, MLPRegressor one.",
}


@dataclass(frozen=True)
class Figure:
    """Median seconds (None: more than the limit), ratios to others, error [N m]."""

    seconds: float | None
    ratios: dict[str, float]
    rmse: float | None


@dataclass(frozen=True)
class Row:
    """One learner on one arm, with a figure for each thing measured."""

    robot: str
    learner: str
    figures: dict[str, Figure]


def take_turns(contestants: Sequence[Contestant], turns: int) -> dict[str, Figure]:
    """Let every contestant run once in each turn."""
    times: dict[str, list[float]] = {x.name: [] for x in contestants}
    spent = dict.fromkeys(times, 0.0)
    for _ in range(turns):
        for entry in contestants:
            if spent[entry.name] > PATIENCE:
                continue
            start = time.process_time()
            with suppress(OutOfTimeError), at_most(LIMIT):
                times[entry.name].append(entry.run())
            spent[entry.name] += time.process_time() - start
    return {
        entry.name: Figure(
            statistics.median(times[entry.name]) if times[entry.name] else None,
            {
                other: median_ratio(times[entry.name] or [LIMIT], times[other])
                for other in entry.beside
            },
            entry.error(),
        )
        for entry in contestants
    }


def median_ratio(above: list[float], below: list[float]) -> float:
    """Return the median of the ratios within turns."""
    return statistics.median(a / b for a, b in zip(above, below, strict=False))


def measure(
    name: str, turns: int, known: int, fitted: Sequence[int]
) -> Iterator[tuple[str, list[Row]]]:
    """Run the contests on one arm: a title and its rows each."""
    bench = Bench(name)
    contests: dict[str, Callable[[], dict[str, list[Contestant]]]] = {
        "Updates": lambda: {"one by one": update_contest(bench, known)},
        "Predictions": lambda: prediction_contests(bench, known, fitted[0]),
        "Batch fits": lambda: {f"{count} samples": fit_contest(bench, count) for count in fitted},
    }
    for title, contest in contests.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            figures = {what: take_turns(entries, turns) for what, entries in contest().items()}
        learners = next(iter(figures.values()))
        yield (
            title,
            [
                Row(
                    f"{name} ({bench.group.order})",
                    learner,
                    {w: f[learner] for w, f in figures.items()},
                )
                for learner in learners
            ],
        )


def table(rows: list[Row], unit: str) -> str:
    """The rows of one contest as Markdown, errors once where they are all the same."""
    ways = list(rows[0].figures)
    scale = {"us": 1e6, "s": 1.0}[unit]
    errors_differ = any(len({f.rmse for f in row.figures.values()}) > 1 for row in rows)
    head = ["robot (copies)", "learner"]
    for way in ways:
        head += [f"{way} [{unit}]", "times ours"]
        if errors_differ or way == ways[-1]:
            head.append("RMSE [N m]")
    lines = [" | ".join(head), " | ".join(["---"] * len(head))]
    for row in rows:
        cells = [row.robot, row.learner]
        for way, figure in row.figures.items():
            late = "" if figure.seconds is not None else "> "
            seconds = LIMIT if figure.seconds is None else figure.seconds
            cells.append(f"{late}{scale * seconds:.3g}")
            cells.append(", ".join(f"{late}{r:.2g} ({x})" for x, r in figure.ratios.items()))
            if errors_differ or way == ways[-1]:
                cells.append("" if figure.rmse is None else f"{figure.rmse:.2g}")
        lines.append(" | ".join(cells))
    return "\n".join(f"| {line} |" for line in lines)


@clear_errors
def main() -> int:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", default=list(ROBOTS), help="arms, all by default")
    parser.add_argument("--json", action="store_true", help="write JSON instead of tables")
    parser.add_argument("--turns", type=int, default=5, help="turns of each contestant")
    parser.add_argument("--known", type=int, default=KNOWN, help="samples learned before updates")
    parser.add_argument(
        "--fitted", type=int, nargs="+", default=list(FITTED), help="samples of batch fits"
    )
    options = parser.parse_args()
    start = time.process_time()
    found: dict[str, list[Row]] = {}
    for name in options.robots:
        for title, rows in measure(name, options.turns, options.known, options.fitted):
            print(name, title, file=sys.stderr)
            found.setdefault(title, []).extend(rows)
    seconds = time.process_time() - start
    if options.json:
        print(
            json.dumps(
                {title: [asdict(r) for r in rows] for title, rows in found.items()}, indent=1
            )
        )
        return 0
    for title, rows in found.items():
        print(f"### {title}\n\n{NOTES[title].format(options=options)}\n")
        print(table(rows, "s" if title == "Batch fits" else "us"), end="\n\n")
    print(f"Measured in {seconds:.0f} s of processor time on one core.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
