"""Arms of any size: what is minute for one carries another one away."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.discovery.home_torque import find_home_torque
from isotorque.learning.discovery.motor_babbling import babble
from isotorque.learning.discovery.torque_profiles import draw_profile
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.discovery.test_home_torque import propped, result
from tests.learning.scaled_arms import scaled

FACTORS = st.floats(-8, 8).map(lambda power: 10.0**power)


@given(factor=FACTORS, physics=st.sampled_from(["open_loop", "guided"]))
@settings(max_examples=12)
def test_the_torque_that_holds_home_is_found(factor, physics):
    usual = propped([-0.9, 0.1], physics=physics)
    limits, home = usual.limits, usual.home
    arm = SimulatedArm(scaled(usual.robot, factor), physics, limits=limits, home=home)
    _, torque = result(find_home_torque(arm))
    true = arm.equations.gravity_torque(arm.home)
    assert np.abs(torque - true).max() < 0.25 * np.abs(true).max()


@given(factor=FACTORS, name=st.sampled_from(["2r", "ur5"]))
@settings(max_examples=8)
def test_babbling_finds_the_range_of_every_joint(factor, name):
    robot = scaled(load_robot(name), factor)
    arm = SimulatedArm(robot)
    outcomes, home = result(babble(arm, np.random.default_rng(0), 60))
    assert not home.any()
    held = np.array([o.torque for o in outcomes if o.kind is OutcomeKind.SETTLED])
    rng = np.random.default_rng(1)
    low, high = np.clip(robot.limits, -np.pi, np.pi).T
    needed = np.array(
        [arm.equations.gravity_torque(q) for q in rng.uniform(low, high, (500, arm.n))]
    )
    felt = np.abs(needed).max(axis=0) > 1e-9 * np.abs(needed).max()
    assert (np.abs(held).max(axis=0)[felt] > 0.1 * np.abs(needed).max(axis=0)[felt]).all()
    assert not np.abs(held)[:, ~felt].any()


@pytest.mark.parametrize("factor", [1e-6, 1e-4, 1.0, 1e4, 1e6])
def test_as_many_relations_are_found(factor):
    arm = SimulatedArm(scaled(load_robot("2r"), factor))
    scheme = Scheme(arm, np.random.default_rng(0), lambda *_: None, SchemeSettings())
    for _ in scheme.discover():
        pass
    assert scheme.gate_passed
    assert scheme.learned.order == 8
    assert scheme.static_torques.contains(scheme.samples[1][-1])


@given(FACTORS)
def test_profiles_begin_and_end_at_torques_of_one_size(factor):
    rng = np.random.default_rng(0)
    start, end = factor * np.array([5.0, 1.0]), factor * np.array([5.0, -1.0])
    assert np.array_equal(draw_profile(start, end, factor * np.ones(2), rng)[-1], end)
    with pytest.raises(InputError, match="end"):
        draw_profile(start, end * [1.0, 1.0 + 1e-6], factor * np.ones(2), rng)
