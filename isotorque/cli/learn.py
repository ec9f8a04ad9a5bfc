"""``isotorque learn``: explore and learn the inverse statics model."""

from __future__ import annotations

from isotorque.cli.options import (
    AngleNoise,
    EncoderStep,
    Engine,
    Json,
    NoSnap,
    Out,
    Physics,
    Quiet,
    RobotName,
    Seed,
    Settle,
    TorqueNoise,
)
from isotorque.cli.output import emit_json, say
from isotorque.cli.run_options import LearnerName, NMin, Samples, Symmetries


def learn(
    robot: RobotName,
    out: Out,
    samples: Samples = 3000,
    learner: LearnerName = "local-linear-map-it",
    symmetries: Symmetries = "learned",
    n_min: NMin = 2,
    physics: Physics = "open_loop",
    engine: Engine = "compiled",
    settle: Settle = "finished",
    seed: Seed = 0,
    no_snap: NoSnap = False,
    angle_noise: AngleNoise = 0.0,
    torque_noise: TorqueNoise = 0.0,
    encoder_step: EncoderStep = 0.0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Learn by Constrained Direction Sampling; goes on from a discovery in OUT, or makes one."""
    from isotorque.cli.files import output_directory
    from isotorque.cli.progress import progress_bars
    from isotorque.experiment import run_experiment, save_run_model, with_recorded_discovery
    from isotorque.run_options import ArmOptions, RunOptions
    from verify.models import verify_model

    arm = ArmOptions(
        seed, physics, engine, settle, not no_snap, angle_noise, torque_noise, encoder_step
    )
    options = with_recorded_discovery(
        RunOptions(robot, arm, n_min, samples, learner, symmetries), out
    )
    output_directory(out)
    with progress_bars(quiet) as progress:
        outcome = run_experiment(options, out, progress)
    model = save_run_model(outcome, out)
    judged = verify_model(outcome.scheme.learner, outcome.gravity, limits=outcome.robot.limits)
    document = {
        "robot": outcome.robot.name,
        "learner": learner,
        "symmetries": symmetries,
        "discovery_motions": len(outcome.motions),
        "samples": len(outcome.steps),
        "rmse_torque": judged.rmse,
        "rmse_by_joint": judged.rmse_by_joint,
        "curve": [{"samples": p.samples, "rmse": p.rmse} for p in outcome.curve],
        "model": str(model),
    }
    if json:
        emit_json(document)
        return
    print(f"torque RMSE {judged.rmse:.4g} N m on {judged.targets[0].name}")
    say(f"written: {model}", quiet)
