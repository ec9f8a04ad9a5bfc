"""The whole scheme: from robot to report, resumed, and on another robot."""

import json
import re
import shutil
from importlib.resources import files

import numpy as np
import pytest

from benchmarks.shared.small_arms import SmallArm, SmallJoint, arm_text
from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.runs.experiment import run_experiment
from isotorque.runs.options.run_options import ArmOptions, RunOptions
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot

# so few samples teach the paper's learner little; the chain needs no more
RUN = ["run", "2r", "--samples", "150", "--quiet"]


def quiet(*_):
    pass


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    out = tmp_path_factory.mktemp("run")
    assert status([*RUN, "--out", str(out)]) == 0
    return out


def test_the_report_holds_what_was_learned_and_judged(report):
    document = json.loads((report / "report.json").read_text())
    page = (report / "report.html").read_text()
    assert "<svg" in page
    assert document["passed"]
    assert document["setup"]["robot"] == "2r"
    assert len(document["symmetry"]["relations"]) == 8
    assert document["symmetry"]["found"] == 8
    assert document["exploration"]["explored_radius"] == 0.3  # a share says within which distance
    assert document["symmetry"]["false"] == 0
    assert document["exploration"]["commands"] == 150
    samples = document["curves"][0]["samples"]
    assert samples[-1] == 150
    # the curve is the paper's learner's, the model the rigid chain that was found beside it
    chain = document["chain"]
    assert document["curves"][0]["name"] == "local-linear-map-it, dense set"
    assert document["curves"][0]["rmse"][-1] == pytest.approx(chain["beside_rmse"])
    assert document["setup"]["learner"] == "rigid-chain"
    assert chain["known_after"] == document["totals"]["chain_poses"] <= 5
    assert document["model"]["targets"][0]["rmse"] < 1e-9
    assert "knew the whole map after" in page
    assert document["level_sets"]["complete"]
    assert len(document["level_sets"]["q"]) in (8, 16)
    q = np.array(document["level_sets"]["q"])
    torque = np.stack(
        [18.39375 * np.cos(q[:, 0]) + 6.13125 * np.cos(q.sum(1)), 6.13125 * np.cos(q.sum(1))], 1
    )
    np.testing.assert_allclose(np.abs(torque), [np.abs(document["level_sets"]["torque"])] * len(q))


def test_the_same_command_resumes_and_changes_nothing(report, tmp_path):
    again = tmp_path / "again"
    shutil.copytree(report, again)
    assert status([*RUN, "--out", str(again)]) == 0
    first, second = (json.loads((d / "report.json").read_text()) for d in (report, again))
    for document in (first, second):
        document["totals"].pop("seconds")
        for stage in document["stages"]:
            stage.pop("seconds")
    assert first == second


def test_other_options_in_the_same_directory_are_refused(report, capsys):
    code = status(["run", "2r", "--out", str(report), "--samples", "151", "--quiet"])
    assert code == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "151" in message or "150" in message


def test_every_number_follows_the_robot(tmp_path):
    robot = load_robot("2r")
    text = (robot_file := tmp_path / "heavy.urdf") and _heavier_2r()
    robot_file.write_text(text)
    heavy = run_experiment(RunOptions(str(robot_file), samples=60), _made(tmp_path / "a"), quiet)
    light = run_experiment(RunOptions("2r", samples=60), _made(tmp_path / "b"), quiet)
    ratio = heavy.scheme.torque_range / light.scheme.torque_range
    np.testing.assert_allclose(ratio, 2, rtol=0.2)
    assert heavy.scheme.learned.order == 8
    assert heavy.robot.digest != robot.digest


def _heavier_2r():
    from importlib.resources import files

    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    assert text.count('<mass value="5') == 2
    return text.replace('<mass value="5', '<mass value="10')


def _made(path):
    path.mkdir()
    return path


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"symmetries": "some"}, "learned, exact or none"),
        ({"samples": 0}, "--samples"),
        ({"n_min": 0}, "--n-min"),
        ({"learner": "parrot"}, "parrot"),
        ({"arm": ArmOptions(physics="magic")}, "open_loop"),
    ],
)
def test_options_that_make_no_sense_are_refused(changes, word, tmp_path):
    with pytest.raises(InputError, match=word):
        run_experiment(RunOptions("2r", **changes), tmp_path, quiet)


