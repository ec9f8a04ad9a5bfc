"""Runs of arms that do not hang at home, or cannot hold themselves, and other strategies."""

import json

import numpy as np
import pytest

from benchmarks.shared.small_arms import write_arm
from isotorque.cli.main import status

TABLETOP = """<robot name="tabletop"><link name="base"/><link name="l1"><inertial>
<origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 -1 0"/>
<limit lower="-1.2" upper="1.2" effort="{effort}" velocity="1"/></joint></robot>"""
FAST = ["--learner", "recursive-least-squares", "--samples", "60", "--quiet"]


def run(capsys, *words):
    """Exit status and report of a run."""
    code = status(["run", *words, "--json"])
    streams = capsys.readouterr()
    assert code in (0, 1), streams.err
    return code, json.loads(streams.out)


@pytest.fixture
def tabletop(tmp_path):
    path = tmp_path / "tabletop.urdf"
    path.write_text(TABLETOP.format(effort=10))
    return str(path)


def test_an_arm_whose_limits_exclude_hanging_down_is_driven_by_torques(tabletop, tmp_path, capsys):
    _, report = run(capsys, tabletop, "--out", str(tmp_path / "out"), *FAST)
    assert report["setup"]["physics"] == "open_loop"
    assert report["discovery"]["settled"] > 20
    assert report["totals"]["rmse_torque"] < 1e-3
    assert report["totals"]["relations_false"] == 0


def test_an_arm_that_nothing_holds_is_led_and_that_is_said(tmp_path, capsys):
    robot = str(write_arm("short-stop", tmp_path))
    words = [robot, "--out", str(tmp_path / "out"), *FAST[:-1]]
    assert status(["run", *words]) in (0, 1)
    said = capsys.readouterr().err.replace("\r", "\n").splitlines()
    assert sum("cannot hold itself within its limits: it is guided" in line for line in said) == 1
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["setup"]["physics"] == "guided"
    assert "--physics guided" in report["setup"]["command"]
    assert any("cannot hold itself" in remark for remark in report["remarks"])
    assert "cannot hold itself" in (tmp_path / "out" / "report.html").read_text()
    assert report["totals"]["rmse_torque"] < 1e-3
    # asked for, it is guided just so; on its own it is refused with what would work
    _, asked = run(capsys, *words, "--physics", "guided", "--out", str(tmp_path / "out"))
    assert asked["totals"]["rmse_torque"] == report["totals"]["rmse_torque"]
    other = ["--physics", "open_loop", "--out", str(tmp_path / "alone")]
    assert status(["run", robot, *FAST, *other]) == 2
    assert "guided physics" in capsys.readouterr().err


@pytest.mark.parametrize(
    "strategy", ["lattice", pytest.param("goal-babbling", marks=pytest.mark.slow), "motor-babbling"]
)
def test_every_strategy_ends_with_a_report(strategy, tmp_path, capsys):
    words = ["2r", "--strategy", strategy, "--out", str(tmp_path), *FAST]
    words[words.index("--samples") + 1] = "32"
    _, report = run(capsys, *words, "--symmetries", "exact")
    learned = report["totals"]["learning_samples"]
    assert 20 <= learned <= 40
    assert report["setup"]["physics"] == ("guided" if strategy == "lattice" else "open_loop")
    assert f"--strategy {strategy}" in report["setup"]["command"]
    assert (tmp_path / "model.json").is_file()


def test_a_lattice_of_an_arm_that_is_led_needs_no_discovery(tmp_path, capsys):
    robot = str(write_arm("short-stop", tmp_path))
    words = [robot, "--out", str(tmp_path / "out"), "--strategy", "lattice", *FAST]
    _, report = run(capsys, *words)
    assert report["totals"]["discovery_motions"] == 0
    assert report["totals"]["rmse_torque"] < 1e-3


def test_torques_beyond_the_effort_limit_are_cut_and_that_is_said(tmp_path, capsys):
    path = tmp_path / "weak.urdf"
    path.write_text(TABLETOP.format(effort=0.8))
    _, report = run(capsys, str(path), "--out", str(tmp_path / "out"), *FAST)
    assert any("were cut to the largest" in remark for remark in report["remarks"])
    torques = np.abs(report["static_torques"]["admissible"])
    assert torques.max() <= 0.8


@pytest.mark.parametrize(("effort", "code"), [(0.5, 2), (0, 0), (-1, 0), (0.9, 0)])
def test_simulate_refuses_torques_beyond_the_effort_limit(effort, code, tmp_path, capsys):
    path = tmp_path / "arm.urdf"
    path.write_text(TABLETOP.format(effort=effort))
    assert status(["simulate", str(path), "--from=-0.6", "--torque", "0.8"]) == code
    streams = capsys.readouterr()
    if code:
        assert streams.err.startswith("error: tabletop: --torque of joint 'j1' is 0.8;")
        assert "-0.5 to 0.5 [N m]" in streams.err
    else:
        assert streams.out.startswith("settled at q = (-0.617")


def test_a_strategy_that_cannot_lead_says_which_can(tmp_path, capsys):
    robot = str(write_arm("short-stop", tmp_path))
    words = [robot, "--out", str(tmp_path / "out"), "--strategy", "goal-babbling", *FAST]
    assert status(["run", *words, "--physics", "guided"]) == 2
    assert "direction-sampling or lattice" in capsys.readouterr().err
