"""Arms that are nearly rigid: what is beside the chain is learned, and said."""

import json
from functools import cache

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.saved_models import SavedModel, load_model, save_model
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import random_chain

QUICK = {"starts": 5}


@cache
def gravity(robot):
    return GravityModel(load_robot(robot))


def with_cables(robot, q, noise=0.0, seed=0, size=0.04):
    """Torques with a cable and a spring at every joint, of some shares of its largest torque."""
    exact = gravity(robot).torque(q)
    peak = np.abs(gravity(robot).torque(np.random.default_rng(9).uniform(-3, 3, (400, q.shape[1]))))
    peak = peak.max(axis=0)
    beside = size * peak * (np.sin(2.0 * q + 0.5) + 0.3 * q)
    return exact + beside + noise * np.random.default_rng(seed).normal(size=q.shape)


def poses(robot, count, seed=0, reach=2.0):
    return np.random.default_rng(seed).uniform(-reach, reach, (count, gravity(robot).n))


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


@pytest.mark.parametrize("robot", ["2r", "ur5"])
def test_it_errs_a_fifth_of_what_the_chain_alone_does(robot):
    q, fresh = poses(robot, 40), poses(robot, 300, seed=1)
    measured, true = with_cables(robot, q, 0.01), with_cables(robot, fresh)
    learner = RigidChainProcess(**QUICK).fit(q, measured)
    alone = RigidChain(unknown_offsets=True).fit(q, measured).fit_.chain
    error = learner.predict(fresh) - true
    assert rms(error) < 0.2 * rms(alone.torque(fresh) - true)
    assert learner.verdict_ is FitStatus.HELD_OUT
    assert 0.4 < learner.held_out_ / rms(error) < 2.5
    # three standard errors hold nearly everywhere, and are not idle
    certain = learner.standard_error(fresh)
    assert np.mean(np.abs(error) <= 3.0 * certain + 1e-9) > 0.97
    assert rms(certain) < 10.0 * rms(error)
    # the share of the torque that is beside the chain is some per cent where there is torque
    loaded = np.sqrt(np.mean(measured**2, axis=0)) > 1.0
    assert np.all((learner.process_share_[loaded] > 0.005) & (learner.process_share_[loaded] < 0.1))


def test_a_rigid_arm_is_a_chain_and_nothing_beside():
    q = poses("2r", 10)
    learner = RigidChainProcess().fit(q, gravity("2r").torque(q))
    assert learner.verdict_ is FitStatus.ROUNDING
    assert not learner.process_share_.any()
    fresh = poses("2r", 50, seed=1, reach=6.0)
    assert np.abs(learner.predict(fresh) - gravity("2r").torque(fresh)).max() < 1e-9
    assert not learner.standard_error(fresh).any()


def test_too_few_poses_are_refused_with_how_many_are_missing():
    q = poses("ur5", 8)
    learner = RigidChainProcess(**QUICK).fit(q, with_cables("ur5", q))
    assert learner.verdict_ is FitStatus.TOO_FEW
    assert "more poses" in learner.remark_
    with pytest.raises(NotAccepted, match="too few"):
        learner.predict(q)


def test_rows_of_one_pose_are_not_many_samples():
    q = poses("2r", 6)
    measured = np.repeat(with_cables("2r", q), 20, axis=0)
    measured += 0.01 * np.random.default_rng(0).normal(size=measured.shape)
    learner = RigidChainProcess(**QUICK).fit(np.repeat(q, 20, axis=0), measured)
    assert learner.verdict_ is FitStatus.TOO_FEW


def test_torques_that_depend_on_more_than_the_angles_are_refused():
    """Friction of random direction, a fifth of the torque."""
    q = poses("2r", 40)
    rng = np.random.default_rng(1)
    learner = RigidChainProcess(**QUICK).fit(
        q, with_cables("2r", q) + 4.0 * rng.choice([-1.0, 1.0], q.shape)
    )
    assert learner.verdict_ is FitStatus.MISFIT
    assert "friction" in learner.remark_
    with pytest.raises(NotAccepted):
        learner.standard_error(q)


def test_one_seed_one_model_also_after_saving(tmp_path):
    q = poses("2r", 25)
    measured = with_cables("2r", q, 0.02)
    first, second = (RigidChainProcess(**QUICK, random_state=3).fit(q, measured) for _ in range(2))
    fresh = poses("2r", 60, seed=1)
    np.testing.assert_array_equal(first.predict(fresh), second.predict(fresh))
    save_model(SavedModel(first, "2r", "", ("a", "b"), {}), tmp_path)
    back = load_model(tmp_path).learner
    np.testing.assert_array_equal(first.predict(fresh), back.predict(fresh))
    np.testing.assert_array_equal(first.standard_error(fresh), back.standard_error(fresh))
    assert back.held_out_ == first.held_out_


def test_joints_that_branch_are_told_by_their_parents():
    rng = np.random.default_rng(0)
    chain = random_chain(rng, 3, parents=[-1, 0, 0])
    q = rng.uniform(-2, 2, (30, 3))
    measured = chain.torque(q) + 0.2 * np.sin(2.0 * q)
    learner = RigidChainProcess([-1, 0, 0], **QUICK).fit(q, measured)
    fresh = rng.uniform(-2, 2, (100, 3))
    error = learner.predict(fresh) - chain.torque(fresh) - 0.2 * np.sin(2.0 * fresh)
    assert rms(error) < 0.05


@pytest.mark.parametrize(
    ("settings", "word"), [({"starts": 0}, "starts"), ({"torque_noise": -1.0}, "torque_noise")]
)
def test_settings_that_cannot_be_used_are_named(settings, word):
    q = poses("2r", 25)
    with pytest.raises(InputError, match=word):
        RigidChainProcess(**settings).fit(q, with_cables("2r", q, 0.1))


def test_the_command_line_learns_it_from_a_recording_alone(tmp_path, capsys):
    q, data, out = poses("2r", 30), tmp_path / "poses.csv", tmp_path / "out"
    write_csv(data, StaticSamples(q, with_cables("2r", q, 0.02)), ("shoulder", "elbow"))
    learner = ("--learner", "rigid-chain+gaussian-process")
    command = ["learn", "--data", str(data), "--out", str(out), *learner]
    assert status(command) == 0
    said = capsys.readouterr().out
    assert "of the torque (RMS) is beside the rigid chain" in said
    assert status([*command, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["accepted"]
    assert "relations" not in document
    assert len(document["process_share"]) == 2
    # nothing is claimed about symmetries, and that is said
    assert status(["relations", str(out)]) == 2
    assert "share no symmetries" in capsys.readouterr().err
