"""Options and arguments that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise

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
    from isotorque.symbolic.common.errors import InputError

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


def measurement_noise(angle: float | None, torque: float | None) -> MeasurementNoise | None:
    """Noise of measurements from ``--angle-noise`` and ``--torque-noise``; None without either.

    Raises
    ------
    InputError
        For a level that is no finite number >= 0, and where both are 0.
    """
    from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
    from isotorque.symbolic.common.errors import InputError

    if angle is None and torque is None:
        return None
    for option, value in (("--angle-noise", angle), ("--torque-noise", torque)):
        if value is not None and not 0.0 <= value <= LARGEST:
            raise InputError("command line", option, value, f"0 to {LARGEST:g}")
    if not (angle or torque):
        found = "0 everywhere"
        raise InputError("command line", "noise", found, "one level > 0, or neither option")
    return MeasurementNoise(angle or 0.0, torque or 0.0)


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
Chosen = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="A setting of discovery, exploration, scheme or learner: epsilon=0.2,"
        " exploration.noise=0.05, learner.replay=20; a wrong name lists all. May be given several"
        " times.",
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
        " network, gaussian-process, trigonometric, parametric, rigid-chain; by default"
        " local-linear-map-it, for a lattice network, for data and for more than 3 joints"
        " gaussian-process. run, without it, ends with a rigid-chain where one is accepted.",
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
