"""``isotorque verify``: judge relations, runs and models against the analytic truth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json
from isotorque.cli.robot_options import about, load, named, takes_robot
from isotorque.symbolic.common.robot_options import RobotOptions


@takes_robot()
def verify(
    what: Annotated[
        Path,
        typer.Argument(
            metavar="WHAT",
            help="A relations file, a model.json, or the directory of a run.",
            show_default=False,
        ),
    ],
    robot: Annotated[
        RobotOptions,
        typer.Option(
            "--robot",
            parser=named,
            metavar="ROBOT",
            help="Robot it is about; options of it that are not given are as recorded.",
            show_default=False,
        ),
    ],
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance",
            metavar="NM",
            help="Torque error allowed [N m]: of each relation (1e-9); of a model, RMSE "
            "and largest at each joint (1 % of its largest torque, at least 1e-3 of the arm's).",
            show_default=False,
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option("--report", metavar="FILE.html", help="Write a report.", show_default=False),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Judge what was learned or claimed: proof, bound, or a counterexample."""
    from isotorque.runs.options.recorded_robot import as_recorded
    from isotorque.runs.verification import verify_path
    from isotorque.symbolic.gravity.gravity_model import GravityModel

    loaded = load(as_recorded(robot, what), quiet)
    gravity = GravityModel(loaded)
    verdicts = verify_path(what, loaded, gravity, tolerance)
    passed = all(verdict.passed for verdict in verdicts)
    if report is not None:
        from isotorque.symbolic.common.files import write_whole
        from isotorque.verify.report.write_report import verdicts_page

        write_whole(report, verdicts_page(f"{what.name} against {gravity.name}", verdicts))
    if json:
        emit_json(
            {
                **about(loaded),
                "passed": passed,
                "verdicts": [verdict.to_json() for verdict in verdicts],
            }
        )
    else:
        for verdict in verdicts:
            print(verdict)
        print("passed" if passed else "failed")
    return 0 if passed else 1
