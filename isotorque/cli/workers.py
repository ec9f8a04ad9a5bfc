"""Options of the commands that work on many processors."""

from __future__ import annotations

from typing import Annotated

import typer

Seeds = Annotated[int, typer.Option("--seeds", min=1, help="Number of seeds, from --seed on.")]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Local processes, one thread each.")]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Work on an existing Dask cluster, e.g. tcp://host:8786, instead.",
    ),
]
