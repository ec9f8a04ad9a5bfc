"""The learner: scikit-learn's manners, saved and loaded, warm starts, calibrated errors."""

import inspect
import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
from sklearn.base import clone

from isotorque.learning.files.saved_models import SavedModel, load_model, save_model
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import random_poses

NAMES = tuple("abcdefg")


def measured(name, poses, seed, noise=0.0):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(seed)
    q = random_poses(rng, poses, gravity.n)
    return gravity, q, gravity.torque(q) + noise * rng.normal(size=q.shape)


def test_it_knows_nothing_of_the_robot():
    """Told n and nothing else: no robot in its settings, none reachable by its imports."""
    assert not {"robot", "tree", "urdf"} & set(inspect.signature(RigidChain).parameters)
    script = (
        "import sys, isotorque.learning.learners.rigid.rigid_chain as _; "
        "print([m for m in sys.modules if m.startswith(('pinocchio', 'casadi', "
        "'isotorque.symbolic.robots', 'isotorque.symbolic.gravity'))])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    assert done.stdout.decode().strip() == "[]"


def test_what_is_not_accepted_is_neither_predicted_nor_saved(tmp_path):
    _, q, torque = measured("panda", 3, 0)
    learner = RigidChain(max_starts=10).fit(q, torque)
    assert learner.verdict_ is FitStatus.TOO_FEW
    for use in (learner.predict, learner.jacobian):
        with pytest.raises(NotAccepted, match=r"not accepted.*more poses") as refused:
            use(q)
        assert refused.value.verdict is FitStatus.TOO_FEW
    with pytest.raises(InputError, match="not accepted"):
        save_model(SavedModel(learner, "panda", "", NAMES, {}), tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"torque_noise": 0.05},
        {"torque_noise": [0.05] * 6, "angle_noise": 1e-4},
        {"torque_noise": np.full(6, 0.05), "unknown_gains": True, "unknown_offsets": True},
        {"unknown_gains": True, "known_gains": [None, 2.0, None, None, None, None]},
    ],
)
def test_saved_models_are_the_same_to_the_last_bit(settings, tmp_path):
    _, q, torque = measured("ur5", 25, 1, 0.05)
    learner = RigidChain(**settings).fit(q, torque)
    save_model(SavedModel(learner, "ur5", "", NAMES[:6], {}), tmp_path)
    back = load_model(tmp_path).learner
    asked = random_poses(np.random.default_rng(2), 5, 6)
    np.testing.assert_array_equal(back.predict(asked), learner.predict(asked))
    np.testing.assert_allclose(back.standard_error(asked), learner.standard_error(asked), rtol=1e-3)
    assert back.verdict_ == learner.verdict_
    assert back.gain_groups_ == learner.gain_groups_
    json.dumps(learner.parameters())
    more, more_torque = measured("ur5", 5, 3, 0.05)[1:]
    for twin in (learner, back, pickle.loads(pickle.dumps(learner))):
        twin.partial_fit(more, more_torque)
        assert twin.n_samples_seen_ == 30
    np.testing.assert_allclose(back.predict(asked), learner.predict(asked), atol=1e-4)


def test_more_samples_are_learned_from_the_last_chain():
    gravity, q, torque = measured("panda", 40, 4, 0.05)
    learner = RigidChain(torque_noise=0.05, window=30).fit(q[:10], torque[:10])
    for k in range(10, 40):
        learner.partial_fit(q[k : k + 1], torque[k : k + 1])
        assert learner.verdict_.accepted
        assert learner.fit_.starts == 0  # the last solution was good enough
    assert len(learner.fit_.samples.q) == 30
    test = random_poses(np.random.default_rng(5), 200, 7)
    error = np.sqrt(np.mean((learner.predict(test) - gravity.torque(test)) ** 2))
    assert error < 0.05


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize(("name", "poses"), [("2r", 12), ("ur5", 20), ("panda", 20)])
def test_standard_errors_are_calibrated(name, poses, stated):
    inside, within_three = [], []
    for seed in range(20):
        gravity, q, torque = measured(name, poses, seed, 0.05)
        learner = RigidChain(torque_noise=0.05 if stated else None).fit(q, torque)
        asked = random_poses(np.random.default_rng(99), 60, gravity.n)
        truth = gravity.torque(asked)
        loaded = np.abs(truth).max(axis=0) > 1e-9
        z = np.abs(learner.predict(asked) - truth) / learner.standard_error(asked)
        inside.append(np.mean(z[:, loaded] < 1.645))
        within_three.append(np.mean(z[:, loaded] < 3.0))
    # errors from estimated noise are widened for three of them: one covers more than it must
    assert 0.82 < np.mean(inside) < (0.96 if stated else 0.99)
    assert np.mean(within_three) > 0.98


def test_gains_are_known_relative_to_each_other():
    gravity, q, torque = measured("panda", 30, 6)
    gains = np.array([3.0, 0.5, 1.5, 0.8, 1.2, 2.0, 0.7])
    learner = RigidChain(unknown_gains=True).fit(q, gains * torque)
    (group,) = [g for g in learner.gain_groups_ if len(g.joints) > 1]
    assert not group.scale_known
    joints = list(group.joints)
    ratio = learner.chain_.gains[joints] / gains[joints]
    assert np.ptp(ratio) < 1e-9
    # one known gain fixes the common factor
    known = [None] * 7
    known[3] = 0.8
    fixed = RigidChain(unknown_gains=True, known_gains=known).fit(q, gains * torque)
    np.testing.assert_allclose(fixed.chain_.gains[joints], gains[joints], rtol=1e-8)
    assert any(g.scale_known for g in fixed.gain_groups_)
    true = fixed.chain_.true_chain().torque(q)
    np.testing.assert_allclose(true[:, 1:], gravity.torque(q)[:, 1:], atol=1e-7)


