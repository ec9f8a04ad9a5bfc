"""The commands of docs/your-robot.md run, on the 2R arm's file and a recording of it."""

import re
import shlex
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import read_csv, write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

PAGE = (Path(__file__).parents[2] / "docs" / "your-robot.md").read_text()
COMMANDS = re.findall(r"^    isotorque ((?:learn|verify|relations) .*?)(?: {2,}#.*)?$", PAGE, re.M)


@pytest.fixture
def arm(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    Path("my_arm.urdf").write_text(text)
    robot = load_robot("my_arm.urdf")
    rng = np.random.default_rng(0)
    q = rng.uniform(-3, 3, (40, 2))
    tau = GravityModel(robot).torque(q) + 0.02 * rng.normal(size=q.shape)
    write_csv("arm.csv", StaticSamples(q, tau), robot.joint_names)
    return robot


@pytest.mark.slow
def test_the_commands_run(arm, capsys):
    assert len(COMMANDS) == 10
    for command in COMMANDS:
        arguments = shlex.split(command)
        if arguments[0] == "learn" and "--data" not in arguments:
            arguments += ["--samples", "64"]
        assert status(arguments) == 0, (command, capsys.readouterr().err)


def test_the_rows_shown_are_a_recording_of_the_2r_arm(tmp_path):
    shown = re.search(r"((?:    [\w.,-]+\n){3})", PAGE[PAGE.index("shoulder.q,elbow.q") - 4 :])
    (tmp_path / "arm.csv").write_text(re.sub(r"^    ", "", shown[1], flags=re.M))
    robot = load_robot("2r")
    samples = read_csv(tmp_path / "arm.csv", robot.joint_names)
    assert len(samples.q) == 2
    np.testing.assert_allclose(samples.tau, GravityModel(robot).torque(samples.q), atol=0.01)


def test_the_python_example_runs(arm):
    learn = "learn 2r --data arm.csv --out out/b --quiet --learner parametric --symmetries none"
    assert status(learn.split()) == 0
    code = re.findall(r"```python\n(.*?)```", PAGE, re.S)[-1]
    names: dict = {}
    exec(code, names)
    truth = GravityModel(arm).torque(np.array([[0.3, 0.3]]))
    np.testing.assert_allclose(names["torque"], truth, atol=0.05)
