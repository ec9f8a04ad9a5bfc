"""The relations of a recording as a document, and relations from elsewhere to hold against it."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from isotorque.learning.recordings.recording_reader import RecordingReader, SettledSamples
from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.learning.relations.reachable_relation import is_executable
from isotorque.learning.relations.testing.judge_candidates import JudgedCandidate
from isotorque.runs.options.recorded_robot import as_recorded, recorded_robot
from isotorque.runs.run_outcome import RunOutcome
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.files import write_whole
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.relation_files import load_relations, relations_document


def claimed_relations(
    robot: RobotOptions, run: Path, reader: RecordingReader
) -> tuple[SymmetryRelation, ...]:
    """Relations to test: those of a file, or those that the geometry of a robot implies.

    Options of the robot that are not given are as recorded.
    """
    if robot.spec.endswith(".json"):
        return load_relations(robot.spec, joint_names=reader.joint_names).relations
    exact = robot.spec == "exact" and not robot.changed
    loaded = recorded_robot(run, reader) if exact else load_robot(as_recorded(robot, run))
    return tuple(primary_symmetries(GravityModel(loaded).potential))


def recorded_limits(reader: RecordingReader) -> list[list[float]] | None:
    """Joint limits of the arm that was recorded, infinite where it has none; None if unknown."""
    for part in reader.parts:
        recorded = part.info.options.get("arm", {}).get("limits")
        if recorded is not None:
            ends = (-math.inf, math.inf)
            return [
                [end if x is None else x for x, end in zip(pair, ends, strict=True)]
                for pair in recorded
            ]
    return None


def relations_found(
    learned: LearnedSymmetries,
    samples: SettledSamples,
    joints: Sequence[str],
    limits: list[list[float]] | None,
) -> dict[str, Any]:
    """The learned relations as the document that `isotorque relations` writes."""
    extra = [
        {
            "known": str(entry.known),
            "executable": None if limits is None else is_executable(entry.relation, limits),
            "standard_error": entry.standard_error,
            "support": entry.support,
            "p_value": entry.p_value,
            "log10_false_alarms": entry.log10_false_alarms,
            "snapped": entry.snapped,
            "regression": _regression(entry.regression),
        }
        for entry in learned.relations
    ]
    return relations_document(learned.group, joints, extra=extra, corrected=learned.corrected) | {
        "method": learned.method,
        "missing": learned.missing,
        "note": learned.note,
        "misfit": _misfit(learned),
        "samples": len(samples.q),
        "torques": int(samples.torque_groups().max(initial=-1)) + 1,
        "secondary_pairs": [
            {"Y": pairs.Y, "pairs": len(pairs), "torques": len(set(pairs.torque_index))}
            for pairs in learned.rejected
        ],
        "contradicted": [
            {"A": r.A, "d": r.d, "Y": r.Y, "support": entry.support}
            for entry in learned.contradicted
            for r in [entry.relation]
        ],
    }


def save_relations(run: RunOutcome, out: Path, plain: Callable[[Any], Any]) -> Path | None:
    """Write the relations that a run exploited to ``out``; return the file, None without any.

    Parameters
    ----------
    run
        From `isotorque.runs.experiment.run_experiment`.
    out
        Its directory.
    plain
        Makes plain JSON of arrays.
    """
    names, learned = run.robot.joint_names, run.scheme.learned
    if run.options.symmetries == "exact":
        document = relations_document(run.group, names)
    elif run.options.symmetries == "learned" and learned is not None:
        with RecordingReader(out / DATABASE) as reader:
            samples = reader.samples(phase="discovery")
            document = relations_found(learned, samples, names, recorded_limits(reader))
    else:
        return None
    document["robot_options"] = run.robot.options.as_json()
    path = out / "relations.json"
    write_whole(path, json.dumps(plain(document), indent=1) + "\n")
    return path


def _misfit(learned: LearnedSymmetries) -> dict[str, Any] | None:
    """What the samples show beside gravity; None where no potential could be fitted."""
    lack = learned.lack
    if lack is None:
        return None
    return {
        "failed": lack.failed,
        "said": lack.said,
        "causes": [cause.as_json() for cause in lack.causes],
        "offset_joints": lack.offset_joints + 1,
        "offsets": lack.offsets,
        "offset_errors": lack.offset_errors,
        "relations_of_gravity_alone": len(learned.corrected),
    }


def _regression(found: Any) -> dict[str, Any] | None:
    """Return the free regression of a relation: M q_r + N q_s = d with real numbers."""
    if found is None:
        return None
    names = ("M", "N", "d", "A_error", "d_error", "pairs")
    return {name: getattr(found, name) for name in names}


def judged_entry(found: JudgedCandidate) -> dict[str, Any]:
    """What the samples say of a candidate, as an object of the document."""
    relation = found.relation
    return {
        "A": relation.A,
        "d": relation.d,
        "Y": relation.Y,
        "judgement": str(found.judgement),
        "p_value": found.p_value,
        "bound": relation.bound,
        "reason": found.reason,
    }
