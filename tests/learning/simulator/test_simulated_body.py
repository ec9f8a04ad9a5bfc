"""Placed tests, geared and guided arms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import Settled
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from tests.learning.two_link_arm import ARM, GRAVITY, ROBOT, stable_targets


def test_place_and_hold_tells_stable_from_falling():
    before = ARM.state()
    for target in stable_targets(10, 6):
        held = ARM.place_and_hold(target, GRAVITY(target))
        assert held.held
        assert held.distance < 1e-6
        slightly_wrong = ARM.place_and_hold(target, GRAVITY(target) + 0.02)
        assert slightly_wrong.distance > 1e-4
    upright = np.array([1.5, 0.1])
    assert not ARM.place_and_hold(upright, GRAVITY(upright) + 0.1).held
    spinning = ARM.place_and_hold(upright, GRAVITY(np.zeros(2)) * 2)
    assert not spinning.held
    assert spinning.distance == np.inf
    assert ARM.state() == before


@given(st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=2))
@settings(max_examples=30)
def test_a_release_test_finds_equilibria_stable_or_not(q):
    q = np.array(q)
    release = ARM.release_test(q, GRAVITY(q))
    assert release.balanced
    assert np.abs(release.acceleration).max() < 1e-8
    pushed = ARM.release_test(q, GRAVITY(q) + np.array([0.0, 0.1]))
    assert not pushed.balanced
    expected = np.linalg.solve(ARM.equations.mass_matrix(q), [0.0, 0.1])
    assert np.allclose(pushed.acceleration, expected, atol=1e-8)


def test_geared_arms_stick_anywhere():
    arm = SimulatedArm(ROBOT, "geared", coulomb=1.0)
    q = np.array([1.0, 0.5])
    assert arm.release_test(q, GRAVITY(q) + 0.9).balanced
    assert not arm.release_test(q, GRAVITY(q) + np.array([0.0, 1.1])).balanced
    outcome = SimulatedArm(ROBOT, "geared", coulomb=1.0).apply(GRAVITY(np.array([-1.2, 0.0])))
    assert isinstance(outcome, Settled)
    missing = np.abs(GRAVITY(outcome.q) - outcome.torque).max()
    assert 1e-3 < missing <= 1.0  # labels are off by up to the friction


def test_a_guided_arm_is_placed_and_its_holding_torque_measured():
    arm = SimulatedArm(ROBOT, "guided")
    for q in np.random.default_rng(7).uniform(-3, 3, (10, 2)):
        arm.place(q)
        sample = arm.hold()
        assert np.array_equal(sample.q, q)
        assert np.allclose(sample.torque, GRAVITY(q), atol=1e-12)
    arm.place(stable_targets(1, 8)[0])
    assert isinstance(arm.apply(GRAVITY(arm.q)), Settled)


def test_the_error_of_a_holding_torque_is_bounded():
    noise = SensorNoise(holding_torque=0.01)
    arm = SimulatedArm(ROBOT, "guided", noise=noise, rng=np.random.default_rng(0))
    arm.place([0.3, 0.4])
    errors = np.array([arm.hold().torque - GRAVITY(np.array([0.3, 0.4])) for _ in range(300)])
    assert 0.009 < np.abs(errors).max() <= 0.01


def test_an_arm_that_is_not_guided_is_neither_placed_nor_held():
    for action in (lambda: ARM.place([0.0, 0.0]), ARM.hold):
        with pytest.raises(InputError, match="is open_loop; accepted: guided"):
            action()
