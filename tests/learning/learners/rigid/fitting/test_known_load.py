"""A known load: the common factor of the gains, or why it is not known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.fitting.known_load import gain_from_load
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import random_poses

WEIGHT, LEVER = 9.81 * 1.5, 0.08
GAINS = np.array([0.7, 1.9, 1.1, 0.6, 1.4, 2.0, 0.9])


def arm(load=False, link=7):
    """Torques of the panda, with 1.5 kg at 0.08 m from the axis of a link."""
    if not load:
        return GravityModel(load_robot("panda"))
    offset = f"1.5,{LEVER},0,0.1@panda_link{link}"
    return GravityModel(load_robot("panda", payload=offset))


def fitted(noise, seed=0):
    rng = np.random.default_rng(seed)
    q = random_poses(rng, 40 if noise else 14, 7)
    torque = GAINS * arm().torque(q) + noise * rng.normal(size=q.shape)
    return RigidChain(unknown_gains=True, torque_noise=noise, random_state=seed).fit(q, torque)


@pytest.fixture(scope="module")
def exact():
    return fitted(0.0)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**20), st.integers(3, 12))
def test_the_gain_is_found_from_any_few_poses(exact, seed, poses):
    q = random_poses(np.random.default_rng(seed), poses, 7)
    found = gain_from_load(exact.fit_, q, GAINS * arm(load=True).torque(q), 6, WEIGHT * LEVER)
    assert found.gain == pytest.approx(GAINS[6], rel=1e-5)


def test_in_noise_it_is_within_its_standard_error():
    learner, rng = fitted(0.02), np.random.default_rng(5)
    replicas = learner.errors_.replicas[:30]
    q = random_poses(rng, 30, 7)
    torque = GAINS * arm(load=True).torque(q) + 0.02 * rng.normal(size=q.shape)
    found = gain_from_load(learner.fit_, q, torque, 6, WEIGHT * LEVER, replicas=replicas)
    assert abs(found.gain - GAINS[6]) < 3 * found.standard_error
    assert found.standard_error < 0.1 * GAINS[6]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda q, tau: (q, tau + 3.0 * q), "more weight alone"),
        (lambda q, tau: (q[:1], tau[:1]), "not determined"),
        (lambda q, tau: (q, GAINS * arm().torque(q)), "heavier load"),
    ],
    ids=["spring", "one pose", "no load"],
)
def test_what_is_no_known_load_is_refused(exact, change, words):
    q = random_poses(np.random.default_rng(1), 10, 7)
    q, torque = change(q, GAINS * arm(load=True).torque(q))
    with pytest.raises(InputError, match=words):
        gain_from_load(exact.fit_, q, torque, 6, WEIGHT * LEVER)


def test_a_load_farther_out_is_refused(exact):
    q = random_poses(np.random.default_rng(1), 10, 7)
    with pytest.raises(InputError, match="beyond joint 6"):
        gain_from_load(exact.fit_, q, GAINS * arm(load=True).torque(q), 5, WEIGHT * LEVER)
