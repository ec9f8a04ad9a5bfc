"""``learn --data`` without a robot file: from a CSV to a controller, the kinematics unknown."""

import json

import numpy as np
import pinocchio as pin
import pytest

from isotorque.cli.main import status
from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.saved_models import load_model
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.export.compiled_source import build, call, needs_cc

JOINTS = ("base", "shoulder", "upper", "elbow", "lower", "wrist", "hand")


def recording(path, poses, noise=0.0, seed=0, change=lambda q, tau: (q, tau), robot="panda"):
    """Poses of an arm and torques by Pinocchio alone, under other names; its model."""
    model = load_robot(robot).model
    rng, data = np.random.default_rng(seed), model.createData()
    q, joints = rng.uniform(-2.5, 2.5, (poses, model.nq)), JOINTS[: model.nq]
    tau = np.array([pin.computeGeneralizedGravity(model, data, x) for x in q])
    q, tau = change(q, tau + noise * rng.normal(size=q.shape))
    header = ",".join([f"{j}.q" for j in joints] + [f"{j}.tau" for j in joints])
    rows = "\n".join(",".join(map(repr, row)) for row in np.hstack([q, tau]).tolist())
    path.write_text(f"{header}\n{rows}\n")
    return model


def isotorque(*arguments):
    return status([str(a) for a in arguments])


@needs_cc
def test_three_commands_from_a_recording_to_a_controller(tmp_path, capsys):
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    model = recording(data, 8)
    assert isotorque("learn", "--data", data, "--out", out) == 0
    assert "explains all samples to rounding" in capsys.readouterr().out
    assert isotorque("relations", out) == 0
    said = capsys.readouterr().out
    assert "2 relations" in said
    assert "do not contradict" in said
    assert isotorque("export", out, "--c", tmp_path / "gravity.c") == 0
    _, library = build((tmp_path / "gravity.c").read_text(), tmp_path)
    q = np.random.default_rng(1).uniform(-3, 3, (200, 7))
    pinocchio = model.createData()
    expected = np.array([pin.computeGeneralizedGravity(model, pinocchio, x) for x in q])
    assert np.abs(call(library, q) - expected).max() < 1e-9


def test_noise_is_stated_or_estimated_and_errors_are_told(tmp_path, capsys):
    data = tmp_path / "poses.csv"
    recording(data, 25, noise=0.05)
    for options, verdict in (((), "left out"), (("--torque-noise", 0.05), "was stated")):
        out = tmp_path / str(len(options))
        assert isotorque("learn", "--data", data, "--out", out, "--json", *options) == 0
        found = json.loads(capsys.readouterr().out)
        assert verdict in found["verdict"]
        assert found["joints"] == list(JOINTS)
        assert found["standard_error"]["rms"] < 0.05
        document = json.loads((out / "relations.json").read_text())
        assert document["order"] == found["relations"]
        assert max(document["relations"][1]["bound"]) > 0.01


def test_a_spring_becomes_part_of_the_model(tmp_path, capsys):
    """Named, predicted, exported, and taken off where relations are judged."""
    data, fresh, out = tmp_path / "poses.csv", tmp_path / "fresh.csv", tmp_path / "out"
    for file, seed in ((data, 0), (fresh, 1)):
        recording(file, 30, 0.02, seed, lambda q, tau: (q, tau + [0, 2, 0] * q), "3r")
    assert isotorque("learn", "--data", data, "--out", out, "--torque-noise", 0.02) == 0
    said = capsys.readouterr().out
    assert (
        "beside gravity, part of the model: a torque that grows with its angle (a spring)" in said
    )
    assert "springs of (0, 2, 0) N m/rad" in said
    learner = load_model(out).learner
    q = np.random.default_rng(2).uniform(-3.0, 3.0, (100, 3))
    true = GravityModel(load_robot("3r")).torque(q) + [0, 2, 0] * q
    assert np.abs(learner.predict(q) - true).max() < 0.3
    np.testing.assert_allclose(evaluate(torque_form(learner), q), learner.predict(q), atol=1e-9)
    assert learner.chain_.correction.rate[1] == pytest.approx(2.0, abs=0.02)
    document = json.loads((out / "relations.json").read_text())
    assert document["order"] == 16
    for relation in document["relations"]:
        assert relation["correction"]["rate"] == learner.chain_.correction.rate.tolist()
    for what in (out, out / "relations.json"):
        assert isotorque("verify", what, "--data", fresh) == 0


