"""``verify`` looks at every joint of a saved model, and passes nothing beside a torque of zero."""

from __future__ import annotations

import html
import json
from xml.etree import ElementTree

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.static_samples import StaticSamples
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


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    """A chain of a recording of a 2R, and fresh measurements of it."""
    folder = tmp_path_factory.mktemp("chain")
    robot = load_robot("2r")
    gravity = GravityModel(robot)
    rng = np.random.default_rng(0)
    for name, repeated in (("first", 1), ("fresh", 4)):
        q = np.repeat(rng.uniform(-2.5, 2.5, (25, 2)), repeated, axis=0)
        tau = gravity.torque(q) + 0.02 * rng.normal(size=q.shape)
        write_csv(folder / f"{name}.csv", StaticSamples(q, tau), robot.joint_names)
    out = ["--out", str(folder / "out"), "--quiet"]
    assert status(["learn", "--data", str(folder / "first.csv"), *out]) == 0
    return folder


def by_data(chain, capsys, *more, what="out/model.json", data="fresh.csv"):
    code = status(["verify", str(chain / what), "--data", str(chain / data), *more])
    return code, capsys.readouterr()


def test_measurements_judge_without_a_robot(chain, capsys, tmp_path):
    page, junit = tmp_path / "page.html", tmp_path / "junit.xml"
    files = ["--report", str(page), "--junit", str(junit)]
    code, said = by_data(chain, capsys, "--json", *files, what="out")
    document = json.loads(said.out)
    assert code == 0
    assert document["passed"] is True
    assert set(document["measured"]) == {"model.json", "relations.json"}
    assert "robot" not in document
    joints = document["measured"]["model.json"]["joints"]
    assert all(joint["rmse"] < joint["allowed"] for joint in joints)
    suite = ElementTree.parse(junit).getroot()[0]
    assert [case.get("name") for case in suite] == [v["claim"] for v in document["verdicts"]]
    shown = html.unescape(page.read_text())
    for verdict in document["verdicts"]:
        assert verdict["claim"] in shown
        assert verdict.get("reason", "") in shown
    for remark in document["remarks"]:
        assert remark in shown
    code, said = by_data(chain, capsys, what="out")
    printed = said.out.splitlines()
    assert code == 0
    assert printed[-1] == "passed"
    assert sum(line.startswith(("tested: ", "proved: ")) for line in printed) == len(
        document["verdicts"]
    )
    assert all(remark in printed for remark in document["remarks"])


def test_both_kinds_of_verdicts_name_their_object(chain, capsys):
    code, said = by_data(chain, capsys, "--robot", "2r", "--json")
    document = json.loads(said.out)
    assert code == 0
    objects = [verdict["claim"].split(": ")[0] for verdict in document["verdicts"]]
    assert objects == ["the torque that was measured"] * 2 + ["the file's robot (2r)"] * 2
    assert document["robot"] == "2r"
    code, said = by_data(chain, capsys, "--robot", "2r", "--payload", "2", "--json")
    verdicts = json.loads(said.out)["verdicts"]
    assert code == 1
    assert [verdict["passed"] for verdict in verdicts] == [True, True, False, False]


def test_data_that_do_not_tell_are_exit_status_1(chain, capsys, tmp_path):
    junit = tmp_path / "junit.xml"
    code, said = by_data(chain, capsys, "--torque-noise", "3", "--junit", str(junit))
    assert code == 1
    assert said.out.splitlines()[-1] == "failed: 1 of 2 claims were not tested"
    assert ElementTree.parse(junit).getroot()[0].get("failures") == "1"
    code, said = by_data(chain, capsys, "--tolerance", "0")
    assert code == 1


def test_degrees_are_told(chain, capsys):
    header, *rows = (chain / "fresh.csv").read_text().splitlines()
    entries = [row.split(",") for row in rows]
    turned = [[repr(float(np.rad2deg(float(x)))) for x in e[:2]] + e[2:] for e in entries]
    (chain / "degrees.csv").write_text("\n".join([header, *map(",".join, turned)]) + "\n")
    for what, words in (("model", "q is in radians"), ("relations", "the angles are in degrees")):
        code, said = by_data(chain, capsys, what=f"out/{what}.json", data="degrees.csv")
        assert code == 1
        assert words in said.out


BAD = {
    "empty": ("", "header"),
    "header alone": ("q1,q2,tau1,tau2\n", "number of samples"),
    "one joint": ("q1,tau1\n0,1\n", "missing column"),
    "wrong names": ("a.q,b.q,a.tau,b.tau\n0,0,1,1\n", "header"),
    "nan": ("q1,q2,tau1,tau2\n0,0,1,nan\n", "'nan'"),
    "zeros": ("q1,q2,tau1,tau2\n0,0,0,0\n1,0,0,0\n", "zero in every row"),
    "the same": ("q1,q2,tau1,tau2\n0,0,1,2\n1,0,1,2\n", "the same in all 2 rows"),
    "few poses": ("q1,q2,tau1,tau2\n0,0,1,2\n1,0,2,2\n1,0,2,2\n", "2 (3 rows"),
}


@pytest.mark.parametrize("what", ["out/model.json", "out/relations.json", "out"])
@pytest.mark.parametrize("case", BAD)
def test_measurements_that_cannot_be_used_are_one_line(chain, capsys, tmp_path, what, case):
    text, words = BAD[case]
    path = tmp_path / "bad.csv"
    path.write_text(text)
    code, said = by_data(chain, capsys, what=what, data=path)
    assert code == 2
    assert said.out == ""
    assert said.err.startswith(f"error: {path}")
    assert words in said.err
    assert said.err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "--robot ROBOT, --data FRESH.csv or both"),
        (["--torque-noise", "0.1", "--robot", "2r"], "--data FRESH.csv beside it"),
        (["--data", "missing.csv"], "not readable"),
        (["--payload", "2", "--data", "x.csv"], "these beside --robot with a robot"),
    ],
)
def test_usage_is_checked(chain, capsys, arguments, words):
    assert status(["verify", str(chain / "out"), *arguments]) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.err.count("\n") == 1


@pytest.mark.parametrize("tolerance", ["-1", "nan", "inf"])
def test_tolerances_of_measurements_are_numbers(chain, capsys, tolerance):
    code, said = by_data(chain, capsys, "--tolerance", tolerance)
    assert code == 2
    assert "tolerance" in said.err
