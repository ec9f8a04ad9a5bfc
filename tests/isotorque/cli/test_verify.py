"""``verify`` looks at every joint of a saved model, and passes nothing beside a torque of zero."""

from __future__ import annotations

import json

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import StaticSamples, write_csv
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

PAN_TILT = """<robot name="pan_tilt"><link name="base"/>
<link name="l1"><inertial><mass value="2"/><origin xyz="0 0 0.1"/>{tensor}</inertial></link>
<link name="l2"><inertial><mass value="2"/><origin xyz="0.3 0 0"/>{tensor}</inertial></link>
<joint name="pan" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="50" velocity="3"/></joint>
<joint name="tilt" type="revolute"><parent link="l1"/><child link="l2"/><axis xyz="0 -1 0"/>
<limit lower="-3" upper="3" effort="50" velocity="3"/></joint></robot>""".replace(
    "{tensor}", '<inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/>'
)


@pytest.fixture(scope="module", params=[0.0, 5.0])
def learned(request, tmp_path_factory):
    """A model of data with so much torque at the joint that gravity does not load."""
    folder = tmp_path_factory.mktemp("pan")
    (folder / "pan.urdf").write_text(PAN_TILT)
    robot = load_robot(str(folder / "pan.urdf"))
    q = np.random.default_rng(0).uniform(-3, 3, (40, 2))
    tau = GravityModel(robot).torque(q) + np.array([request.param, 0.0])
    write_csv(folder / "data.csv", StaticSamples(q, tau), robot.joint_names)
    arguments = ["learn", str(folder / "pan.urdf"), "--data", str(folder / "data.csv")]
    arguments += ["--symmetries", "none", "--learner", "gaussian-process", "--quiet"]
    assert status([*arguments, "--out", str(folder / "out")]) == 0
    return folder, request.param


def test_torque_at_a_joint_without_gravity_is_refuted(learned, capsys):
    folder, bias = learned
    robot = ["--robot", str(folder / "pan.urdf")]
    code = status(["verify", str(folder / "out" / "model.json"), *robot, "--json"])
    document = json.loads(capsys.readouterr().out)
    assert code == (1 if bias else 0)
    assert document["passed"] is not bool(bias)
    if bias:
        rmse, largest = document["verdicts"]
        assert rmse["rmse"] == pytest.approx(bias, rel=0.05)
        assert largest["worst_error"] == pytest.approx(bias, rel=0.05)
        assert len(largest["counterexample"]) == 2


def test_nothing_is_judged_beside_a_file_without_masses(learned, tmp_path, capsys):
    folder, _ = learned
    empty = tmp_path / "pan.urdf"
    empty.write_text(PAN_TILT.replace('<mass value="2"/>', '<mass value="0"/>'))
    relations = tmp_path / "relations.json"
    relations.write_text('{"relations": [{"A": [[7, 1], [0, 1]], "d": [0, 1], "Y": [1, -1]}]}')
    for what in (folder / "out" / "model.json", relations):
        assert status(["verify", str(what), "--robot", str(empty)]) == 2
        said = capsys.readouterr()
        assert said.err.count("\n") == 1
        assert said.out == ""
