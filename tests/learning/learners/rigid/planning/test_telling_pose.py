"""Poses that an arm is sent to: they can be held, and they tell more than others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.planning.telling_pose import FARTHER, telling_pose
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

GRAVITY = GravityModel(load_robot("3r"))
HOME = np.array([0.0, -np.pi / 2, 0.0])
NOISE = 0.05


def samples(seed, count=15, spread=0.6, home=HOME):
    rng = np.random.default_rng(seed)
    q = home + rng.uniform(-spread, spread, (count, 3))
    return q, GRAVITY.torque(q) + NOISE * rng.normal(size=q.shape)


def chosen(seed, **more):
    q, torque = samples(seed)
    fit = RigidChain(max_starts=60).fit(q, torque).fit_
    return fit, q, torque, telling_pose(fit, q, torque, HOME, np.random.default_rng(seed), **more)


@pytest.mark.parametrize("seed", range(4))
def test_the_arm_can_hold_the_pose_and_has_not_been_much_nearer(seed):
    _, q, _, pose = chosen(seed)
    stiffness = GRAVITY.potential.to_float().hessian(pose[None])[0]
    assert np.linalg.eigvalsh(stiffness)[0] > 0.0
    reach = np.abs(q - HOME).max(axis=0)
    assert np.all(np.abs(pose - HOME) <= FARTHER * reach)
    assert np.any(np.abs(pose - HOME) > 0.8 * reach)


@pytest.mark.parametrize("seed", range(2))
def test_it_tells_more_than_a_pose_at_random(seed):
    """Of the torque anywhere, to which the samples are added."""
    fit, q, _, pose = chosen(seed)
    anywhere = np.random.default_rng(7).uniform(-np.pi, np.pi, (300, 3))
    rng = np.random.default_rng(8)

    def left(more):
        tried = np.concatenate([q, more])
        rows = fit.chain.torque(tried)
        return (
            RigidChain(max_starts=60, torque_noise=NOISE).fit(tried, rows).standard_error(anywhere)
        )

    others = [np.max(left(samples(rng.integers(1000), 1)[0])) for _ in range(4)]
    assert np.max(left(pose[None])) < np.median(others)


@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_what_was_refused_is_not_asked_for_again(seed):
    fit, q, torque, pose = chosen(0)
    refused = fit.chain.torque(pose[None])
    other = telling_pose(fit, q, torque, HOME, np.random.default_rng(seed), refused=refused)
    assert other is not None
    needed, size = fit.chain.torque(other[None]), np.abs(torque).max(axis=0)
    nearest = (np.abs(torque - needed) / size).max(axis=1).min()
    assert (np.abs(refused - needed) / size).max() > nearest


def test_none_is_known_where_home_is_not_stable():
    over = HOME + np.array([0.0, np.pi, 0.0])
    q, torque = samples(0, home=over)
    fit = RigidChain(max_starts=60).fit(q, torque).fit_
    assert telling_pose(fit, q, torque, over, np.random.default_rng(0)) is None
