"""``isotorque run``: the whole scheme of Fig. 8, from the robot file to the report."""

from __future__ import annotations

from isotorque.cli.options import (
    AngleNoise,
    Chosen,
    ChosenPhysics,
    Confirm,
    EncoderStep,
    Engine,
    Json,
    LearnAnyway,
    LearnerName,
    ModelTolerance,
    NMin,
    Out,
    Quiet,
    Samples,
    Seed,
    Settle,
    Strategy,
    Symmetries,
    TorqueNoise,
)
from isotorque.cli.output import emit_json, say, say_if_first
from isotorque.cli.robot_options import RobotName, load, takes_robot
from isotorque.plain import plain


@takes_robot()
def run(
    robot: RobotName,
    out: Out,
    strategy: Strategy = "direction-sampling",
    samples: Samples = None,
    learner: LearnerName = None,
    symmetries: Symmetries = "learned",
    n_min: NMin = 2,
    confirm: Confirm = 0,
    learn_anyway: LearnAnyway = False,
    tolerance: ModelTolerance = None,
    settings: Chosen = None,
    physics: ChosenPhysics = None,
    engine: Engine = "compiled",
    settle: Settle = "finished",
    seed: Seed = 0,
    angle_noise: AngleNoise = 0.0,
    torque_noise: TorqueNoise = 0.0,
    encoder_step: EncoderStep = 0.0,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Discover symmetries, explore, learn, and judge it all; ends with OUT/report.html.

    Passed is a run whose relations are none of them false, whose gate before learning is passed,
    and whose model is right within --tolerance on the whole space; where orbits without a stable
    member exist, those with one are judged too, on their own. An arm that cannot hold itself is
    guided. Without --learner the model is a rigid chain, if one is found that all later samples
    agree with; up to three joints the paper's learner explores beside it. The same command resumes
    a run that was stopped.
    """
    from isotorque.cli.progress import progress_bars
    from isotorque.runs.experiment import save_run_model
    from isotorque.runs.judgement import judge_run
    from isotorque.runs.options.learn_options import run_options
    from isotorque.runs.options.run_options import ArmOptions
    from isotorque.runs.options.settings import Settings
    from isotorque.runs.perform_run import perform
    from isotorque.runs.recorded_relations import save_relations
    from isotorque.symbolic.common.files import output_directory
    from isotorque.verify.report.write_report import write_report

    load(robot, quiet)
    say_if_first(quiet)
    arm = ArmOptions(seed, "open_loop", engine, settle, angle_noise, torque_noise, encoder_step)
    options = run_options(
        robot,
        arm,
        physics,
        n_min=n_min,
        samples=samples,
        learner=learner,
        symmetries=symmetries,
        strategy=strategy,
        confirm=confirm,
        learn_anyway=learn_anyway,
        tolerance=tolerance,
        settings=Settings.of(settings or ()),
    )
    if options.guided_by_need:
        words = "cannot hold itself within its limits: it is guided (placed and held)"
        say(f"{robot.spec} {words}", quiet)
    output_directory(out)
    with progress_bars(quiet) as progress:
        outcome = perform(options, out, progress)
        progress("judging", 0, 1, "")
        report = judge_run(outcome)
        progress("judging", 1, 1, "")
    if outcome.model is not None:
        save_run_model(outcome, out)
    save_relations(outcome, out, plain)
    page, document = write_report(report, out)
    if json:
        emit_json(document)
    else:
        print(f"{'passed' if report.passed else 'failed'}: {'; '.join(report.summary)}")
    say(f"report: {page}", quiet)
    return 0 if report.passed else 1
