"""Torques that tell: an arm in noise knows its relations after few motions."""

from types import SimpleNamespace

import numpy as np
import pytest

import isotorque.learning.discovery.telling_torques as module
from isotorque.learning.discovery.telling_torques import WIDTH, TellingTorques
from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings
from isotorque.learning.learners.rigid.chain_watch import ChainWatch
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot


def discovered(telling, motions, seed=0, name="2r"):
    """Settled samples of the first motions of a discovery in noise."""
    noise = SensorNoise(float(np.deg2rad(0.1)), 0.05)
    arm = SimulatedArm(load_robot(name), noise=noise, rng=np.random.default_rng([seed, 1]))
    settings = SchemeSettings(discovery=DiscoverySettings(telling=telling))
    scheme = Scheme(arm, np.random.default_rng([seed, 2]), lambda *_: None, settings)
    for _, _ in zip(range(motions), scheme.discover(), strict=False):
        pass
    return scheme


@pytest.mark.parametrize("seed", range(2))
def test_an_arm_in_noise_knows_its_relations_after_thirty_motions(seed):
    assert learn_relations(*discovered(40, 30, seed).samples).order == 8
    assert learn_relations(*discovered(0, 30, seed).samples).order < 8


def watched(order, status, decided=True):
    """Torques of an arm whose chain shows so many relations."""
    learner = SimpleNamespace(verdict_=status, fit_=SimpleNamespace(chain=None))
    chain = SimpleNamespace(learner=learner, learned=(np.zeros((1, 2)), np.zeros((1, 2))))
    found = SimpleNamespace(order=order, decided=decided)
    torques = TellingTorques(chain, StaticTorqueSet(2), np.zeros(2), np.random.default_rng(0))
    return torques, found


@pytest.mark.parametrize(
    ("order", "status", "decided", "enough"),
    [
        (8, FitStatus.HELD_OUT, True, True),
        (8, FitStatus.HELD_OUT, False, False),
        (1, FitStatus.HELD_OUT, True, False),  # no bound says that there are no more
        (1, FitStatus.ROUNDING, True, True),
    ],
)
def test_it_goes_on_until_relations_are_known(monkeypatch, order, status, decided, enough):
    torques, found = watched(order, status, decided)
    monkeypatch.setattr(module, "relations_of_chain", lambda _: found)
    monkeypatch.setattr(module, "telling_pose", lambda *_, **__: None)
    for _ in range(2):
        assert (torques(np.zeros(2), np.ones(2)) is None) is enough


def test_without_a_chain_torques_are_random_about_home():
    torques = TellingTorques(
        ChainWatch(2), StaticTorqueSet(2), np.zeros(2), np.random.default_rng(0)
    )
    centre, scale = np.array([5.0, -1.0]), np.array([2.0, 0.0])
    tried = np.array([torques(centre, scale) for _ in range(200)])
    assert np.all(np.abs(tried - centre) <= WIDTH * scale)
    assert np.ptp(tried[:, 0]) > 1.8 * WIDTH * scale[0]


def test_a_number_below_zero_is_refused():
    with pytest.raises(InputError, match="telling"):
        DiscoverySettings(telling=-1)