@pytest.mark.parametrize(
    ("learner", "rate"), [(None, 0.0), (None, 1.5), ("parametric", 0.0), ("trigonometric", 0.0)]
)
def test_a_robot_file_judges_gravity_alone(learner, rate, tmp_path, capsys):
    """It has neither the constants nor the springs that a model holds, nor has it to have them."""
    robot = load_robot("2r")
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (40, 2))
    tau = GravityModel(robot).torque(q) + [0.0, 2.0] + [rate, 0.0] * q
    tau += 0.02 * np.random.default_rng(1).normal(size=q.shape)
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    write_csv(data, StaticSamples(q, tau), robot.joint_names)
    more = ["2r", "--learner", learner] if learner else []
    assert isotorque("learn", *more, "--data", data, "--out", out) == 0
    capsys.readouterr()
    model = out / "model.json"
    # beside the model lie the relations of a chain, with corrections: of gravity they are judged
    for what in (model, out) if learner is None else (model,):
        assert isotorque("verify", what, "--robot", "2r", "--tolerance", 0.2) == 0
    said = capsys.readouterr().out
    assert "gravity alone, less c" in said
    assert "that the model holds beside it: torque RMSE of each joint" in said
    assert isotorque("verify", model, "--robot", "3r") == 2


def test_too_few_poses_say_how_many_are_missing_and_leave_nothing(tmp_path, capsys):
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 3)
    assert isotorque("learn", "--data", data, "--out", out) == 1
    assert "1 more poses: 3 different ones were given, 4 are needed" in capsys.readouterr().out
    assert not out.exists()


@pytest.mark.parametrize(
    ("robot", "change", "reading"),
    [
        ("panda", lambda q, tau: (np.rad2deg(q), tau), "the angles are in degrees"),
        ("panda", lambda q, tau: (tau, q), "the columns of angles and torques are exchanged"),
        ("3r", lambda q, tau: (q, tau + 3.0 * np.sin(2.0 * q)), None),
    ],
    ids=["degrees", "exchanged", "cable"],
)
def test_what_is_no_rigid_chain_is_not_a_model(robot, change, reading, tmp_path, capsys):
    """What it would be if it were read otherwise is said; a cable is no reading."""
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 20, noise=0.02, change=change, robot=robot)
    options = ("--learner", "rigid-chain") if reading is None else ()
    assert isotorque("learn", "--data", data, "--out", out, "--torque-noise", 0.02, *options) == 1
    said = capsys.readouterr().out
    assert "no chain that was found explains" in said
    assert ("explains all of them if" in said) == (reading is not None)
    assert (reading or "") in said
    assert not out.exists()


def test_what_is_beside_the_chain_is_learned_by_processes_and_named(tmp_path, capsys):
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 30, 0.02, 0, lambda q, tau: (q, tau + [0, 2, 0] * np.sin(2.0 * q)), "3r")
    assert isotorque("learn", "--data", data, "--out", out) == 0
    said = capsys.readouterr().out
    assert "a rigid chain with Gaussian processes predicts samples that were left out" in said
    assert "beside gravity: a torque of twice the angle (a cable, a bent link) of 2" in said
    assert " on shoulder" in said
    assert "; rigid-chain " in said
    assert not (out / "relations.json").exists()
    q = np.random.default_rng(2).uniform(-2.0, 2.0, (100, 3))
    true = GravityModel(load_robot("3r")).torque(q) + [0, 2, 0] * np.sin(2.0 * q)
    assert np.sqrt(np.mean((load_model(out).learner.predict(q) - true) ** 2)) < 0.2


