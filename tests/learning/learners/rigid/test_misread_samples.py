"""Recordings read wrongly: what makes a rigid chain of them is found, and nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.misread_samples import other_reading
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from tests.learning.learners.rigid.random_chains import random_chain, random_poses

NAMES = ("a", "b", "c")


def exchanged(values, i, j):
    """Two columns exchanged."""
    order = list(range(values.shape[1]))
    order[i], order[j] = j, i
    return values[:, order]


def samples(seed, noise=0.0):
    """A chain of three joints in random directions, and its torques."""
    rng = np.random.default_rng(seed)
    q = random_poses(rng, 14, 3)
    torque = random_chain(rng, 3).torque(q)
    return q, torque + noise * rng.normal(size=q.shape)


READINGS = {
    "the angles are in degrees": lambda q, tau: (np.rad2deg(q), tau),
    "the torque of b has the wrong sign": lambda q, tau: (q, tau * [1.0, -1.0, 1.0]),
    "the torque columns of a and c are swapped": lambda q, tau: (q, exchanged(tau, 0, 2)),
    "the angle columns of b and c are swapped": lambda q, tau: (exchanged(q, 1, 2), tau),
}


@pytest.mark.parametrize("reading", READINGS)
@given(st.integers(0, 10_000), st.booleans())
@settings(max_examples=6)
def test_the_mistake_is_found(reading, seed, noisy):
    noise = 0.02 if noisy else 0.0
    learner = RigidChain(torque_noise=noise or None, random_state=seed)
    q, tau = READINGS[reading](*samples(seed, noise))
    # columns of axes in random directions: exactly one reading fits
    assert other_reading(learner, q, tau, NAMES) == reading


@given(st.integers(0, 10_000))
@settings(max_examples=6)
def test_springs_are_no_mistake_of_reading(seed):
    q, tau = samples(seed)
    assert other_reading(RigidChain(random_state=seed), q, tau + 2.0 * q, NAMES) is None
