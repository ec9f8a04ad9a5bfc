"""A run keeps what later commands ask for: the robot's file, and the relations it learned."""

import json
from importlib.resources import files

import numpy as np
import pytest

from isotorque.cli.main import status

QUICK = ["--quiet", "--samples", "20", "--learner", "recursive-least-squares"]


@pytest.fixture
def arm(tmp_path):
    """A file of an arm that is not built in."""
    text = files("isotorque.symbolic").joinpath("robot_files/pendulum.urdf").read_text()
    file = tmp_path / "arm.urdf"
    file.write_text(text.replace('name="pendulum"', 'name="my arm"', 1))
    return file


def test_exact_candidates_of_a_robot_file_that_has_moved(arm, tmp_path, capsys):
    out = tmp_path / "run"
    assert status(["run", str(arm), "--out", str(out), *QUICK]) in (0, 1)
    arm.unlink()
    capsys.readouterr()
    assert status(["relations", str(out), "--candidates", "exact", "--json"]) == 0
    judged = json.loads(capsys.readouterr().out)["candidates"]["judged"]
    assert [entry["judgement"] for entry in judged] == ["consistent"] * 4
    # the kept file is the robot that verify is asked about
    assert status(["verify", str(out / "relations.json"), "--robot", str(out / "robot.urdf")]) == 0
    (out / "robot.urdf").unlink()
    capsys.readouterr()
    assert status(["relations", str(out), "--candidates", "exact"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "robot.urdf: file is missing" in error


@pytest.mark.parametrize("builtin", [False, True])
def test_exact_candidates_of_part_of_a_robot(builtin, tmp_path, capsys):
    """The part that was recorded is meant, not the whole robot, nor what it carries by default."""
    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    file, out = tmp_path / "arm.urdf", tmp_path / "run"
    file.write_text(text.replace('name="2r"', 'name="my arm"', 1))
    part = ["--lock", "elbow=0.5", "--payload", "0.7,0.1,0,0.05"]
    spec = "2r" if builtin else str(file)
    assert status(["discover", spec, "--out", str(out), "--quiet", *part]) == 0
    file.unlink()
    capsys.readouterr()
    assert status(["relations", str(out), "--candidates", "exact", "--json"]) == 0
    judged = json.loads(capsys.readouterr().out)["candidates"]["judged"]
    assert [entry["judgement"] for entry in judged] == ["consistent"] * 4
    assert all(len(entry["d"]) == 1 for entry in judged)
    if not builtin:  # another part of the same file is another robot
        more = ["relations", str(out), "--candidates", str(out / "robot.urdf")]
        assert status([*more, "--payload", "0.7", "--json"]) == 1
        other = json.loads(capsys.readouterr().out)["candidates"]["judged"]
        assert "contradicted" in {entry["judgement"] for entry in other}


@pytest.mark.parametrize("symmetries", ["learned", "exact"])
def test_a_run_leaves_relations_that_verify_reads(symmetries, tmp_path, capsys):
    out = tmp_path / "run"
    more = ["--symmetries", symmetries]
    assert status(["run", "pendulum", "--out", str(out), *QUICK, *more]) in (0, 1)
    assert not (out / "robot.urdf").exists()
    capsys.readouterr()
    assert status(["verify", str(out), "--robot", "pendulum", "--json"]) in (0, 1)
    verdicts = json.loads(capsys.readouterr().out)["verdicts"]
    assert sum(v["status"] == "proved" for v in verdicts) >= 4
    written = json.loads((out / "relations.json").read_text())
    assert status(["relations", str(out), "--json", "--quiet"]) == 0
    found = json.loads(capsys.readouterr().out)
    if symmetries == "learned":
        assert written == found
    else:
        assert written["order"] == found["order"] == 4


def test_derive_names_the_snaps_that_make_its_difference(tmp_path, capsys):
    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    assert 'axis xyz="0 -1 0"' in text
    file = tmp_path / "rounded.urdf"
    file.write_text(text.replace('axis xyz="0 -1 0"', 'axis xyz="0.000008 -1 0"', 1))
    assert status(["derive", str(file), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    [snap] = document["snapped"]
    assert (snap["joint"], snap["what"]) == ("shoulder", "axis")
    assert 0 < document["max_error_vs_pinocchio"] <= np.max(snap["effect"]) + 1e-9
    assert status(["derive", str(file)]) == 0
    assert "snapped: shoulder: axis, changes torques by at most" in capsys.readouterr().err
