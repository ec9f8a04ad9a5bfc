"""``isotorque paper``: every number and figure of the paper beside ours."""

from __future__ import annotations

from typing import Annotated

import typer

from isotorque.cli.options import Jobs, Json, Out, Quiet, Scheduler, Seed, Seeds
from isotorque.cli.output import emit_json, say

Part = Annotated[
    str,
    typer.Argument(metavar="[2r|3r|batch|figures|all]", help="What to compare.", show_default=True),
]
Quick = Annotated[
    bool,
    typer.Option(
        "--quick", help="A hundredth of the samples: for a first look, few rows hold then."
    ),
]


def paper(
    out: Out,
    part: Part = "all",
    seeds: Seeds = 1,
    seed: Seed = 0,
    jobs: Jobs = 2,
    scheduler: Scheduler = None,
    quick: Quick = False,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Repeat the paper's experiments; ends with OUT/paper.html, OUT/paper.json and OUT/figures.

    Each row holds or not by the rule that stands in it, and says why where it does not. The same
    command goes on with what was stopped.
    """
    from isotorque.cli.progress import progress_bars
    from isotorque.paper.page import write_pages
    from isotorque.paper.run import QUICK, PaperOptions, compare

    options = PaperOptions(part, seed, seeds, QUICK if quick else 1.0, jobs, scheduler)
    with progress_bars(quiet) as progress:
        comparison = compare(options, out, progress)
        page = write_pages(comparison, out, progress)
    document = comparison.document()
    if json:
        emit_json(document)
    say(f"{document['held']} of {len(document['rows'])} rows hold: {page}", quiet)
    return 0
