"""What ``verify`` judges by: a robot, measurements, or both, each claim with its object."""

from __future__ import annotations

import json

import numpy as np
import pytest

from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.saved_models import SavedModel, save_model
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.runs.verification import FreshData, verify_path
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.relation_files import relations_document
from isotorque.verify.verdict import Status


def recording(path, robot, seed, poses=20, noise=0.01):
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-2.5, 2.5, (poses, robot.n)), 2, axis=0)
    tau = GravityModel(robot).torque(q) + noise * rng.normal(size=q.shape)
    write_csv(path, StaticSamples(q, tau), robot.joint_names)
    return FreshData(path)


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """A 2R that carries 1 kg, whose drawing knows nothing of that; a model of it, relations too."""
    folder = tmp_path_factory.mktemp("loaded")
    drawing = load_robot("2r")
    arm = load_robot(RobotOptions("2r", payload=("1,0.1,0,0",)))
    recording(folder / "first.csv", arm, 0)
    fresh = recording(folder / "fresh.csv", arm, 1)
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (20, 2))
    chain = RigidChain().fit(q, GravityModel(arm).torque(q))
    save_model(SavedModel(chain, "2r", "", arm.joint_names, {}), folder)
    group = primary_symmetries(GravityModel(arm).potential)
    document = relations_document(group, arm.joint_names)
    (folder / "relations.json").write_text(json.dumps(document))
    return folder, drawing, arm, fresh


def statuses(verification, words):
    return [v.status for v in verification.verdicts if v.claim.startswith(words)]


def test_a_right_model_beside_a_wrong_drawing(loaded):
    folder, drawing, _, fresh = loaded
    model = folder / "model.json"
    by_data = verify_path(model, data=fresh)
    assert by_data.passed
    assert by_data.outcome == "passed"
    assert {v.status for v in by_data.verdicts} == {Status.TESTED}
    by_drawing = verify_path(model, drawing, GravityModel(drawing))
    assert not by_drawing.passed
    assert not by_drawing.measured
    both = verify_path(model, drawing, GravityModel(drawing), data=fresh)
    assert statuses(both, "the torque that was measured") == [Status.TESTED] * 2
    assert statuses(both, "the file's robot (2r)") == [Status.REFUTED] * 2
    assert len(both.verdicts) == 4
    assert not both.passed
    assert any("less analytic gravity of 2r" in said for said in both.remarks)


def test_a_wrong_model_beside_a_right_drawing(loaded, tmp_path):
    _, drawing, _, fresh = loaded
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (20, 2))
    chain = RigidChain().fit(q, GravityModel(drawing).torque(q))  # of the arm without its load
    path = save_model(SavedModel(chain, "2r", "", drawing.joint_names, {}), tmp_path)
    both = verify_path(path, drawing, GravityModel(drawing), data=fresh)
    assert statuses(both, "the torque that was measured") == [Status.REFUTED] * 2
    assert statuses(both, "the file's robot (2r)") == [Status.TESTED] * 2


def test_all_that_a_directory_holds_is_judged(loaded):
    folder, _, arm, fresh = loaded
    both = verify_path(folder, arm, GravityModel(arm), data=fresh)
    assert both.passed
    assert set(both.measured) == {"relations.json", "model.json"}
    assert any(said.startswith("model.json: ") for said in both.remarks)
    of_relations = [v for v in both.verdicts if "relation " in v.claim]
    assert len(of_relations) == 2 * len(
        json.loads((folder / "relations.json").read_text())["relations"]
    )


def test_untested_claims_are_counted(loaded):
    folder, *_, fresh = loaded
    noisy = FreshData(fresh.file, MeasurementNoise(0.0, 5.0))
    found = verify_path(folder / "model.json", data=noisy)
    assert found.outcome == "failed: 1 of 2 claims were not tested"


def test_there_must_be_something_to_judge_and_to_judge_by(loaded, tmp_path):
    folder, *_, fresh = loaded
    with pytest.raises(InputError, match="--robot ROBOT, --data FRESH"):
        verify_path(folder)
    with pytest.raises(InputError, match="without results"):
        verify_path(tmp_path, data=fresh)
