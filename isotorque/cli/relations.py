"""``isotorque relations``: symmetry relations learned from a recording, or tested against it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, row, say
from isotorque.cli.robot_options import named, takes_robot
from isotorque.plain import plain
from isotorque.symbolic.common.robot_options import RobotOptions

if TYPE_CHECKING:
    from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
    from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
    from isotorque.learning.relations.testing.judge_candidates import JudgedCandidate

PHASE = "discovery"


@takes_robot("candidates")
def relations(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a discovery.", show_default=False)
    ],
    candidates: Annotated[
        RobotOptions | None,
        typer.Option(
            "--candidates",
            parser=named,
            metavar="FILE|ROBOT|exact",
            help="Relations to test against the recording: a relations file (.json), or those that "
            "the geometry of a robot implies; exact: of the robot that RUN "
            "names. Options of a robot that are not given are as recorded.",
            show_default=False,
        ),
    ] = None,
    angle_noise: Annotated[
        float | None,
        typer.Option(
            "--angle-noise",
            metavar="RAD",
            help="Noise of the angles where known; otherwise the recording tells.",
            show_default=False,
        ),
    ] = None,
    torque_noise: Annotated[
        float | None,
        typer.Option(
            "--torque-noise",
            metavar="NM",
            help="Noise of the torques where known; 0 if only --angle-noise is given.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Learn (M, N, d) from the settled samples of RUN alone; also written to RUN/relations.json.

    With --candidates, relations from another source are tested against the same samples: exit
    status 1 if one is contradicted.
    """
    import json as text

    from isotorque.learning.recordings.recording_reader import RecordingReader
    from isotorque.learning.relations.learn_relations import learn_relations
    from isotorque.learning.relations.testing.judge_candidates import judge_candidates
    from isotorque.runs.experiment import DATABASE
    from isotorque.runs.options.recorded_robot import recorded_options
    from isotorque.runs.recorded_relations import (
        claimed_relations,
        judged_entry,
        recorded_limits,
        relations_found,
    )
    from isotorque.symbolic.common.files import write_whole

    noise = _noise(angle_noise, torque_noise)
    if candidates is None and noise is None and _of_a_chain(run, json=json, quiet=quiet):
        return 0
    with RecordingReader(run / DATABASE) as reader:
        samples, joints = reader.samples(phase=PHASE), reader.joint_names
        if not len(samples.q):  # not made by `discover`: all that ever rested
            samples = reader.samples()
        claims = () if candidates is None else claimed_relations(candidates, run, reader)
        limits = recorded_limits(reader)
    judged = judge_candidates(claims, samples.q, samples.tau, noise=noise)
    learned = learn_relations(samples.q, samples.tau, noise=noise)
    document = relations_found(learned, samples, joints, limits)
    document["robot_options"] = recorded_options(run)
    write_whole(run / "relations.json", text.dumps(plain(document), indent=1) + "\n")
    if candidates is not None:
        entries = [judged_entry(found) for found in judged]
        document["candidates"] = {"source": candidates.spec, "judged": entries}
    if json:
        emit_json(document)
    else:
        _print_learned(learned, document)
        if candidates is not None:
            _print_judged(judged, candidates.spec)
        say(f"written: {run / 'relations.json'}", quiet)
    return int(any(str(found.judgement) == "contradicted" for found in judged))


def _of_a_chain(run: Path, *, json: bool, quiet: bool) -> bool:
    """Tell the relations of a chain that was learned without a robot; False if there is none."""
    from isotorque.runs.from_data.chain_from_data import relations_of_saved_chain, write_relations

    document = relations_of_saved_chain(run)
    if document is None:
        return False
    write_relations(run, document)
    if json:
        emit_json(document)
        return True
    from isotorque.verify.relations.relation_files import load_relations

    listed = load_relations(run / "relations.json")
    print(f"{document['order']} relations from {document['samples']} samples, by a rigid chain:")
    print(document["statement"])
    if "generators" in document:
        print("generated by")
    for relation in listed:
        bound = f"{relation.bound.max(initial=0.0):.2g} N m"
        print(f"  {relation}  [wrong by at most {bound} in any torque, three standard errors]")
    for hypothesis in document["hypotheses"]:
        print(f"set: {hypothesis}")
    say(f"written: {run / 'relations.json'}", quiet)
    return True


def _noise(angle: float | None, torque: float | None) -> MeasurementNoise | None:
    from isotorque.cli.options import LARGEST
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


def _print_learned(learned: LearnedSymmetries, document: dict[str, Any]) -> None:
    print(f"{learned.order} relations from {document['samples']} settled samples, ", end="")
    print(f"by {learned.method}")
    for entry, said in zip(learned.relations, document["relations"], strict=True):
        how = f"{entry.known}, {entry.support} torques"
        if said["executable"] is False:
            how += ", not executable within the joint limits"
        print(f"  {entry.relation}  [{how}]")
    for kind in document["secondary_pairs"]:
        print(
            f"{kind['pairs']} pairs of {kind['torques']} torques obey none of them "
            f"(secondary), Y = {row(kind['Y'])}"
        )
    for entry in learned.contradicted:
        print(f"pairs suggest, other samples contradict: {entry.relation}")
    if learned.note:
        print(learned.note)
    if learned.missing:
        print(f"missing: {learned.missing}")


def _print_judged(judged: tuple[JudgedCandidate, ...], source: str) -> None:
    kinds = [str(found.judgement) for found in judged]
    print(
        f"{len(judged)} candidates from {source}: {kinds.count('consistent')} consistent, ", end=""
    )
    print(f"{kinds.count('contradicted')} contradicted", end="")
    print(f", {sum(kind.startswith('untestable') for kind in kinds)} untestable with this data")
    for found, kind in zip(judged, kinds, strict=True):
        known = "" if math.isnan(found.p_value) else f", p = {found.p_value:.3g}"
        if math.isfinite(found.relation.bound.max(initial=0.0)):
            known += f", wrong by at most {row(found.relation.bound, 3)} N m"
        joined = "needs " if kind.startswith("untestable") else ""
        reason = f"; {joined}{found.reason}" if found.reason else ""
        print(f"  {found.relation}  [{kind}{known}{reason}]")
