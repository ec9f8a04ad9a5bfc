"""Every command: its JSON, its exit status, its one line per error."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from isotorque.cli.main import status


@pytest.fixture
def call(capsys):
    def run(*arguments):
        code = status([str(a) for a in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.fixture
def document(call):
    def run(*arguments, expect=0):
        code, out, err = call(*arguments, "--json")
        assert code == expect, err
        return json.loads(out)

    return run


def test_robots(document):
    robots = {r["name"]: r["joints"] for r in document("robots")}
    assert robots == {"2r": 2, "3r": 3, "pendulum": 1, "4r-planar": 4, "ur5": 6, "panda": 7}


def test_derive(document, call):
    found = document("derive", "2r")
    assert found["joints"] == ["shoulder", "elbow"]
    assert found["free_joints"] == []
    terms = {tuple(t["k"]): (t["cos"], t["sin"]) for t in found["potential"]}
    np.testing.assert_allclose(terms[1, 0], (0, 18.39375))
    np.testing.assert_allclose(terms[1, 1], (0, 6.13125))
    assert found["max_error_vs_pinocchio"] < 1e-12
    code, out, _ = call("derive", "2r", "--latex")
    assert code == 0
    assert r"\cos" in out
    code, out, _ = call("derive", "2r", "--sympy")
    assert "cos" in out


def test_derive_writes_c_and_casadi(call, tmp_path):
    import casadi

    c, function = tmp_path / "g.c", tmp_path / "g.casadi"
    assert call("derive", "ur5", "--c", c, "--casadi", function, "--json")[0] == 0
    assert "void isotorque_gravity(const double *q, double *tau)" in c.read_text()
    torque = casadi.Function.deserialize(function.read_text())(np.zeros(6))
    assert torque.shape == (6, 1)


@pytest.mark.parametrize(("robot", "order", "rank"), [("2r", 8, 2), ("3r", 16, 3), ("ur5", 16, 3)])
def test_symmetries(document, robot, order, rank):
    found = document("symmetries", robot)
    assert (found["order"], found["rank"], len(found["relations"])) == (order, rank, order)
    assert all(r["exact"] for r in found["relations"])
    n = len(found["joints"])
    assert np.shape(found["basis"]) == (rank, n)
    assert len(found["free_directions"]) == n - rank
    for relation in found["relations"]:
        assert np.shape(relation["M"]) == np.shape(relation["N"]) == (rank, n)
        assert len(relation["rhs"]) == rank
        np.testing.assert_allclose(relation["bound"], 0)


def test_approximate_symmetries(document):
    found = document("symmetries", "panda", "--tolerance", 0.1)
    assert found["order"] == 4
    assert max(max(r["bound"]) for r in found["relations"]) <= 0.1
    assert document("symmetries", "panda")["order"] == 2


def test_domain_is_the_paper_parallelogram(document):
    found = document("domain", "2r", "--center", f"{np.pi / 4},{np.pi / 4}")
    assert found["volume"] == pytest.approx((2 * np.pi) ** 2 / 8)
    rows = {tuple(np.round(r, 6)) for r in found["halfspaces"]}
    quarter, half = round(np.pi / 2, 6), round(np.pi, 6)
    assert rows == {(-1, 0, 0), (1, 0, quarter), (-1, -1, 0), (1, 1, half)}


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_simulate(document, engine):
    found = document("simulate", "2r", "--torque", "5,1", "--engine", engine)
    assert found["outcome"] == "settled"
    q = np.array(found["q"])
    torque = [18.39375 * np.cos(q[0]) + 6.13125 * np.cos(q.sum()), 6.13125 * np.cos(q.sum())]
    np.testing.assert_allclose(torque, [5, 1], atol=1e-8)
    assert found["seconds_simulated"] > 0
    assert document("simulate", "2r", "--torque", "30,0", "--engine", engine)["outcome"] == "limit"


def test_relations_files_are_judged(document, call, tmp_path):
    file = tmp_path / "relations.json"
    file.write_text(call("symmetries", "2r", "--json")[1])
    judged = document("verify", file, "--robot", "2r")
    assert judged["passed"]
    assert {v["status"] for v in judged["verdicts"]} <= {"proved", "bounded"}
    claim = {"relations": [{"A": [[-1, 0], [2, -1]], "d": [0, 0], "Y": [1, 1]}]}
    file.write_text(json.dumps(claim))
    judged = document("verify", file, "--robot", "2r", expect=1)
    assert judged["verdicts"][0]["status"] == "refuted"
    assert len(judged["verdicts"][0]["counterexample"]) == 2


def refused(call, *arguments):
    code, out, err = call(*arguments)
    assert code == 2
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    return err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("derive",), ["ROBOT"]),
        (("no-such-command",), ["no-such-command"]),
        (("derive", "nowhere.urdf"), ["nowhere.urdf", "not found"]),
        (("symmetries", "2r", "--tolerance", "-1"), ["tolerance", "-1"]),
        (("symmetries", "2r", "--tolerance", "nan"), ["tolerance"]),
        (("domain", "2r", "--center", "1"), ["--center", "2 finite numbers"]),
        (("simulate", "2r", "--torque", "1,nan"), ["--torque", "finite"]),
        (("simulate", "2r", "--torque", "1,2,3"), ["--torque", "2 finite numbers"]),
        (("simulate", "2r", "--torque", "1,2", "--physics", "magic"), ["physics", "open_loop"]),
        (("simulate", "2r", "--torque", "1,2", "--engine", "steam"), ["engine", "compiled"]),
        (("verify", "nowhere.json", "--robot", "2r"), ["nowhere.json"]),
        (("derive", "2r", "--c", "/nowhere/at/all.c"), ["/nowhere/at/all.c"]),
    ],
)
def test_bad_usage_is_one_line(call, arguments, words):
    message = refused(call, *arguments)
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("not a robot", ["XML"]),
        ("<robot name='x'><link name='a'/></robot>", ["moving joints is 0"]),
        (
            "<robot name='x'><link name='a'/><link name='b'/><joint name='slide' type='prismatic'>"
            "<parent link='a'/><child link='b'/></joint></robot>",
            ["slide", "prismatic"],
        ),
        (
            "<!DOCTYPE r [<!ENTITY a 'boom'>]><robot name='x'><link name='&a;'/></robot>",
            ["entit"],
        ),
    ],
)
def test_bad_robot_files_are_one_line(call, tmp_path, text, words):
    file = tmp_path / "arm.urdf"
    file.write_text(text)
    message = refused(call, "derive", file)
    assert "arm.urdf" in message
    for word in words:
        assert word.lower() in message.lower()


def test_help_of_every_command(call):
    for command in (
        "robots",
        "derive",
        "symmetries",
        "domain",
        "simulate",
        "discover",
        "relations",
        "learn",
        "verify",
        "run",
        "export",
        "paper",
        "sweep",
    ):
        code, out, _ = call(command, "--help")
        assert code == 0
        assert "--json" in out
        assert "--quiet" in out


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_directory_without_write_permission(call, tmp_path):
    Path(tmp_path).chmod(0o500)
    assert str(tmp_path) in refused(call, "derive", "2r", "--c", tmp_path / "g.c")