def test_errors_at_poses_left_out_are_those_of_further_poses(tmp_path, capsys):
    data = tmp_path / "poses.csv"
    recording(data, 40, 0.05, 3, robot="3r")
    assert isotorque("learn", "--data", data, "--out", tmp_path / "out", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    q = np.random.default_rng(5).uniform(-3.0, 3.0, (400, 3))
    fresh = GravityModel(load_robot("3r")).torque(q)
    fresh = fresh + 0.05 * np.random.default_rng(6).normal(size=q.shape)
    error = np.sqrt(np.mean((load_model(tmp_path / "out").learner.predict(q) - fresh) ** 2))
    assert found["learner"] == "rigid-chain"
    assert 0.8 < found["held_out"]["rmse"] / error < 1.25


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--known-gain", "elbow=2"), "--unknown-gains"),
        (("--unknown-gains", "--known-gain", "nose=2"), "base, shoulder"),
        (("--unknown-gains", "--known-gain", "elbow=0"), "other than 0"),
        (("--unknown-gains", "--known-gain", "elbow=1", "--known-gain", "elbow=2"), "one gain"),
        (("--unknown-gains", "--learner", "rigid-chain+gaussian-process"), "gains as known"),
        (("--learner", "rigid-chain+gaussian-process", "--angle-noise", "0.1"), "exact"),
        (("--unknown-gains", "--known-load", "hand=2"), "--loaded FILE.csv"),
        (("--unknown-gains", "--loaded", "poses.csv"), "--known-load JOINT=NM"),
        (("--known-load", "hand=2", "--loaded", "poses.csv"), "--unknown-gains together"),
        (("--unknown-gains", "--known-load", "nose=2", "--loaded", "poses.csv"), "base, shoulder"),
        (("--unknown-gains", "--known-load", "hand=-2", "--loaded", "poses.csv"), "positive"),
    ],
)
def test_gains_that_cannot_be_used_are_one_line(options, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    recording(tmp_path / "poses.csv", 8)
    data = ("--data", tmp_path / "poses.csv", "--out", tmp_path / "x")
    assert isotorque("learn", *data, *options) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert len(error.splitlines()) == 1


def test_a_known_load_fixes_the_common_gain(tmp_path, capsys):
    """Motor currents of the panda, then 2 kg held 0.1 m from the axis of its hand."""
    gains = np.array([0.7, 1.9, 1.1, 0.6, 1.4, 2.0, 0.9])
    rng = np.random.default_rng(2)
    files = tmp_path / "empty.csv", tmp_path / "loaded.csv"
    for file, load in zip(files, ((), "2,0,0.1,0.05@panda_link7"), strict=True):
        q = rng.uniform(-2.5, 2.5, (14, 7))
        torque = GravityModel(load_robot("panda", payload=load)).torque(q)
        write_csv(file, StaticSamples(q, gains * torque), JOINTS)
    common = ("--data", files[0], "--out", tmp_path / "out", "--unknown-gains", "--json")
    assert isotorque("learn", *common) == 0
    (alone,) = (g for g in json.loads(capsys.readouterr().out)["gains"] if len(g["gains"]) > 1)
    assert not alone["common_factor_known"]
    load = ("--loaded", files[1], "--known-load", f"hand={2 * 9.81 * 0.1}")
    assert isotorque("learn", *common, *load) == 0
    (found,) = (g for g in json.loads(capsys.readouterr().out)["gains"] if len(g["gains"]) > 1)
    assert found["common_factor_known"]
    for name, gain in found["gains"].items():
        assert gain == pytest.approx(gains[JOINTS.index(name)], rel=1e-4)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--out", "x"), "ROBOT is missing"),
        (("--out", "x", "--data", "poses.csv", "--learner", "network"), "rigid-chain"),
        (("--out", "x", "--data", "poses.csv", "--samples", "8"), "--samples with no ROBOT"),
        (("--out", "x", "--data", "poses.csv", "--lock", "elbow"), "--lock"),
        (("--out", "x", "--data", "none.csv"), "none.csv"),
        (("--out", "x", "--data", "wrong.csv"), "header"),
        (("--out", "x", "--data", "poses.csv", "--torque-noise", "-1"), "torque_noise"),
    ],
)
def test_bad_input_is_one_line(options, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    recording(tmp_path / "poses.csv", 8)
    (tmp_path / "wrong.csv").write_text("angle,torque\n0,1\n")
    assert isotorque("learn", *options) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("error: ")
    assert words in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize(("poses", "noise"), [(3, 0.0), (5, 0.0), (4, 0.02)])
def test_the_poses_that_are_proposed_are_the_ones_that_were_missing(poses, noise, tmp_path, capsys):
    """Five in a plane of two joints; three and four anywhere."""
    data = tmp_path / "poses.csv"
    model = recording(data, poses, noise=noise)
    q, tau = np.split(np.loadtxt(data, delimiter=",", skiprows=1), 2, axis=1)
    gravity = GravityModel(load_robot("panda"))
    if poses == 5:
        q[:, 2:] = q[0, 2:]
        tau = gravity.torque(q)
        write_csv(data, StaticSamples(q, tau), JOINTS)
    options = ("--data", data, "--out", tmp_path / "out", "--json")
    options += ("--torque-noise", noise) if noise else ()
    for _ in range(3):
        code = isotorque("learn", *options)
        found = json.loads(capsys.readouterr().out)
        if code == 0:
            break
        assert 0 < found["numbers_known"] <= found["numbers_of_a_chain"] == 27
        more = np.array(found["next_poses"])
        assert more.shape[1] == model.nq
        widest = np.maximum(np.ptp(q, axis=0), 1.0)
        assert np.all(np.abs(more - 0.5 * (q.min(axis=0) + q.max(axis=0))) <= widest / 2 + 1e-9)
        q = np.vstack([q, more])
        tau = np.vstack(
            [tau, gravity.torque(more) + noise * np.random.default_rng(1).normal(size=more.shape)]
        )
        write_csv(data, StaticSamples(q, tau), JOINTS)
    assert code == 0, found


def test_poses_to_take_are_printed(tmp_path, capsys):
    data = tmp_path / "poses.csv"
    recording(data, 3)
    assert isotorque("learn", "--data", data, "--out", tmp_path / "out") == 1
    said = capsys.readouterr().out.splitlines()
    assert "known already: 21 of the 27 numbers" in said[-3]
    assert said[-2] == ",".join(f"{j}.q" for j in JOINTS)
    assert len(said[-1].split(",")) == 7


@pytest.mark.parametrize(
    ("cause", "said", "kind"),
    [
        (lambda tau: tau + 0.8 * np.eye(7)[3], "a constant torque of +0.", "offset"),
        (lambda tau: tau * (1.0 - 2.0 * np.eye(7)[1]), "a wrong sign", "sign"),
        (lambda tau: tau * (1.0 + 0.3 * np.eye(7)[3]), "a gain of 1.", "gain"),
    ],
)
def test_constants_gains_and_signs_become_part_of_the_model(cause, said, kind, tmp_path, capsys):
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 40, noise=0.05, change=lambda q, tau: (q, cause(tau)))
    assert isotorque("learn", "--data", data, "--out", out, "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["beside_gravity"].startswith(said)
    (found,) = document["causes"]
    assert found["kind"] == kind
    assert found["joint"] in JOINTS
    model = load_model(out)
    assert [str(c.kind) for c in model.learner.causes_] == [kind]  # kept with the model
    q = np.random.default_rng(7).uniform(-2.0, 2.0, (200, 7))
    truth = cause(GravityModel(load_robot("panda")).torque(q))
    assert np.abs(model.learner.predict(q) - truth).max() < 0.3


@pytest.mark.parametrize(
    ("torque", "words"), [(0.0, "gravity does not reach"), (5.0, "sensor that does not read")]
)
def test_a_torque_that_never_changes_is_named(torque, words, tmp_path, capsys):
    def stuck(q, tau):
        tau[:, 1] = torque
        return q, tau

    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 10, change=stuck, robot="3r")
    assert isotorque("learn", "--data", data, "--out", out) == 1
    said = capsys.readouterr().out
    assert f"shoulder: torque {torque:g} N m in every pose" in said
    assert words in said
    assert not out.exists()


