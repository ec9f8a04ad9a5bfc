"""Part of a robot on every command: the options are the same everywhere, recorded, and kept."""

from __future__ import annotations

import io
import json
import shlex
import sqlite3
from pathlib import Path

import numpy as np
import pytest
import typer

from isotorque.cli.main import app, status
from isotorque.cli.robot_options import ROBOT_OPTIONS
from isotorque.symbolic.robots.load_robot import load_robot
from tests.symbolic.robots.test_robot_selection import GRIPPERS, arm, text

COMMANDS = [
    "derive",
    "symmetries",
    "domain",
    "simulate",
    "discover",
    "learn",
    "verify",
    "run",
    "relations",
    "export",
]


@pytest.fixture
def robot(tmp_path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm(*GRIPPERS["mimic"])))
    return path


@pytest.fixture
def call(capsys):
    def run(*arguments, expect=0):
        code = status([str(a) for a in arguments])
        captured = capsys.readouterr()
        assert code == expect, captured.err
        return captured.out if expect == 0 else captured.err

    return run


def document(call, *arguments):
    return json.loads(call(*arguments, "--json", "--quiet"))


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_that_takes_a_robot_has_the_options(command):
    known = {p.name for p in typer.main.get_command(app).commands[command].params}
    assert set(ROBOT_OPTIONS) <= known


@pytest.mark.parametrize("command", ["derive", "symmetries", "domain"])
def test_the_advice_of_the_refusal_works_as_it_stands(call, robot, command):
    message = call(command, robot, expect=2)
    assert message.count("\n") == 1
    assert all(f"'{name}'" in message for name in ("finger_1", "finger_2"))
    advice = shlex.split(message.split("are locked: ")[1])
    assert document(call, command, robot, *advice)["robot_options"] == {"lock": ["finger_*"]} or (
        document(call, command, robot, *advice)["robot_options"] == {"lock": ["finger_1"]}
    )


def test_options_reach_the_robot(call, robot):
    options = ["--lock", "finger_*=0.02", "--gravity", "0,0,-1.62", "--payload", "2,0.1,0,0@hand"]
    found = document(call, "derive", robot, *options)
    direct = load_robot(
        robot, lock=["finger_*=0.02"], gravity=(0, 0, -1.62), payload="2,0.1,0,0@hand"
    )
    assert found["robot_options"] == direct.options.as_json()
    terms = {tuple(t["k"]): np.hypot(t["cos"], t["sin"]) for t in found["potential"]}
    # axes along y: lever of the hand with fingers and payload, each at x = 0.05 or 0.1
    assert terms[1, 1] == pytest.approx(1.62 * (3 * 0.1 * 0.05 + 2.0 * 0.1))


def test_standard_input_is_a_robot(call, robot, monkeypatch):
    wanted = document(call, "derive", robot, "--lock", "finger_1")["potential"]
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(robot.read_bytes())))
    assert document(call, "derive", "-", "--lock", "finger_1")["potential"] == wanted


def test_a_run_keeps_its_robot(call, robot, tmp_path):
    """Discovered, learned, judged, tested and exported with what the first command was told."""
    out, part = tmp_path / "out", ["--lock", "finger_*", "--payload", "0.5", "--physics", "guided"]
    lattice = ["--strategy", "lattice", "--samples", "64", "--symmetries", "none", "--learner"]
    call("learn", robot, "--out", out, *part, *lattice, "trigonometric")
    recorded = {"lock": ["finger_*"], "payload": ["0.5"]}
    rows = sqlite3.connect(out / "run.sqlite").execute("select * from part").fetchall()
    assert any("finger_*" in str(row) for row in rows)
    assert json.loads((out / "model.json").read_text())["notes"]["robot_options"] == recorded
    judged = document(call, "verify", out, "--robot", robot, "--tolerance", "1e-6")
    assert judged["robot_options"] == recorded
    assert judged["passed"]
    other = ["verify", out, "--robot", robot, "--payload", "1.5", "--tolerance", "1e-6"]
    call(*other, expect=1)
    found = document(call, "relations", out)
    assert found["robot_options"] == recorded
    again = ["learn", robot, "--out", out, *lattice, "parametric"]
    call(*again)
    exported = document(call, "export", out, "--npz", tmp_path / "m.npz")
    assert exported["robot_options"] == recorded
    message = call(*again, "--payload", "1.5", expect=2)
    assert message.startswith("error: ")
    message = call("export", out, "--c", tmp_path / "m.c", "--payload", "1", expect=2)
    assert "options beside" in message


def test_relations_of_a_part_are_judged_with_that_part(call, robot, tmp_path):
    claimed = call("symmetries", robot, "--lock", "finger_1", "--gravity", "9.81,0,0", "--json")
    file = tmp_path / "relations.json"
    file.write_text(claimed)
    assert document(call, "verify", file, "--robot", robot)["passed"]
    wrong = ["verify", file, "--robot", robot, "--gravity", "0,0,-9.81"]
    call(*wrong, expect=1)


def test_options_without_a_robot_are_refused(call, tmp_path):
    message = call("relations", tmp_path, "--lock", "j1", expect=2)
    assert "--lock j1" in message


@pytest.mark.parametrize("damage", ['"x"', '{"lock": 3}', '{"speed": 1}'])
def test_damaged_options_of_a_file_are_one_line(call, robot, tmp_path, damage):
    file = tmp_path / "relations.json"
    file.write_text(f'{{"robot_options": {damage}, "relations": []}}')
    message = call("verify", file, "--robot", robot, expect=2)
    assert str(file) in message
    assert message.count("\n") == 1
