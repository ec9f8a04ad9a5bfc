"""``learn --data``: recordings of a real arm, judged by themselves and against the robot file."""

import json
import re

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

ROBOT = load_robot("2r")
GRAVITY = GravityModel(ROBOT)
NOISE = 0.02


def recording(path, count=60, seed=0, change=lambda q, tau: tau, noise=NOISE):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, 2))
    tau = change(q, GRAVITY.torque(q) + noise * rng.normal(size=q.shape))
    write_csv(path, StaticSamples(q, tau), ROBOT.joint_names)
    return path


@pytest.fixture
def learn(capsys):
    def run(out, data, *options, expect=0):
        arguments = ["learn", "2r", "--out", out, "--data", data, "--json", "--quiet", *options]
        code = status([str(a) for a in arguments])
        captured = capsys.readouterr()
        assert code == expect, captured.err
        return json.loads(captured.out) if code == 0 else captured.err

    return run


def test_a_clean_recording_agrees_with_the_robot(learn, tmp_path):
    found = learn(tmp_path, recording(tmp_path / "arm.csv"), "--learner", "trigonometric")
    assert (found["samples"], found["relations"], found["discovery_motions"]) == (60, 8, 0)
    assert found["rmse_torque"] < NOISE / 2
    data = found["data"]
    assert data["rows"] == 60
    assert data["outliers"]["count"] == 0
    assert data["held_out"]["rmse"] == pytest.approx(NOISE, rel=0.3)
    assert data["analytic"]["rmse"] == pytest.approx(NOISE, rel=0.3)
    assert not any("systematic" in remark for remark in found["remarks"])
    with RecordingReader(tmp_path / "run.sqlite") as reader:
        assert [p.info.part for p in reader.parts] == ["data"]
        assert len(reader.samples(phase="learning").q) == 60


def test_the_default_learner_is_saved_and_judged(learn, tmp_path):
    found = learn(tmp_path, recording(tmp_path / "arm.csv", 25))
    assert found["learner"] == "parametric"
    assert [p["samples"] for p in found["curve"]] == [25]
    assert found["rmse_torque"] < 0.02
    tried = found["data"]["contenders"]
    assert set(tried) == {"parametric", "rigid-chain", "rigid-chain+gaussian-process"}
    assert tried["parametric"]["rmse"] == pytest.approx(NOISE, rel=0.3)
    assert status(["verify", str(tmp_path), "--robot", "2r", "--tolerance", "0.1"]) == 0


@pytest.mark.parametrize("learner", ["trigonometric", "parametric", "recursive-least-squares"])
def test_outliers_are_reported_and_kept_unless_told_otherwise(learn, tmp_path, learner):
    def spoil(q, tau):
        tau[5, 1] += 3.0
        tau[17] *= -1.0
        tau[31, 1] = 60.0
        return tau

    data = recording(tmp_path / "arm.csv", 90, change=spoil)
    kept = learn(tmp_path, data, "--learner", learner)
    assert kept["samples"] == 90
    assert kept["data"]["outliers"]["count"] == 3
    assert kept["data"]["outliers"]["worst_rows"] == [32, 18, 6]  # 1 is below the header
    assert kept["relations"] == 8
    assert any("3 outliers" in r and "32, 18, 6" in r for r in kept["remarks"])
    assert kept["data"]["held_out"]["rmse"] > 1.0
    assert kept["data"]["held_out"]["rmse_without_outliers"] < 0.1
    dropped = learn(tmp_path, data, "--learner", learner, "--drop-outliers")
    assert dropped["samples"] == 87
    assert dropped["rmse_torque"] < kept["rmse_torque"] / 5


def test_disagreement_with_the_robot_file_is_told_in_numbers(learn, tmp_path):
    data = recording(tmp_path / "arm.csv", 40, change=lambda q, tau: np.add(tau, [0.5, 0.0]))
    found = learn(tmp_path, data, "--learner", "gaussian-process", "--symmetries", "none")
    analytic = found["data"]["analytic"]
    assert analytic["mean_by_joint"] == pytest.approx([0.5, 0.0], abs=0.01)
    assert analytic["rmse"] == pytest.approx(0.5 / np.sqrt(2), rel=0.05)
    assert any("systematic" in remark for remark in found["remarks"])
    # the model follows the data, not the file
    assert found["rmse_torque"] > 0.3


@pytest.mark.parametrize("symmetries", ["exact", "learned"])
def test_symmetries_that_the_arm_does_not_have_are_not_enforced(learn, tmp_path, symmetries):
    # a cable pulls the elbow: a constant torque that no change of sign leaves alone
    data = recording(tmp_path / "arm.csv", 80, change=lambda q, tau: np.add(tau, [0.0, 0.4]))
    options = ("--learner", "recursive-least-squares", "--symmetries")
    found = learn(tmp_path, data, *options, symmetries)
    assert found["relations"] < 8
    if symmetries == "exact":
        test = found["data"]["symmetry_test"]
        assert (test["relations"], test["kept"]) == (8, found["relations"])
        assert test["contradicted"] >= 4
        assert any("do not hold on this arm" in remark for remark in found["remarks"])
    whole = recording(tmp_path / "whole.csv", 80)
    found = learn(tmp_path / "whole", whole, *options, symmetries)
    assert found["relations"] == 8
    assert found["data"]["symmetry_test"]["contradicted"] == 0


@pytest.mark.parametrize(
    ("change", "word"),
    [(lambda q, tau: -tau, "opposite sign"), (lambda q, tau: GRAVITY.torque(np.deg2rad(q)), "rad")],
)
def test_wrong_signs_and_units_are_suspected(learn, tmp_path, change, word):
    data = recording(tmp_path / "arm.csv", change=change)
    found = learn(tmp_path, data, "--learner", "parametric", "--symmetries", "none")
    assert any(word in remark for remark in found["remarks"])