@pytest.mark.parametrize("symmetries", ["none", "exact"])
def test_runs_without_learned_symmetries(symmetries, tmp_path, capsys):
    arguments = ["run", "2r", "--out", tmp_path, "--samples", 40, "--symmetries", symmetries]
    arguments += ["--learner", "local-linear-map-it"]
    # the relations hold, the model of 40 samples does not: a run is worth what its model is worth
    assert status([*map(str, arguments), "--json", "--quiet"]) == 1
    document = json.loads(capsys.readouterr().out)
    refuted = [verdict["claim"] for verdict in document["verdicts"] if not verdict["passed"]]
    assert any("on the whole space" in claim for claim in refuted)
    assert "model: does not hold on the whole space" in document["summary"][-1]
    assert document["setup"]["symmetries"] == symmetries
    assert (document["symmetry"] is None) == (symmetries == "none")


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "order"), [("3r", 16), ("pendulum", 4), ("ur5", 16)])
def test_other_robots(robot, order, tmp_path, capsys):
    arguments = ["run", robot, "--out", tmp_path, "--samples", 200, "--json", "--quiet"]
    status([str(a) for a in arguments])
    document = json.loads(capsys.readouterr().out)
    assert document["symmetry"]["found"] == order
    assert document["symmetry"]["false"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1e-6, 1e-4, 1e4, 1e6])
def test_arms_of_any_size_pass(factor, tmp_path, capsys):
    def times(match):
        return f'{match[1]}="{factor * float(match[2])!r}"'

    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    scaled = re.sub(r'((?<=mass )value|i[xyz][xyz]|effort)="([^"]*)"', times, text)
    assert scaled.count(repr(5 * factor)) == 2
    (tmp_path / "arm.urdf").write_text(scaled)
    arguments = ["run", tmp_path / "arm.urdf", "--out", tmp_path / "out", "--samples", 150]
    arguments += ["--learner", "recursive-least-squares", "--json", "--quiet"]
    assert status([str(a) for a in arguments]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["symmetry"]["found"] == 8
    assert document["totals"]["rmse_torque"] < 1e-4 * 24.5 * factor


@pytest.mark.parametrize(
    "command",
    [
        ["run"],
        ["learn"],
        ["learn", "--strategy", "lattice"],
        ["learn", "--data", "arm.csv", "--symmetries", "exact", "--learner", "gaussian-process"],
    ],
)
def test_more_symmetries_than_can_be_listed_are_refused_at_once(
    command, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    text = '<robot name="hand"><link name="palm"/>'
    for i in range(7):
        text += f"""<link name="f{i}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia
            ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
            <joint name="j{i}" type="revolute"><parent link="palm"/><child link="f{i}"/>
            <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>"""
    (tmp_path / "hand.urdf").write_text(text + "</robot>")
    names = [f"j{i}" for i in range(7)]
    q = np.random.default_rng(0).uniform(-3, 3, (20, 7))
    write_csv("arm.csv", StaticSamples(q, np.sin(q)), names)
    assert status([command[0], "hand.urdf", *command[1:], "--out", "out", "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "number of symmetries is 16384; accepted: at most 4096" in said
    advised = said.split("--joints ")[1].strip()
    assert advised == ",".join(names[:6])
    assert status(["symmetries", "hand.urdf", "--joints", advised, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["order"] == 4096


def test_an_arm_that_gravity_does_not_move_is_told_what_would(tmp_path, capsys):
    joints = tuple(SmallJoint("z", (0.3, 0, 0), (-2, 2), 10, 1.0, (0.2, 0, 0)) for _ in range(2))
    path = tmp_path / "flat.urdf"
    path.write_text(arm_text("flat", SmallArm("turns in a horizontal plane", joints)))
    command = ["run", str(path), "--samples", "20", "--quiet"]
    assert status([*command, "--out", str(tmp_path / "a")]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert "torque of gravity is 0 at every joint" in said
    assert "--gravity" in said
    assert status([*command, "--gravity", "9.81,0,0", "--out", str(tmp_path / "b")]) == 0
