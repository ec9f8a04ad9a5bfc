"""The options of every command that takes a robot: declared here and nowhere else."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from isotorque.cli.output import say
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions

if TYPE_CHECKING:
    from isotorque.symbolic.robots.load_robot import Robot


def named(spec: str) -> RobotOptions:
    """Return a robot by its name, as the parser of an argument."""
    return RobotOptions(spec)


named.__name__ = "str"  # shown in help texts

RobotName = Annotated[
    RobotOptions,
    typer.Argument(
        parser=named,
        metavar="ROBOT",
        help="A built-in robot (see `isotorque robots`), a URDF file, or - for standard input.",
        show_default=False,
    ),
]


def _option(name: str, kind: Any, metavar: str | None, words: str) -> inspect.Parameter:
    option = typer.Option(name, metavar=metavar, help=words, show_default=False)
    return inspect.Parameter(
        name.removeprefix("--").replace("-", "_"),
        inspect.Parameter.KEYWORD_ONLY,
        default=False if kind is bool else None,
        annotation=Annotated[kind, option],
    )


_OPTIONS = (
    _option(
        "--lock",
        list[str] | None,
        "JOINT[=VALUE]",
        "A joint, or joints by a glob, that stand still: at VALUE [rad or m], else at 0 or at the "
        "nearest place within the limits. May be given several times.",
    ),
    _option("--joints", str | None, "A,B,..", "The joints that move; all others stand still."),
    _option("--tip", str | None, "LINK", "Joints not between the root and LINK stand still."),
    _option("--gravity", str | None, "X,Y,Z", "Gravity in the frame of the root link [m/s^2]."),
    _option(
        "--payload",
        list[str] | None,
        "MASS[,X,Y,Z][@LINK]",
        "A mass [kg] that is carried, its centre in the frame of LINK [m]; by default on the last "
        "link that moves. May be given several times.",
    ),
    _option("--no-snap", bool, None, "Keep angles that are within 1e-5 rad of multiples of pi/2."),
    _option(
        "--allow-massless", bool, None, "Go on though no joint feels gravity for want of masses."
    ),
)
ROBOT_OPTIONS = tuple(parameter.name for parameter in _OPTIONS)
"""Names of the options, as Python arguments."""


def takes_robot(argument: str = "robot") -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Give a command the options of a robot.

    Parameters
    ----------
    argument
        The parameter of the command that names the robot, `RobotOptions` of that name alone. It
        is called with the options given beside it.

    Returns
    -------
    decorator
        The options stand behind the other parameters of the command, before ``--json``.
    """

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(command, eval_str=True)

        @functools.wraps(command)
        def run(**arguments: Any) -> Any:
            given = {name: arguments.pop(name) for name in ROBOT_OPTIONS}
            given["snap"] = not given.pop("no_snap")
            given = {name: x for name, x in given.items() if x is not None}
            robot = arguments[argument]
            if robot is None:  # then there is no robot that the options could be of
                _refuse(RobotOptions("", **given), argument)
            else:
                arguments[argument] = replace(robot, **given)
            return command(**arguments)

        parameters = [
            p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in signature.parameters.values()
        ]
        at = next(i for i, p in enumerate(parameters) if p.name == "json")
        parameters[at:at] = _OPTIONS
        run.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        run.__annotations__ = {p.name: p.annotation for p in parameters}
        return run

    return decorate


def _refuse(options: RobotOptions, argument: str) -> None:
    if options.changed:
        found = " ".join(options.arguments())
        raise InputError(
            "command line", "options", found, f"these beside --{argument} with a robot"
        )


def load(options: RobotOptions, quiet: bool) -> Robot:
    """Load a robot; say on standard error what is doubtful about it."""
    from isotorque.symbolic.robots.load_robot import load_robot

    robot = load_robot(options)
    for warning in robot.warnings:
        say(f"warning: {warning}", quiet)
    return robot


def about(robot: Robot) -> dict[str, Any]:
    """Return what every JSON document says of its robot."""
    options, warnings = robot.options.as_json(), list(robot.warnings)
    return {"robot": robot.name, "robot_options": options, "warnings": warnings}
