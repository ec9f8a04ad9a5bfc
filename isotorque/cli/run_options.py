"""Options of the commands that move an arm."""

from __future__ import annotations

from typing import Annotated

import typer

Samples = Annotated[
    int | None,
    typer.Option(
        "--samples",
        min=1,
        help="Torques commanded, or configurations of the lattice; by default 3000 for an online"
        " learner, 500 for a batch learner, 255 for a lattice.",
        show_default=False,
    ),
]
Strategy = Annotated[
    str,
    typer.Option(
        "--strategy",
        metavar="NAME",
        help="direction-sampling, goal-babbling, motor-babbling or lattice.",
    ),
]
ChosenPhysics = Annotated[
    str | None,
    typer.Option(
        "--physics",
        metavar="MODE",
        help="open_loop, geared or guided; by default open_loop, for a lattice and for an arm that"
        " cannot hold itself guided.",
        show_default=False,
    ),
]
LearnerName = Annotated[
    str | None,
    typer.Option(
        "--learner",
        metavar="NAME",
        help="Online: local-linear-map, local-linear-map-it, recursive-least-squares; batch:"
        " network, gaussian-process, trigonometric, parametric; by default local-linear-map-it,"
        " for a lattice network, for data and for more than 3 joints gaussian-process.",
        show_default=False,
    ),
]
Symmetries = Annotated[
    str, typer.Option("--symmetries", metavar="WHICH", help="learned, exact or none.")
]
NMin = Annotated[
    int, typer.Option("--n-min", min=1, help="Relations needed before learning begins.")
]
Confirm = Annotated[
    int,
    typer.Option(
        "--confirm",
        min=0,
        help="Torques at the end of the discovery, chosen to say most about the relations.",
    ),
]
LearnAnyway = Annotated[
    bool,
    typer.Option("--learn-anyway", help="Learn although fewer relations than --n-min are known."),
]
ModelTolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        metavar="NM",
        help="Torque error allowed at each joint, RMSE and largest [N m]; by default 1 % of the"
        " joint's largest torque, at least 1e-3 of the arm's.",
        show_default=False,
    ),
]