def currents(gains, seed=3):
    """Torques of ur5 in units of its own at every joint, noise in proportion."""
    _, q, torque = measured("ur5", 40, seed, 0.05)
    return q, torque * gains


def test_gains_that_are_known_are_no_causes():
    gains = np.array([1.0, 40.0, -30.0, 1.0, 1.0, 1.0])
    q, torque = currents(gains)
    known = RigidChain(unknown_gains=True, known_gains=list(gains)).fit(q, torque)
    assert known.verdict_.accepted
    assert known.diagnosis().causes == ()
    assert known.symmetries().group.order > 1


def test_a_gain_other_than_the_known_one_is_named_relative_to_it():
    gains = np.array([1.0, 40.0, 20.0, 1.0, 1.0, 1.0])
    q, torque = currents(gains * [1.0, 1.0, 1.2, 1.0, 1.0, 1.0])
    noise = [0.05 * abs(g) for g in gains]
    wrong = RigidChain(unknown_gains=True, known_gains=list(gains), torque_noise=noise)
    wrong.fit(q, torque)
    assert wrong.verdict_ is FitStatus.MISFIT
    (cause,) = wrong.shown_causes()
    assert (Kind.GAIN, 2) in cause.rivals  # of two coupled joints only the ratio is known
    ratio = cause.size[0] if cause.joint == 2 else 1.0 / cause.size[0]
    assert ratio == pytest.approx(1.2, rel=0.01)
    mended = wrong.with_causes()
    assert mended.verdict_.accepted
    assert mended.causes_ == (cause,)
    kept = 1 if cause.joint == 2 else 2
    assert mended.chain_.gains[kept] == gains[kept]
    found = mended.chain_.gains[2] / mended.chain_.gains[1]
    assert found == pytest.approx(0.6, rel=0.01)


def test_causes_of_an_arm_that_is_no_chain_are_not_shown():
    """It comes nearer to a chain with any cause: that makes none of it."""
    _, q, torque = measured("2r", 60, 5)
    rest = np.sin(3.0 * q[:, :1] - q[:, 1:]) * [1.0, 0.4]
    added = torque + rest + [0.0, 3.0]
    rough = RigidChain().fit(q, added)
    assert rough.verdict_ is FitStatus.MISFIT
    assert rough.diagnosis().causes
    assert rough.shown_causes() == ()
    assert rough.with_causes() is None


def test_of_too_few_samples_no_causes_are_shown():
    _, q, torque = measured("panda", 3, 0)
    assert RigidChain(max_starts=10).fit(q, torque).shown_causes() == ()


def test_a_sign_is_a_gain():
    gravity, q, torque = measured("panda", 30, 6)
    torque[:, 3] *= -1.0
    learner = RigidChain(unknown_gains=True).fit(q, torque)
    test = random_poses(np.random.default_rng(1), 50, 7)
    expected = gravity.torque(test) * np.where(np.arange(7) == 3, -1.0, 1.0)
    assert np.abs(learner.predict(test) - expected).max() < 1e-7
    assert learner.chain_.gains[3] * learner.chain_.gains[2] < 0


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"parents": [-1, 2, 0]}, "parents"),
        ({"parents": [-1]}, "parents"),
        ({"torque_noise": -1.0}, "torque_noise"),
        ({"angle_noise": [0.1, 0.1]}, "angle_noise"),
        ({"unknown_offsets": [True, False]}, "unknown_offsets"),
        ({"unknown_springs": 5}, "unknown_springs"),
        ({"unknown_springs": [True, False]}, "unknown_springs"),
        ({"max_starts": 0}, "max_starts"),
        ({"window": 0.5}, "window"),
        ({"known_gains": [1.0, 1.0, 1.0]}, "known_gains"),
        ({"unknown_gains": True, "known_gains": [0.0, 1.0, 1.0]}, "known_gains"),
    ],
)
def test_settings_that_make_no_sense_are_refused(settings, field):
    _, q, torque = measured("3r", 8, 0)
    with pytest.raises(InputError, match=field):
        RigidChain(**settings).fit(q, torque)


def test_samples_that_make_no_sense_are_refused():
    _, q, torque = measured("3r", 8, 0)
    with pytest.raises(InputError, match="NaN"):
        RigidChain().fit(np.where(np.arange(3) == 1, np.nan, q), torque)
    with pytest.raises(InputError, match="one torque per joint"):
        RigidChain().fit(q, torque[:, :2])
    with pytest.raises(InputError, match="weight"):
        RigidChain().fit(q, torque, np.zeros(8))


def test_weights_and_clones():
    gravity, q, torque = measured("3r", 12, 0)
    wrong = torque.copy()
    wrong[3] += 5.0
    weights = np.where(np.arange(12) == 3, 0.0, 1.0)
    learner = clone(RigidChain()).fit(q, wrong, weights)
    assert learner.verdict_ is FitStatus.ROUNDING
    assert np.abs(learner.predict(q) - gravity.torque(q)).max() < 1e-9


def test_one_joint_takes_flat_torques():
    q = np.linspace(-3, 3, 7)
    learner = RigidChain().fit(q[:, None], 6.0 * np.cos(q + 0.2))
    assert learner.predict([[0.5]]).shape == (1,)
    assert abs(learner.predict([[0.5]])[0] - 6.0 * np.cos(0.7)) < 1e-9
