"""Subjects of ``isotorque verify``: a relations file, a saved model, or both in a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.csv_samples import joint_names_of, read_csv
from isotorque.learning.files.saved_models import load_model
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.runs.from_data.data_remarks import analytic_remarks
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.strict_json import read_json
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.fresh_measurements import (
    FreshMeasurements,
    MeasuredJudgement,
    verify_on_measurements,
)
from isotorque.verify.models.largest_errors import default_tolerance, require_gravity
from isotorque.verify.models.measured_torques import disagreement
from isotorque.verify.models.verify_model import verify_model
from isotorque.verify.relations.measured_relations import verify_relations_on_measurements
from isotorque.verify.relations.relation_files import load_relations
from isotorque.verify.relations.relations_file_claims import verify_relations_file
from isotorque.verify.verdict import Status, Verdict, all_passed

Array = NDArray[np.float64]

RELATION_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class FreshData:
    """Measurements to judge by.

    Attributes
    ----------
    file : Path
        A CSV file, see ``read_csv``.
    noise : MeasurementNoise or None
        Of the measurements, where it is known.
    """

    file: Path
    noise: MeasurementNoise | None = None


@dataclass(frozen=True, eq=False)
class Verification:
    """What was judged.

    Attributes
    ----------
    verdicts : tuple of Verdict
        At least one.
    remarks : tuple of str
        What else measurements show.
    measured : dict
        Their figures, by the name of what was judged.
    """

    verdicts: tuple[Verdict, ...]
    remarks: tuple[str, ...] = ()
    measured: dict[str, Any] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether every claim stands; what was not tested does not."""
        return all_passed(self.verdicts)

    @property
    def outcome(self) -> str:
        """In one line."""
        untested = sum(verdict.status is Status.UNTESTED for verdict in self.verdicts)
        if not untested:
            return "passed" if self.passed else "failed"
        return f"failed: {untested} of {len(self.verdicts)} claims were not tested"


def verify_path(
    path: Path,
    robot: Robot | None = None,
    gravity: GravityModel | None = None,
    tolerance: float | None = None,
    *,
    data: FreshData | None = None,
) -> Verification:
    """Judge whatever a path holds.

    Parameters
    ----------
    path
        A relations file, a ``model.json``, or a directory with either.
    robot, gravity
        The truth, if a robot file is to judge.
    tolerance
        Torque error allowed [N m]. None: beside a robot 1e-9 for relations; for models, and beside
        measurements, 1 % of each joint's largest torque, at least 1e-3 of the arm's.
    data
        Measurements, if they are to judge; with a robot as well, each claim says what it is about.

    Raises
    ------
    InputError
        If there is nothing to judge or nothing to judge by, a model of another robot, a robot that
        gravity does not load, beside which everything would pass, or measurements that say
        nothing.
    """
    if gravity is None and data is None:
        accepted = "--robot ROBOT, --data FRESH.csv or both"
        raise InputError("command line", "what to judge by", "missing", accepted)
    files = [path]
    if path.is_dir():
        names = ("relations.json", "model.json")
        files = [path / name for name in names if (path / name).is_file()]
    if not files:
        raise InputError(path, "directory", "without results", "relations.json or model.json in it")
    verdicts: list[Verdict] = []
    remarks: list[str] = []
    measured = {}
    for file in files:
        if data is not None:
            found = _by_measurements(file, data, tolerance)
            verdicts += found.verdicts
            about = f"{file.name}: " if len(files) > 1 else ""
            remarks += [f"{about}{remark}" for remark in found.remarks]
            measured[file.name] = found.document
        if gravity is not None and robot is not None:
            of_robot = _by_robot(file, robot, gravity, tolerance)
            verdicts += of_robot if data is None else _named(of_robot, gravity)
    if data is not None and gravity is not None and robot is not None:
        remarks += _beside_robot(data, robot, gravity)
    return Verification(tuple(verdicts), tuple(remarks), measured)


def _named(verdicts: tuple[Verdict, ...], gravity: GravityModel) -> Iterator[Verdict]:
    """Say that verdicts are about a robot file, where measurements judge as well."""
    for verdict in verdicts:
        yield replace(verdict, claim=f"the file's robot ({gravity.name}): {verdict.claim}")


def _is_model(path: Path) -> bool:
    document = read_json(path)
    return document.is_object and document.optional("kind") is not None


def _by_measurements(path: Path, data: FreshData, tolerance: float | None) -> MeasuredJudgement:
    if _is_model(path):
        saved = load_model(path)
        fresh = _fresh(data, saved.joint_names)
        return verify_on_measurements(saved, fresh, tolerance=tolerance, noise=data.noise)
    relations = load_relations(path)
    fresh = _fresh(data, relations.joint_names or joint_names_of(data.file))
    return verify_relations_on_measurements(relations, fresh, tolerance=tolerance, noise=data.noise)


def _fresh(data: FreshData, joint_names: tuple[str, ...]) -> FreshMeasurements:
    return FreshMeasurements.of(data.file, read_csv(data.file, joint_names), joint_names)


def _beside_robot(data: FreshData, robot: Robot, gravity: GravityModel) -> tuple[str, ...]:
    """How the measurements disagree with the robot file."""
    samples = read_csv(data.file, robot.joint_names)
    return analytic_remarks(disagreement(samples.q, samples.tau, gravity), None, samples, robot)


def _by_robot(
    path: Path, robot: Robot, gravity: GravityModel, tolerance: float | None
) -> tuple[Verdict, ...]:
    require_gravity(gravity)
    if _is_model(path):
        return _model(path, robot, gravity, tolerance)
    allowed = RELATION_TOLERANCE if tolerance is None else tolerance
    return verify_relations_file(load_relations(path), gravity, allowed)


def _model(
    path: Path, robot: Robot, gravity: GravityModel, tolerance: float | None
) -> tuple[Verdict, ...]:
    saved = load_model(path, robot)
    if saved.joint_names != robot.joint_names:
        raise InputError(path, "joints", list(saved.joint_names), f"{list(robot.joint_names)}")
    allowed = default_tolerance(gravity, robot.limits) if tolerance is None else tolerance
    predict: Callable[[Array], Array] = saved.learner.predict
    beside = _beside_gravity(saved.learner)
    judged = verify_model(
        predict if beside is None else lambda q: predict(q) - beside.at(q),
        gravity,
        limits=robot.limits,
        tolerance=allowed,
        largest_tolerance=allowed,
    )
    if beside is None:
        return judged.verdicts
    said = f"gravity alone, less {beside.in_words()} that the model holds beside it: "
    return tuple(replace(v, claim=said + v.claim) for v in judged.verdicts)


def _beside_gravity(learner: Any) -> Correction | None:
    """Constants and springs that a model holds, which no robot file has; None without any."""
    if isinstance(learner, RigidChain):
        found = learner.chain_.correction
    else:
        offsets = np.asarray(getattr(learner, "offsets_", 0.0))
        if offsets.ndim != 1:  # of local models they are another thing
            return None
        found = Correction(offsets)
    return found if found.constant.any() or found.rate.any() else None
