"""Models fitted again without some samples: nothing of these is left in them."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.near_fit import near_fit
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

GRAVITY = GravityModel(load_robot("2r"))


def recorded(seed, count=20):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (count, 2))
    beside = [0.0, 0.4] + 0.3 * q * [0.0, 1.0]
    return q, GRAVITY.torque(q) + beside + 0.05 * rng.normal(size=q.shape)


def with_causes(learner, q, tau):
    fitted = learner.fit(q, tau)
    return fitted.with_causes() or fitted if isinstance(fitted, RigidChain) else fitted


MAKERS = [
    lambda: RigidChain(),
    lambda: StaticRegressor("2r"),
    lambda: RigidChainProcess(starts=5),
]


@pytest.mark.parametrize("make", MAKERS, ids=["chain", "regressor", "process"])
def test_samples_that_are_left_out_have_no_say(make):
    """Two recordings that differ in the samples left out give the same fit to the others."""
    q, tau = recorded(0)
    kept = np.arange(20) < 16
    learner = with_causes(make(), q, tau)
    first = near_fit(learner).fit(q[kept], tau[kept]).predict(q[~kept])
    np.testing.assert_allclose(first, tau[~kept], atol=0.4)
    again = near_fit(learner)
    other = again.fit(q, tau).predict(q[~kept])
    assert np.abs(other - first).max() > 1e-4  # they had one when they were there
    np.testing.assert_allclose(
        again.fit(q[kept], tau[kept]).predict(q[~kept]), first, rtol=0, atol=1e-7
    )


@pytest.mark.parametrize("make", MAKERS, ids=["chain", "regressor", "process"])
def test_near_fits_of_all_samples_are_the_model(make):
    q, tau = recorded(1)
    learner = with_causes(make(), q, tau)
    near = near_fit(learner).fit(q, tau)
    far = np.random.default_rng(2).uniform(-2.0, 2.0, (50, 2))
    np.testing.assert_allclose(near.predict(far), learner.predict(far), atol=0.01)
