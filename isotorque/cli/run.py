"""``isotorque run``: the whole scheme of Fig. 8, from the robot file to the report."""

from __future__ import annotations

from typing import Annotated

import typer

from isotorque.cli.options import Engine, Json, NoSnap, Out, Physics, Quiet, RobotName, Seed, Settle
from isotorque.cli.output import emit_json, say


def run(
    robot: RobotName,
    out: Out,
    samples: Annotated[
        int, typer.Option("--samples", min=1, help="Torques commanded while learning.")
    ] = 3000,
    learner: Annotated[
        str,
        typer.Option(
            "--learner",
            metavar="NAME",
            help="local-linear-map, local-linear-map-it or recursive-least-squares.",
        ),
    ] = "local-linear-map-it",
    symmetries: Annotated[
        str,
        typer.Option("--symmetries", metavar="WHICH", help="learned, exact or none."),
    ] = "learned",
    n_min: Annotated[
        int, typer.Option("--n-min", min=1, help="Relations needed before learning begins.")
    ] = 2,
    physics: Physics = "open_loop",
    engine: Engine = "compiled",
    settle: Settle = "finished",
    seed: Seed = 0,
    no_snap: NoSnap = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Discover symmetries, explore, learn, and judge it all; ends with OUT/report.html.

    The same command resumes a run that was stopped.
    """
    from isotorque.cli.files import output_directory
    from isotorque.cli.progress import progress_bars
    from isotorque.experiment import RunOptions, run_experiment
    from isotorque.judgement import judge_run
    from verify.report import write_report

    options = RunOptions(
        robot=robot,
        seed=seed,
        samples=samples,
        learner=learner,
        symmetries=symmetries,
        n_min=n_min,
        physics=physics,
        engine=engine,
        settle=settle,
        snap=not no_snap,
    )
    output_directory(out)
    with progress_bars(quiet) as progress:
        outcome = run_experiment(options, out, progress)
        progress("judging", 0, 1, "")
        report = judge_run(outcome)
        progress("judging", 1, 1, "")
    page, document = write_report(report, out)
    if json:
        emit_json(document)
    say(f"report: {page}", quiet)
