"""A chain found while samples come in: early, confirmed by later samples, refused where none is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.chain_watch import CHECKS, ChainWatch
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import KINDS, random_chain


def watched(torque, q, **options):
    watch = ChainWatch(q.shape[1], **options)
    for pose in q:
        watch.add(pose, torque(pose[None])[0])
    return watch


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 6), st.sampled_from(KINDS), st.integers(0, 2**20))
def test_a_chain_is_known_after_few_poses_and_right_everywhere(n, kind, seed):
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n, kind)
    known = watched(chain.torque, rng.uniform(-3, 3, (40, n))).knowledge()
    assert known.learner is not None, known.said
    assert known.known_after <= 12
    assert known.later >= CHECKS
    anywhere = rng.uniform(-np.pi, np.pi, (100, n))
    truth = chain.torque(anywhere)
    assert np.abs(known.learner.predict(anywhere) - truth).max() <= 1e-8 * np.abs(truth).max()


@pytest.mark.parametrize("robot", ["2r", "3r", "ur5", "panda"])
def test_same_samples_same_chain_bit_for_bit(robot):
    gravity = GravityModel(load_robot(robot))
    q = np.random.default_rng(3).uniform(-2, 2, (30, gravity.n))
    first, second = (watched(gravity.torque, q).knowledge() for _ in range(2))
    assert first.known_after == second.known_after
    np.testing.assert_array_equal(first.learner.predict(q), second.learner.predict(q))


def test_a_spring_is_no_chain_and_that_is_said():
    gravity = GravityModel(load_robot("3r"))
    q = np.random.default_rng(0).uniform(-3, 3, (60, 3))
    known = watched(lambda q: gravity.torque(q) + 8.0 * q, q).knowledge()
    assert known.learner is None
    assert known.known_after is None
    assert "no rigid chain" in known.said


def test_one_contradicting_sample_undoes_a_chain_that_was_confirmed():
    gravity = GravityModel(load_robot("2r"))
    q = np.random.default_rng(0).uniform(-3, 3, (40, 2))
    watch = watched(gravity.torque, q)
    assert watch.confirmed is not None
    watch.add([0.11, 0.87], gravity.torque([[0.11, 0.87]])[0] + [0.0, 0.5])
    assert watch.confirmed is None
    assert watch.knowledge().learner is None


def test_it_is_confirmed_by_later_samples_only():
    gravity = GravityModel(load_robot("panda"))
    watch = ChainWatch(7)
    for pose in np.random.default_rng(0).uniform(-2, 2, (40, 7)):
        watch.add(pose, gravity.torque(pose[None])[0])
        found = watch.fits()
        later = watch.poses - found[-1][0] if found else 0
        assert (watch.confirmed is not None) == (later >= CHECKS)


def test_poses_that_hardly_differ_count_once():
    gravity = GravityModel(load_robot("2r"))
    q = 1.0 + 1e-4 * np.arange(50)[:, None] * [1.0, -1.0]
    watch = watched(gravity.torque, q)
    assert watch.poses == 1
    assert "too few" in watch.knowledge().said


def test_joints_that_hold_no_torque_and_never_move_are_taken_free_and_named():
    gravity = GravityModel(load_robot("ur5"))
    rng = np.random.default_rng(0)
    q = rng.uniform(-2, 2, (40, 6)) * [0, 1, 1, 1, 0, 0]
    watch = ChainWatch(6)
    watch.unloaded[[0, 4, 5]] = True
    for pose in q:
        watch.add(pose, gravity.torque(pose[None])[0])
    known = watch.knowledge()
    assert known.taken_free == (0, 4, 5)
    anywhere = rng.uniform(-3, 3, (50, 6))
    assert np.abs(known.learner.predict(anywhere) - gravity.torque(anywhere)).max() < 1e-7
    # without that, such samples leave open what gravity does elsewhere
    assert watched(gravity.torque, q).knowledge().learner is None


def test_noise_is_estimated_and_later_samples_agree_within_it():
    gravity = GravityModel(load_robot("3r"))
    rng = np.random.default_rng(5)
    q = rng.uniform(-3, 3, (80, 3))
    known = watched(lambda x: gravity.torque(x) + 0.05 * rng.normal(size=x.shape), q).knowledge()
    assert known.learner is not None, known.said
    anywhere = rng.uniform(-3, 3, (200, 3))
    error = known.learner.predict(anywhere) - gravity.torque(anywhere)
    assert np.sqrt(np.mean(error**2)) < 0.05
