"""The paper's learner to the letter: errors after 54,000 samples."""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator

from benchmarks.online.learners import LITERAL, literal
from benchmarks.online.runs import Plan, Run, all_seeds, guided_run, last_errors, scheme_run
from benchmarks.online.table import Row, spread
from benchmarks.online.truth import Truth

SETS = ("66", "90", "dense")
WHY = (
    "Where it has samples the learner is as good as with ideal ones; what is left lies in the "
    "corners and along the edges of what open loop can hold: the last 0.1 rad before an edge are "
    "the last 0.5 % of the torque, and where a torque is wrong by as much the arm falls."
)


def literal_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Open loop, the paper's test sets and the dense one."""
    truth = Truth.of("2r")
    plan = Plan(54_000, 18_000, SETS)
    runs = all_seeds(
        options.store,
        "literal",
        options.long_seeds,
        lambda seed: scheme_run(truth, literal, LITERAL, plan, seed, bold=True),
    )
    yield from _rows(runs, "at 54,000 samples", "0.0053 Nm", 0.0061)


def mode_rows(options: argparse.Namespace) -> Iterator[Row]:
    """The same with friction that holds the arm, and with a guided arm."""
    truth = Truth.of("2r")
    plan = Plan(54_000, 18_000, SETS)
    geared = all_seeds(
        options.store,
        "geared",
        options.mode_seeds,
        lambda seed: scheme_run(truth, literal, LITERAL, plan, seed, physics="geared"),
    )
    guided = all_seeds(
        options.store,
        "guided",
        options.mode_seeds,
        lambda seed: guided_run(truth, literal(truth.group), LITERAL, plan, seed),
    )
    for name, found in (("geared (friction holds the arm)", geared), ("guided", guided)):
        cell = "; ".join(f"{s}: {spread(last_errors(found, s), ' Nm', 4)}" for s in SETS)
        cell += f"; {len(found)} seeds"
        yield Row(f"2R, literal LLM at 54,000 samples, {name}", "-", "-", "", cell)


def _rows(runs: list[Run], when: str, paper: str, limit: float) -> Iterator[Row]:
    seeds = f", {len(runs)} seeds" if len(runs) > 1 else ", one seed"
    seeds += f", {100 * statistics.median(run.failed for run in runs):.1f} % of torques failed"
    for name in SETS:
        errors = last_errors(runs, name)
        yield Row(
            f"2R, literal LLM {when}, {name}",
            paper,
            f"at most {limit:g} Nm",
            "",
            spread(errors, " Nm", 4) + seeds,
            statistics.median(errors),
            limit,
            WHY,
        )