def test_torques_that_are_the_same_in_all_poses_are_no_recording(tmp_path, capsys):
    data, out = tmp_path / "poses.csv", tmp_path / "out"
    recording(data, 10, change=lambda q, tau: (q, np.tile(tau[:1], (10, 1))))
    assert isotorque("learn", "--data", data, "--out", out) == 2
    assert "the same in all 10 rows, though angles differ" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(("poses", "code"), [(6, 0), (3, 2)])
def test_few_poses_beside_a_robot(poses, code, tmp_path, capsys):
    """Six are enough though parts of them are not; of three it is said how many are missing."""
    rng, robot = np.random.default_rng(0), load_robot("panda")
    model, data = robot.model, robot.model.createData()
    q = rng.uniform(-2.5, 2.5, (poses, 7))
    tau = np.array([pin.computeGeneralizedGravity(model, data, x) for x in q])
    file = tmp_path / "arm.csv"
    write_csv(file, StaticSamples(q, tau), robot.joint_names)
    options = ("--data", file, "--learner", "rigid-chain", "--out", tmp_path / "out", "--quiet")
    assert isotorque("learn", "panda", *options) == code
    captured = capsys.readouterr()
    if code == 0:
        assert isotorque("verify", tmp_path / "out", "--robot", "panda") == 0
    else:
        assert captured.err.count("\n") == 1
        assert "1 more poses" in captured.err


