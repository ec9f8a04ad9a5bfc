"""Options and arguments that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON document and nothing else on stdout.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress bars and messages.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of all random choices.")]
Physics = Annotated[
    str,
    typer.Option("--physics", metavar="MODE", help="open_loop, geared or guided."),
]
Engine = Annotated[
    str, typer.Option("--engine", metavar="ENGINE", help="compiled or pinocchio: same physics.")
]
Settle = Annotated[
    str,
    typer.Option(
        "--settle", metavar="MODE", help="finished: at the equilibrium; raw: at the criterion."
    ),
]
AngleNoise = Annotated[
    float, typer.Option("--angle-noise", metavar="RAD", help="Noise of measured angles.")
]
TorqueNoise = Annotated[
    float, typer.Option("--torque-noise", metavar="NM", help="Noise of measured torques.")
]
EncoderStep = Annotated[
    float, typer.Option("--encoder-step", metavar="RAD", help="Measured angles are rounded to it.")
]
Out = Annotated[Path, typer.Option("--out", help="Directory for all results.", show_default=False)]


LARGEST = 1e9
"""Largest angle [rad] or torque [N m] taken: larger angles do not say where a joint is."""


def numbers(text: str, option: str, count: int) -> list[float]:
    """Read ``count`` comma-separated numbers given to an option.

    Raises
    ------
    InputError
        Naming the option and the value.

    Examples
    --------
    >>> numbers("1,-2.5", "--torque", 2)
    [1.0, -2.5]
    """
    from symbolic.errors import InputError

    try:
        values = [float(x) for x in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(abs(x) <= LARGEST for x in values):
        raise InputError(
            "command line",
            option,
            text,
            f"{count} finite numbers, each at most {LARGEST:g}, with commas",
        )
    return values
