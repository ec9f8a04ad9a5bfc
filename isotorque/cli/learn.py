"""``isotorque learn``: explore, sample a lattice or read a recording, and learn from it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from isotorque.cli.options import (
    AngleNoise,
    Chosen,
    EncoderStep,
    Engine,
    Json,
    LearnAnyway,
    LearnerName,
    NMin,
    Out,
    Physics,
    Quiet,
    Samples,
    Seed,
    Settle,
    Strategy,
    Symmetries,
    TorqueNoise,
)
from isotorque.cli.output import emit_json, row, say, say_if_first
from isotorque.cli.robot_options import load, named, takes_robot
from isotorque.symbolic.common.robot_options import RobotOptions

SIMULATED = (
    "n_min",
    "learn_anyway",
    "physics",
    "engine",
    "settle",
    "angle_noise",
    "torque_noise",
    "encoder_step",
)

NEED_ROBOT = ("strategy", "samples", "symmetries", "drop_outliers", "settings")
WORDS = {"settings": "set"}
"""Options that have another name on the command line."""


@takes_robot()
def learn(
    context: typer.Context,
    out: Out,
    robot: Annotated[
        RobotOptions | None,
        typer.Argument(
            parser=named,
            metavar="[ROBOT]",
            help="A built-in robot (see `isotorque robots`), a URDF file, or - for standard input."
            " Left out, with --data: nothing is known of the arm but the recording.",
            show_default=False,
        ),
    ] = None,
    strategy: Strategy = "direction-sampling",
    samples: Samples = None,
    learner: LearnerName = None,
    symmetries: Symmetries = "learned",
    data: Annotated[
        Path | None,
        typer.Option(
            "--data",
            metavar="FILE.csv",
            help="Learn from a recording: columns q1,..,qn,tau1,..,taun or <joint>.q and"
            " <joint>.tau, in rad and N m; nothing moves.",
            show_default=False,
        ),
    ] = None,
    drop_outliers: Annotated[
        bool,
        typer.Option(
            "--drop-outliers", help="With --data: leave out rows that do not fit the others."
        ),
    ] = False,
    unknown_gains: Annotated[
        bool,
        typer.Option(
            "--unknown-gains",
            help="Without ROBOT: torques are in units of their own at every joint, motor currents"
            " say; ratios of coupled joints are found.",
        ),
    ] = False,
    known_gain: Annotated[
        list[str] | None,
        typer.Option(
            "--known-gain",
            metavar="JOINT=GAIN",
            help="With --unknown-gains: recorded value over torque [1/(N m)] of one joint; fixes"
            " the factor common to all that are coupled with it. May be given several times.",
            show_default=False,
        ),
    ] = None,
    loaded: Annotated[
        Path | None,
        typer.Option(
            "--loaded",
            metavar="FILE.csv",
            help="With --unknown-gains and --known-load: a second recording, in any poses, with a"
            " known load on a link.",
            show_default=False,
        ),
    ] = None,
    known_load: Annotated[
        str | None,
        typer.Option(
            "--known-load",
            metavar="JOINT=NM",
            help="With --loaded: the joint whose link carries the load, and the load's weight times"
            " the distance of its centre from that joint's axis [N m]; fixes the common factor.",
            show_default=False,
        ),
    ] = None,
    n_min: NMin = 2,
    learn_anyway: LearnAnyway = False,
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
) -> int:
    """Learn the inverse statics model of ROBOT; goes on from a discovery in OUT, or makes one.

    A lattice is visited with guided physics; what is not given is as in the discovery. Exit
    status 1, with nothing learned, where fewer relations than --n-min are known. Without ROBOT,
    a rigid chain is learned from --data, with its relations; exit status 1, and what is missing,
    where none is accepted.
    """
    from isotorque.cli.progress import progress_bars
    from isotorque.runs.experiment import run_experiment
    from isotorque.runs.from_data.data_learning import DataOptions, learn_from_data
    from isotorque.runs.lattice_learning import learn_from_lattice
    from isotorque.runs.learned_model import model_of_run
    from isotorque.runs.options.learn_options import learn_options
    from isotorque.runs.options.recorded_robot import as_recorded
    from isotorque.runs.options.run_options import LATTICE
    from isotorque.runs.options.settings import Settings
    from isotorque.symbolic.common.files import output_directory

    given = _given(context)
    if robot is not None:
        alone = ("unknown_gains", "known_gain", "loaded", "known_load")
        _refuse(given, alone, "a ROBOT")
    else:
        return _learn_from_data_alone(given, out, json=json, quiet=quiet)
    load(as_recorded(robot, out), quiet)
    if data is not None:
        _refuse(given, ("strategy", "samples", *SIMULATED), "--data")
        chosen = Settings.of(settings or ())
        recording = DataOptions(robot, data, learner, symmetries, drop_outliers, seed, chosen)
        with progress_bars(quiet) as progress:
            learned = learn_from_data(recording, out, progress)
    else:
        _refuse(given, ("drop_outliers",), "a simulated arm")
        options = learn_options(robot, out, strategy, symmetries, learner, samples, given)
        say_if_first(quiet)
        output_directory(out)
        with progress_bars(quiet) as progress:
            if strategy == LATTICE:
                learned = learn_from_lattice(options, out, progress)
            else:
                learned = model_of_run(run_experiment(options, out, progress))
    document = learned.document(learned.save(out))
    if json:
        emit_json(document)
    else:
        _print(document)
        if document["model"] is not None:
            say(f"written: {document['model']}", quiet)
    return 0 if document["model"] is not None else 1


def _learn_from_data_alone(given: dict[str, Any], out: Path, *, json: bool, quiet: bool) -> int:
    from isotorque.runs.from_data.chain_from_data import ChainDataOptions, chain_from_data
    from isotorque.symbolic.common.errors import InputError

    if given.get("data") is None:
        accepted = "the name or file of a robot, or --data FILE.csv"
        raise InputError("command line", "ROBOT", "missing", accepted)
    other = tuple(x for x in SIMULATED if x not in ("torque_noise", "angle_noise"))
    _refuse(given, (*NEED_ROBOT, *other), "no ROBOT")
    options = ChainDataOptions(
        given["data"],
        given.get("torque_noise"),
        given.get("angle_noise"),
        given.get("seed", 0),
        given.get("learner"),
        given.get("unknown_gains", False),
        tuple(given.get("known_gain") or ()),
        given.get("loaded"),
        given.get("known_load"),
    )
    found = chain_from_data(options)
    document = found.document(found.save(out))
    if json:
        emit_json(document)
    else:
        _print_chain(document)
        if document["model"] is not None:
            also = f" and {out / 'relations.json'}" if "relations" in document else ""
            say(f"written: {document['model']}{also}", quiet)
    return 0 if document["accepted"] else 1


def _print_chain(document: dict[str, Any]) -> None:
    rows, poses = document["samples"], document["poses"]
    count = f"{rows} samples" if poses == rows else f"{rows} samples in {poses} poses"
    print(f"{count} of {len(document['joints'])} joints:", end=" ")
    if not document["accepted"]:
        print(f"no {_chain(document)} is accepted, {document['verdict']}")
        print(f"missing: {document['missing']}")
        if document["explained_if"]:
            print(f"a rigid chain explains all of them if {document['explained_if']}")
        _print_constant_torques(document)
        _print_next_poses(document)
        return
    print(f"a {_chain(document)} {document['verdict']}")
    error = document["standard_error"]
    print(f"torque known to {error['rms']:.2g} N m within the ranges of the recording", end=" ")
    print(f"(standard error, RMS; at most {error['largest']:.2g})")
    _print_held_out(document)
    _print_constant_torques(document)
    if document.get("beside_gravity"):
        part = ", part of the model" if "relations" in document else ""
        print(f"beside gravity{part}: {document['beside_gravity']}")
    if "poses_after_another_payload" in document:
        after = document["poses_after_another_payload"]
        print(f"the model is of the arm before its payload changed: {after} poses are left out")
    if "relations" in document:
        print(f"{document['relations']} symmetry relations, {document['statement']}")
    for group in document.get("gains", []):
        _print_gains(group)
    for name, share in zip(document["joints"], document.get("process_share", []), strict=False):
        print(f"{name}: {100 * share:.1f} % of the torque (RMS) is beside the rigid chain")


def _print_held_out(document: dict[str, Any]) -> None:
    """How models erred at poses left out, joint by joint the one that was chosen."""
    found = document.get("held_out")
    if found is None:
        return
    print(f"at poses left out (measured torque): {found['rmse']:.3g} N m RMS", end="; ")
    by_joint = zip(document["joints"], found["rmse_by_joint"], strict=True)
    print(", ".join(f"{name} {rmse:.2g}" for name, rmse in by_joint), end="")
    for name, other in document["contenders"].items():
        if name != document["learner"]:
            said = (
                f"{other['rmse']:.3g} N m" if "rmse" in other else f"not used: {other['missing']}"
            )
            print(f"; {name} {said}", end="")
    print()


def _print_constant_torques(document: dict[str, Any]) -> None:
    for name, torque in document.get("constant_torques", {}).items():
        why = "gravity does not reach it, or it is not measured"
        if torque:
            why = "a sensor that does not read, or a constant offset where gravity does not reach"
        print(f"{name}: torque {torque:g} N m in every pose ({why})")


def _print_next_poses(document: dict[str, Any]) -> None:
    if "next_poses" not in document:
        return
    known, of = document["numbers_known"], document["numbers_of_a_chain"]
    print(f"known already: {min(known, of)} of the {of} numbers of a chain", end="; ")
    print("poses to take next, if the arm can:")
    print(",".join(f"{name}.q" for name in document["joints"]))
    for pose in document["next_poses"]:
        print(",".join(f"{x:.4f}" for x in pose))


def _print_gains(group: dict[str, Any]) -> None:
    listed = ", ".join(f"{name} {gain:.6g}" for name, gain in group["gains"].items())
    if group["common_factor_known"]:
        print(f"gains: {listed}")
    elif len(group["gains"]) == 1:
        print(f"gain of {next(iter(group['gains']))}: not determined by any other joint")
    else:
        print(f"gains: {listed}; their common factor is not known (--known-gain, --known-load)")


def _chain(document: dict[str, Any]) -> str:
    beside = " with Gaussian processes" if "+" in document["learner"] else ""
    return f"rigid chain{beside}"


def _given(context: typer.Context) -> dict[str, Any]:
    """Options that stand on the command line, with their values."""
    sources = {name: context.get_parameter_source(name) for name in context.params}
    return {
        name: context.params[name]
        for name, source in sources.items()
        if source is not None and "DEFAULT" not in source.name
    }


def _refuse(given: dict[str, Any], names: tuple[str, ...], beside: str) -> None:
    from isotorque.symbolic.common.errors import InputError

    for name in names:
        if name in given:
            option = f"--{WORDS.get(name, name).replace('_', '-')} with {beside}"
            raise InputError(
                "command line", option, given[name], "nothing: it has no meaning there"
            )


def _print(document: dict[str, Any]) -> None:
    if document["model"] is None:
        for remark in document["remarks"]:
            print(remark)
        return
    print(f"torque RMSE {document['rmse_torque']:.4g} N m on the {document['test']},", end=" ")
    print(f"by joint {row(document['rmse_by_joint'], 4)};", end=" ")
    print(f"largest error found {row(document['largest_error_by_joint'], 4)} N m")
    print(f"{document['samples']} samples, {document['relations']} symmetry relations,", end=" ")
    print(f"{document['discovery_motions']} motions to discover them")
    for remark in document["remarks"]:
        print(remark)
