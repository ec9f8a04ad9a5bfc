"""Subjects of ``isotorque verify``: a relations file, a saved model, or both in a run."""

from __future__ import annotations

from pathlib import Path

from isotorque.learning.files.saved_models import load_model
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.strict_json import read_json
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.largest_errors import default_tolerance, require_gravity
from isotorque.verify.models.verify_model import verify_model
from isotorque.verify.relations.relation_files import load_relations
from isotorque.verify.relations.relations_file_claims import verify_relations_file
from isotorque.verify.verdict import Verdict

RELATION_TOLERANCE = 1e-9


def verify_path(
    path: Path, robot: Robot, gravity: GravityModel, tolerance: float | None
) -> tuple[Verdict, ...]:
    """Judge whatever a path holds.

    Parameters
    ----------
    path
        A relations file, a ``model.json``, or a directory with either.
    robot, gravity
        The truth.
    tolerance
        Torque error allowed [N m]; None: 1e-9 for relations, for models 1 % of each joint's
        largest torque, at least 1e-3 of the arm's.

    Raises
    ------
    InputError
        If there is nothing to judge, a model of another robot, or a robot that gravity does not
        load, beside which everything would pass.
    """
    if not path.is_dir():
        return _one(path, robot, gravity, tolerance)
    found = [path / name for name in ("relations.json", "model.json") if (path / name).is_file()]
    if not found:
        raise InputError(path, "directory", "without results", "relations.json or model.json in it")
    return tuple(verdict for file in found for verdict in _one(file, robot, gravity, tolerance))


def _one(
    path: Path, robot: Robot, gravity: GravityModel, tolerance: float | None
) -> tuple[Verdict, ...]:
    require_gravity(gravity)
    document = read_json(path)
    if document.is_object and document.optional("kind") is not None:
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
    judged = verify_model(
        saved.learner,
        gravity,
        limits=robot.limits,
        tolerance=allowed,
        largest_tolerance=allowed,
    )
    return judged.verdicts
