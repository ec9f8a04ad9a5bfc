"""Samples until an error stays below a threshold, for the learners that need few."""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator

from benchmarks.online.learners import (
    GUIDED,
    QUICK,
    WIDE,
    joint,
    replayed,
    replayed_3r,
)
from benchmarks.online.runs import Plan, Run, all_seeds, guided_run, scheme_run
from benchmarks.online.table import Row, spread
from benchmarks.online.truth import Truth

FINE = 0.0053
COARSE_3R, FINE_3R = 0.26, 0.01
FRINGE_2R = "The strip along the border of what the arm can hold is learned last."
FRINGE_3R = (
    "Open loop the fringe of the stable part is visited last: near it the arm falls, and every "
    "fall ends a direction; guided samples reach it (next rows)."
)


def two_joint_rows(options: argparse.Namespace) -> Iterator[Row]:
    """2R arm, open loop, everything learned in the same run."""
    truth = Truth.of("2r")
    plan = Plan(3000, 100, ("90", "dense"))
    runs = all_seeds(
        options.store,
        "2r-replay",
        options.seeds,
        lambda seed: scheme_run(truth, replayed, QUICK, plan, seed, bold=True),
    )
    for name in plan.sets:
        yield _row(
            f"2R, LLM with kappa and replay: samples to {FINE} Nm, {name}",
            "3,000",
            2000,
            "1,000",
            runs,
            name,
            FINE,
            why=FRINGE_2R,
            note=f", {100 * statistics.median(run.failed for run in runs):.1f} % of torques failed",
        )
    plan = Plan(300, 5, ("dense",))
    runs = all_seeds(
        options.store,
        "2r-joint",
        options.seeds,
        lambda seed: scheme_run(truth, joint, QUICK, plan, seed),
    )
    found = statistics.median(run.discovery for run in runs)
    yield _row(
        f"2R, joint least squares: samples to {FINE} Nm, dense, learned symmetries",
        "-",
        120,
        "50",
        runs,
        "dense",
        FINE,
        note=f", after {found:.0f} of discovery",
    )


def three_joint_rows(options: argparse.Namespace) -> Iterator[Row]:
    """3R arm: open loop on the part of the torus it can learn by itself, guided on all of it."""
    truth = Truth.of("3r")
    plan = Plan(3000, 100, ("stable",))
    runs = all_seeds(
        options.store,
        "3r-replay",
        options.wide_seeds,
        lambda seed: scheme_run(truth, replayed_3r, WIDE, plan, seed),
    )
    yield _row(
        f"3R, LLM with kappa and replay: samples to {COARSE_3R} Nm, stable part",
        "14,000",
        1500,
        "300",
        runs,
        "stable",
        COARSE_3R,
    )
    plan = Plan(1000, 20, ("stable",))
    runs = all_seeds(
        options.store,
        "3r-joint",
        options.wide_seeds,
        lambda seed: scheme_run(truth, joint, WIDE, plan, seed),
    )
    for threshold, demanded, stretch in ((COARSE_3R, 200, "60"), (FINE_3R, 400, "150")):
        yield _row(
            f"3R, joint least squares, open loop: samples to {threshold} Nm, stable part",
            "-",
            demanded,
            stretch,
            runs,
            "stable",
            threshold,
            why=FRINGE_3R,
        )
    plan = Plan(400, 10, ("dense",))
    guided = all_seeds(
        options.store,
        "3r-guided",
        options.seeds,
        lambda seed: guided_run(truth, joint(truth.group), GUIDED, plan, seed),
    )
    for threshold, demanded, stretch in ((COARSE_3R, 200, "60"), (FINE_3R, 400, "150")):
        yield _row(
            f"3R, joint least squares, guided: samples to {threshold} Nm, dense",
            "-",
            demanded,
            stretch,
            guided,
            "dense",
            threshold,
        )


def _row(
    what: str,
    paper: str,
    demanded: float,
    stretch: str,
    runs: list[Run],
    name: str,
    threshold: float,
    *,
    note: str = "",
    why: str = "",
) -> Row:
    counts = [run.reached(name, threshold) for run in runs]
    here = spread(counts, "", 0) + f", {len(runs)} seeds" + note
    last = statistics.median(run.last(name) for run in runs)
    if statistics.median(counts) > demanded:
        here += f"; {last:.3g} Nm at the end of {runs[0].curve[name][-1][0]}"
    return Row(
        what, paper, f"{demanded:.0f}", stretch, here, statistics.median(counts), demanded, why
    )
