"""``isotorque sweep``: robots x learners x seeds from one table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Jobs, Json, Out, Quiet, Scheduler
from isotorque.cli.output import emit_json, say

Table = Annotated[
    Path,
    typer.Argument(
        metavar="TABLE",
        help="A .csv with columns robot, learner, seed, one run per line; or a .toml with lists "
        "robots, learners, seeds, all combined. If wanted also strategy (.toml: strategies), "
        "symmetries, samples, physics and the other options of `isotorque learn`, such as n_min.",
        show_default=False,
    ),
]


def sweep(
    table: Table,
    out: Out,
    jobs: Jobs = 2,
    scheduler: Scheduler = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Learn with every robot, learner and seed of a table; ends with OUT/sweep.csv and a plot.

    The same command goes on with what was stopped; runs added to the table are added.
    """
    from isotorque.cli.progress import progress_bars
    from isotorque.sweeps.sweep import sweep as perform
    from isotorque.sweeps.sweep_table import read_sweep

    runs = read_sweep(table)
    with progress_bars(quiet) as progress:
        result = perform(runs, out, progress, jobs=jobs, scheduler=scheduler)
    if json:
        emit_json({"table": str(result.table), "plot": str(result.plot), "rows": result.rows})
    say(f"table: {result.table}", quiet)
    return 0
