"""``isotorque verify``: judge relations, runs and models by a robot or by measurements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from isotorque.cli.options import Json, Quiet, measurement_noise
from isotorque.cli.output import emit_json
from isotorque.cli.robot_options import about, load, named, takes_robot
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions

if TYPE_CHECKING:
    from isotorque.runs.verification import Verification


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
        RobotOptions | None,
        typer.Option(
            "--robot",
            parser=named,
            metavar="ROBOT",
            help="Judge by the gravity torque of this robot; options of it that are not given are "
            "as recorded.",
            show_default=False,
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            "--data",
            metavar="FRESH.csv",
            help="Judge by measurements that WHAT was not learned from, columns as of `learn "
            "--data`; instead of --robot or beside it. Rows of one pose count as one.",
            show_default=False,
        ),
    ] = None,
    angle_noise: Annotated[
        float | None,
        typer.Option(
            "--angle-noise",
            metavar="RAD",
            help="With --data: noise of its angles where known.",
            show_default=False,
        ),
    ] = None,
    torque_noise: Annotated[
        float | None,
        typer.Option(
            "--torque-noise",
            metavar="NM",
            help="With --data: noise of its torques where known; otherwise rows of one pose tell, "
            "or a rigid chain that is judged.",
            show_default=False,
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance",
            metavar="NM",
            help="Torque error allowed [N m]: of each relation (1e-9); of a model, RMSE "
            "and largest at each joint (1 % of its largest torque, at least 1e-3 of the arm's; of "
            "a relation by --data the same, beside the bound that the file gives).",
            show_default=False,
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option("--report", metavar="FILE.html", help="Write a report.", show_default=False),
    ] = None,
    junit: Annotated[
        Path | None,
        typer.Option(
            "--junit",
            metavar="FILE.xml",
            help="Write the verdicts for test runners.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Judge what was learned or claimed: proof, bound, test, or a counterexample.

    By a robot, by measurements, or both: each claim says what it is about then. Exit status 1 where
    a claim is refuted, or measurements cannot tell.
    """
    from isotorque.runs.options.recorded_robot import as_recorded
    from isotorque.runs.verification import FreshData, verify_path
    from isotorque.symbolic.common.files import write_whole
    from isotorque.symbolic.gravity.gravity_model import GravityModel

    noise = measurement_noise(angle_noise, torque_noise)
    if noise is not None and data is None:
        raise InputError("command line", "noise", "given", "--data FRESH.csv beside it")
    fresh = None if data is None else FreshData(data, noise)
    loaded = None if robot is None else load(as_recorded(robot, what), quiet)
    gravity = None if loaded is None else GravityModel(loaded)
    judged = verify_path(what, loaded, gravity, tolerance, data=fresh)
    by = [name for name in (data and data.name, gravity and gravity.name) if name]
    title = f"{what.name} against {' and '.join(by)}"
    if report is not None:
        from isotorque.verify.report.write_report import verdicts_page

        write_whole(report, verdicts_page(title, judged.verdicts, remarks=judged.remarks))
    if junit is not None:
        from isotorque.verify.report.junit import junit_document

        write_whole(junit, junit_document(title, judged.verdicts))
    if json:
        emit_json(
            {
                **({} if loaded is None else about(loaded)),
                "passed": judged.passed,
                "verdicts": [verdict.to_json() for verdict in judged.verdicts],
                **({} if data is None else _measured(judged)),
            }
        )
    else:
        for verdict in judged.verdicts:
            print(verdict)
        for remark in judged.remarks:
            print(remark)
        print(judged.outcome)
    return 0 if judged.passed else 1


def _measured(judged: Verification) -> dict[str, Any]:
    return {"measured": judged.measured, "remarks": list(judged.remarks)}
