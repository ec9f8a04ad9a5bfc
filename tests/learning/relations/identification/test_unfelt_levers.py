"""A joint that held no torque carries nothing, or was balanced at every sample."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.identification.unfelt_levers import unfelt_lever
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot


@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("seed", range(3))
def test_a_forearm_that_always_hangs_may_have_a_lever(noise, seed):
    rng = np.random.default_rng(seed)
    first = rng.uniform(-np.pi, np.pi, 30)
    q = np.stack([first, -np.pi / 2 - first], axis=1)
    tau = GravityModel(load_robot("2r")).torque(q) * [1.0, 0.0] + noise * rng.normal(size=q.shape)
    learner = RigidChain().fit(q, tau)
    # nothing in exact samples speaks against a link without one
    assert learner.verdict_.accepted or noise
    assert not learner.verdict_.accepted or unfelt_lever(learner.fit_) == 1


@pytest.mark.parametrize("name", ["ur5", "panda", "2r", "3r"])
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_poses_anywhere_would_have_felt_it(name, noise):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (20, gravity.n))
    if name == "ur5" and not noise:
        q[:, 5] = 0.3  # the others turn the last joint about all the same
    learner = RigidChain().fit(q, gravity.torque(q) + noise * rng.normal(size=q.shape))
    assert learner.verdict_.accepted
    assert unfelt_lever(learner.fit_) is None
