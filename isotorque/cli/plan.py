"""``isotorque plan``: the poses that tell most about the torque of an arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet, Seed
from isotorque.cli.output import emit_json, say
from isotorque.cli.robot_options import load, named, takes_robot
from isotorque.symbolic.common.robot_options import RobotOptions


@takes_robot("what")
def plan(
    what: Annotated[
        RobotOptions,
        typer.Argument(
            parser=named,
            metavar="OUT|ROBOT",
            help="The directory of a learned rigid chain, or a robot whose file serves as a first "
            "guess.",
            show_default=False,
        ),
    ],
    poses: Annotated[int, typer.Option("--poses", min=1, help="Poses at most.")] = 8,
    within: Annotated[
        float,
        typer.Option(
            "--within",
            min=0.0,
            metavar="NM",
            help="Enough: every torque in the region known to so much, three standard errors.",
        ),
    ] = 0.0,
    choice: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="POSES.csv",
            help="Choose from these poses alone: columns <joint>.q or q1,..,qn.",
            show_default=False,
        ),
    ] = None,
    seed: Seed = 0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Choose poses that lower the largest standard error of the torque most; prints a CSV.

    The region is the range of recorded angles, or a robot's joint limits; poses that need more
    than a robot's effort limits are left out.
    """
    from isotorque.learning.files.saved_models import load_model
    from isotorque.runs.from_data.chain_plan import plan_for_model, plan_for_robot, read_poses
    from isotorque.symbolic.common.errors import InputError

    saved = Path(what.spec)
    if saved.is_dir() or saved.suffix == ".json":
        if what.changed:
            found = " ".join(what.arguments())
            accepted = "none of these: a learned model keeps its robot"
            raise InputError("command line", f"options beside {saved}", found, accepted)
        names = load_model(saved).joint_names
        given = None if choice is None else read_poses(choice, names)
        found_plan = plan_for_model(saved, poses, within=within, choice=given, seed=seed)
    else:
        robot = load(what, quiet)
        given = None if choice is None else read_poses(choice, robot.joint_names)
        found_plan = plan_for_robot(robot, poses, within=within, choice=given, seed=seed)
    if json:
        emit_json(found_plan.document())
        return
    print(found_plan.csv(), end="")
    plan_of = found_plan.plan
    after = plan_of.expected[-1] if len(plan_of.expected) else plan_of.before
    say(
        f"largest standard error {plan_of.before:.3g} N m before, {after:.3g} N m after "
        f"{len(plan_of.poses)} poses (region: the ranges of the joints; torque noise "
        f"{float(found_plan.torque_noise.max()):.2g} N m)",
        quiet,
    )
