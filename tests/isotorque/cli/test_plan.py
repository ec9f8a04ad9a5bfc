"""``isotorque plan``: poses for the technician, then ``learn --data`` goes on."""

import csv
import io
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.runs.from_data.chain_plan import chain_of_tree
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import kinematic_trees


def isotorque(*arguments):
    return status([str(a) for a in arguments])


def poses_of(text):
    rows = list(csv.reader(io.StringIO(text)))
    return rows[0], np.array(rows[1:], dtype=float)


@given(kinematic_trees(max_joints=5), st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_the_first_guess_is_the_arm(tree, seed):
    q = np.random.default_rng(seed).uniform(-4, 4, (4, tree.n))
    expected = GravityModel(tree).torque(q)
    found = chain_of_tree(tree).torque(q)
    assert np.abs(found - expected).max() < 1e-11 * max(1.0, np.abs(expected).max())


def test_planned_poses_of_a_robot_are_learned_from(tmp_path, capsys):
    """A plan by the drawing, measured, learned without it."""
    robot = load_robot("ur5")
    assert isotorque("plan", "ur5", "--poses", 8) == 0
    captured = capsys.readouterr()
    header, q = poses_of(captured.out)
    assert header == [f"{name}.q" for name in robot.joint_names]
    assert q.shape == (8, 6)
    assert "N m after 8 poses" in captured.err
    limits = np.array(robot.limits)
    assert np.all((q >= limits[:, 0] - 1e-6) & (q <= limits[:, 1] + 1e-6))
    effort = np.asarray(robot.model.effortLimit)
    assert np.all(np.abs(GravityModel(robot).torque(q)) <= np.where(effort > 0, effort, np.inf))
    data = tmp_path / "measured.csv"
    write_csv(data, StaticSamples(q, GravityModel(robot).torque(q)), robot.joint_names)
    assert isotorque("learn", "--data", data, "--out", tmp_path / "out", "--quiet") == 0
    assert isotorque("verify", tmp_path / "out", "--robot", "ur5") == 0


def test_more_poses_for_a_learned_chain_chosen_from_a_list(tmp_path, capsys):
    robot = load_robot("3r")
    gravity, rng = GravityModel(robot), np.random.default_rng(0)
    q = rng.uniform(-2, 2, (8, 3))
    torque = gravity.torque(q) + 0.05 * rng.normal(size=q.shape)
    write_csv(tmp_path / "poses.csv", StaticSamples(q, torque), robot.joint_names)
    out = tmp_path / "out"
    options = ("--data", tmp_path / "poses.csv", "--torque-noise", 0.05, "--quiet")
    assert isotorque("learn", "--out", out, *options) == 0
    choice = rng.uniform(-2, 2, (12, 3)).round(6)
    rows = "\n".join(",".join(map(repr, row)) for row in choice.tolist())
    (tmp_path / "choice.csv").write_text(f"q1,q2,q3\n{rows}\n")
    capsys.readouterr()
    chosen = ("--from", tmp_path / "choice.csv")
    assert isotorque("plan", out, "--poses", 3, "--json", *chosen) == 0
    found = json.loads(capsys.readouterr().out)
    assert {tuple(p) for p in found["poses"]} <= {tuple(p) for p in choice.tolist()}
    expected = [found["standard_error_before"], *found["expected_standard_error"]]
    assert expected[-1] < 0.9 * expected[0]
    assert len(found["poses"]) == len(found["expected_standard_error"]) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("no-such-arm",), "no-such-arm"),
        (("2r", "--from", "none.csv"), "none.csv"),
        (("2r", "--from", "wrong.csv"), "header"),
        (("2r", "--from", "words.csv"), "one number per joint"),
        (("2r", "--poses", "0"), "--poses"),
    ],
)
def test_bad_input_is_one_line(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wrong.csv").write_text("a,b\n0,1\n")
    (tmp_path / "words.csv").write_text("q1,q2\n0,up\n")
    assert isotorque("plan", *arguments) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("error: ")
    assert words in error
    assert len(error.splitlines()) == 1
