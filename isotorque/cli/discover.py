"""``isotorque discover``: Algorithm 1, everything recorded."""

from __future__ import annotations

from isotorque.cli.options import (
    AngleNoise,
    Chosen,
    Confirm,
    EncoderStep,
    Engine,
    Json,
    NMin,
    Out,
    Physics,
    Quiet,
    Seed,
    Settle,
    TorqueNoise,
)
from isotorque.cli.output import emit_json, row, say_if_first
from isotorque.cli.robot_options import RobotName, about, load, takes_robot


@takes_robot()
def discover(
    robot: RobotName,
    out: Out,
    n_min: NMin = 2,
    confirm: Confirm = 0,
    settings: Chosen = None,
    physics: Physics = "open_loop",
    engine: Engine = "compiled",
    settle: Settle = "finished",
    seed: Seed = 0,
    angle_noise: AngleNoise = 0.0,
    torque_noise: TorqueNoise = 0.0,
    encoder_step: EncoderStep = 0.0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Play torque profiles until the symmetries are known; every motion is kept in OUT.

    The same command resumes what was stopped; `relations` and `learn` go on from OUT.
    """
    from isotorque.cli.progress import progress_bars
    from isotorque.learning.arm import OutcomeKind
    from isotorque.runs.experiment import discover_symmetries
    from isotorque.runs.options.run_options import ArmOptions, RunOptions
    from isotorque.runs.options.settings import Settings
    from isotorque.symbolic.common.files import output_directory

    arm = ArmOptions(seed, physics, engine, settle, angle_noise, torque_noise, encoder_step)
    chosen = Settings.of(settings or ())
    chosen.require_only("discovery", "scheme")
    options = RunOptions(robot, arm, n_min, confirm=confirm, settings=chosen)
    load(robot, quiet)
    say_if_first(quiet)
    output_directory(out)
    with progress_bars(quiet) as progress:
        found = discover_symmetries(options, out, progress)
    ends = found.ends()
    scheme = found.scheme
    learned = scheme.learned
    document = {
        **about(found.robot),
        "torques": scheme.targets,
        "settled": ends[OutcomeKind.SETTLED],
        "limit_hits": ends[OutcomeKind.LIMIT],
        "timeouts": ends[OutcomeKind.TIMEOUT],
        "relations": 1 if learned is None else learned.order,
        "missing": None if learned is None else learned.missing,
        "remarks": found.remarks,
    }
    if json:
        emit_json(document)
        return
    print(f"{document['settled']} settled, {document['limit_hits']} met a limit,", end=" ")
    print(f"{document['timeouts']} did not settle in time")
    for target in scheme.targets:
        print(f"  target torque {row(target)} N m")
    print(f"{document['relations']} relations known; see them with: isotorque relations {out}")
    if document["missing"]:
        print(f"missing: {document['missing']}")
    for remark in document["remarks"]:
        print(remark)