def test_numbered_columns_and_a_single_row_do(learn, tmp_path):
    data = tmp_path / "arm.csv"
    q = np.array([0.3, -1.0])
    tau = GRAVITY.torque(q)
    data.write_text("q1,q2,tau1,tau2\n" + ",".join(repr(float(x)) for x in (*q, *tau)) + "\n")
    found = learn(tmp_path, data, "--learner", "trigonometric", "--symmetries", "exact")
    assert found["samples"] == 1
    assert found["data"]["held_out"] is None
    assert found["rmse_torque"] < 1e-9  # two equations for two numbers


def test_one_seed_gives_one_model_to_the_last_byte(learn, tmp_path):
    data = recording(tmp_path / "arm.csv", 8)
    models = []
    for folder in ("a", "b"):
        learn(tmp_path / folder, data, "--symmetries", "exact")
        models.append((tmp_path / folder / "model.npz").read_bytes())
    assert models[0] == models[1]


def test_a_run_holds_one_recording(learn, tmp_path):
    learn(tmp_path, recording(tmp_path / "one.csv", 12), "--learner", "parametric")
    message = learn(tmp_path, recording(tmp_path / "two.csv", 12, seed=1), expect=2)
    assert "same data" in message


BAD = {
    "wrong columns": ("q1,q2,tau1\n0,0,0\n", ["line 1", "tau2"]),
    "another arm": ("q1,q2,q3,tau1,tau2,tau3\n0,0,0,0,0,0\n", ["line 1", "q3"]),
    "other names": ("hip.q,knee.q,hip.tau,knee.tau\n0,0,0,0\n", ["line 1", "shoulder.q"]),
    "NaN": ("q1,q2,tau1,tau2\n0,0,0,0\n0,nan,0,0\n", ["line 3", "q2", "nan"]),
    "infinite": ("q1,q2,tau1,tau2\n0,0,inf,0\n", ["line 2", "tau1"]),
    "text": ("q1,q2,tau1,tau2\n0,0,high,0\n", ["line 2", "tau1", "high"]),
    "short line": ("q1,q2,tau1,tau2\n0,0,0\n", ["line 2"]),
    "no samples": ("q1,q2,tau1,tau2\n", ["samples"]),
    "empty": ("", ["line 1"]),
    "binary": (b"\xff\xfe\x00q", ["UTF-8"]),
}


@pytest.mark.parametrize("kind", sorted(BAD))
def test_bad_files_are_one_line(learn, tmp_path, kind):
    content, words = BAD[kind]
    data = tmp_path / "arm.csv"
    data.write_bytes(content if isinstance(content, bytes) else content.encode())
    message = learn(tmp_path / "out", data, expect=2)
    assert message.startswith("error: ")
    assert message.count("\n") == 1
    for word in ("arm.csv", *words):
        assert word in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--strategy", "lattice"), ["--strategy", "--data"]),
        (("--samples", "5"), ["--samples", "--data"]),
        (("--physics", "geared"), ["--physics"]),
        (("--learner", "parrot"), ["parrot"]),
        (("--symmetries", "some"), ["learned, exact or none"]),
    ],
)
def test_options_that_have_no_meaning_are_refused(learn, tmp_path, options, words):
    message = learn(tmp_path / "out", recording(tmp_path / "arm.csv", 5), *options, expect=2)
    assert message.count("\n") == 1
    for word in words:
        assert word in message


def test_a_missing_file_is_named(learn, tmp_path):
    assert "nowhere.csv" in learn(tmp_path, "nowhere.csv", expect=2)


@pytest.mark.parametrize("learner", ["trigonometric", "parametric"])
def test_a_constant_of_a_sensor_is_told_apart_from_gravity(learn, tmp_path, learner):
    path = recording(tmp_path / "cable.csv", change=lambda q, tau: tau + np.array([0.0, 0.2]))
    found = learn(tmp_path, path, "--learner", learner)
    said = next(r for r in found["remarks"] if "constant torque" in r and "the model contains" in r)
    size = re.search(r"([+-][\d.]+) N m on elbow", said) or re.search(r"([+-][\d.]+) N m", said)
    assert float(size[1]) == pytest.approx(0.2, abs=0.02)
    assert " on elbow" in said
    analytic = found["data"]["analytic"]
    assert analytic["rmse"] > 0.1
    assert analytic["rmse_beside_constants"] == pytest.approx(NOISE, rel=0.3)
    assert found["data"]["held_out"]["rmse"] == pytest.approx(NOISE, rel=0.3)
    assert any("beside gravity and a constant torque" in remark for remark in found["remarks"])
    named = [x for x in found["remarks"] if "constant torque" in x]
    assert all("or friction approached from one side: not to be told apart" in x for x in named)


def test_poses_are_counted_not_rows(learn, tmp_path):
    rng = np.random.default_rng(7)
    q = rng.uniform(-2.0, 2.0, (8, 2))
    tau = GRAVITY.torque(q) + rng.normal(size=q.shape)
    rows = np.repeat(np.arange(8), 25)
    path = tmp_path / "dwell.csv"
    write_csv(path, StaticSamples(q[rows], tau[rows]), ROBOT.joint_names)
    data = learn(tmp_path, path, "--symmetries", "none", "--learner", "trigonometric")["data"]
    assert (data["rows"], data["analytic"]["poses"], data["held_out"]["poses"]) == (200, 8, 8)
    assert data["held_out"]["rmse"] > 1.0