def test_a_constant_torque_is_no_noise_and_relations_say_what_they_speak_of(tmp_path, capsys):
    rng = np.random.default_rng(3)
    q = rng.uniform(-2, 2, (80, 2))
    lower = 6.13 * np.cos(q.sum(axis=1))
    tau = np.stack([18.39 * np.cos(q[:, 0]) + lower, lower + 0.5], axis=1)
    tau += 0.05 * rng.normal(size=tau.shape)
    write_csv(tmp_path / "poses.csv", StaticSamples(q, tau), ["q1", "q2"])
    assert isotorque("learn", "--data", tmp_path / "poses.csv", "--out", tmp_path) == 0
    out = capsys.readouterr().out
    assert "hold of gravity, of the measured torque with corrections" in out
    assert "or friction approached from one side: not to be told apart without" in out
    document = json.loads((tmp_path / "relations.json").read_text())
    for relation in document["relations"]:
        np.testing.assert_allclose(relation["correction"]["constant"], [0.0, 0.5], atol=0.05)
    assert isotorque("verify", tmp_path / "relations.json", "--data", tmp_path / "poses.csv") == 0


def test_rows_of_one_pose_are_one_sample(tmp_path, capsys):
    rng = np.random.default_rng(4)
    poses = rng.uniform(-2, 2, (8, 2))
    lower = 6.13 * np.cos(poses.sum(axis=1))
    tau = np.stack([18.39 * np.cos(poses[:, 0]) + lower, lower], axis=1)
    tau += np.sign(rng.normal(size=tau.shape)) * [1.2, 0.4]  # stiction: one value a pose
    rows = np.repeat(poses, 25, axis=0) + 1e-5 * rng.normal(size=(200, 2))
    torques = np.repeat(tau, 25, axis=0) + 0.02 * rng.normal(size=(200, 2))
    write_csv(tmp_path / "poses.csv", StaticSamples(rows, torques), ["q1", "q2"])
    assert isotorque("learn", "--data", tmp_path / "poses.csv", "--out", tmp_path / "out") == 1
    assert "200 samples in 8 poses" in capsys.readouterr().out
    assert not (tmp_path / "out" / "model.json").exists()
