"""Options of the commands that move an arm."""

from __future__ import annotations

from typing import Annotated

import typer

Samples = Annotated[int, typer.Option("--samples", min=1, help="Torques commanded while learning.")]
LearnerName = Annotated[
    str,
    typer.Option(
        "--learner",
        metavar="NAME",
        help="local-linear-map, local-linear-map-it or recursive-least-squares.",
    ),
]
Symmetries = Annotated[
    str, typer.Option("--symmetries", metavar="WHICH", help="learned, exact or none.")
]
NMin = Annotated[
    int, typer.Option("--n-min", min=1, help="Relations needed before learning begins.")
]
