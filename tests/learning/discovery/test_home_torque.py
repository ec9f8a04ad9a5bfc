"""Finding the torque that holds home: by releases alone, and with an arm that is held."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.shared.small_arms import write_arm
from isotorque.learning.arm import OutcomeKind
from isotorque.learning.discovery.home_torque import (
    find_home_torque,
    holds_itself,
    measure_home_torque,
)
from isotorque.learning.discovery.motor_babbling import babble
from isotorque.learning.exploration.guided_arm import LimitedGuidedArm
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.two_link_arm import ROBOT


def result(search):
    """Every outcome of a search, and what it returns."""
    outcomes = []
    while True:
        try:
            outcomes.append(next(search))
        except StopIteration as end:
            return outcomes, end.value


def propped(home, width=0.4, **options):
    """The two-link arm with limits that leave it little room about a home away from hanging."""
    limits = np.array([np.asarray(home) - width, np.asarray(home) + width]).T
    return SimulatedArm(ROBOT, limits=limits, home=home, **options)


HOMES = st.tuples(st.floats(-1.35, -0.75), st.floats(-0.3, 0.3))  # stable, both links below


@given(HOMES, st.sampled_from(["open_loop", "guided"]))
@settings(max_examples=15)
def test_what_is_found_holds_the_arm_near_home(home, physics):
    arm = propped(home, physics=physics)
    outcomes, torque = result(find_home_torque(arm))
    assert torque is not None
    arm.go_home()
    held = arm.apply(torque)
    assert held.kind is OutcomeKind.SETTLED
    assert np.abs(held.q - arm.home).max() < 0.4
    if outcomes[0].kind is not OutcomeKind.SETTLED:  # nothing but releases from home
        true = arm.equations.gravity_torque(arm.home)
        assert np.abs(torque - true).max() < 0.25 * np.abs(true).max()


def test_a_hanging_arm_is_asked_once():
    arm = SimulatedArm(ROBOT)
    outcomes, torque = result(find_home_torque(arm))
    assert len(outcomes) == 1
    assert torque.tolist() == [0.0, 0.0]


def test_it_is_found_through_noise():
    noise = SensorNoise(angle=1e-3, torque=0.01, encoder_step=1e-3)
    arm = propped([-0.9, 0.1], noise=noise, rng=np.random.default_rng(1))
    _, torque = result(find_home_torque(arm))
    arm.go_home()
    assert arm.apply(torque).kind is OutcomeKind.SETTLED


@pytest.mark.parametrize("name", ["panda", "talos-arm-like", "m1013-like"])
def test_joints_that_gravity_does_not_feel_get_no_torque(tmp_path, name):
    arm = SimulatedArm(load_robot(name if name == "panda" else write_arm(name, tmp_path)))
    _, torque = result(find_home_torque(arm))
    assert torque is not None
    arm.go_home()
    assert arm.apply(torque).kind is OutcomeKind.SETTLED
    felt = np.abs([arm.equations.gravity_torque(q) for q in np.eye(arm.n)]).max(axis=0) > 1e-9
    assert not torque[~felt].any()


def test_an_arm_that_nothing_holds_is_not_said_to_be_held(tmp_path):
    robot = load_robot(write_arm("short-stop", tmp_path))
    arm = SimulatedArm(robot, physics="guided")
    _, torque = result(find_home_torque(arm))
    assert torque is None
    outcomes, torque = result(measure_home_torque(arm, np.random.default_rng(0)))
    assert torque is None
    assert len(outcomes) == 3  # no torque, the one that was measured, and that it falls under it


def test_which_arms_hold_themselves(tmp_path):
    rng = np.random.default_rng(0)
    for name, holds in (("ur5", True), ("3r", True), ("panda", False)):
        assert holds_itself(SimulatedArm(load_robot(name), "guided"), rng) is holds
    arm = propped([-0.9, 0.1], physics="guided")
    assert holds_itself(arm, rng)


def test_an_arm_that_rests_but_falls_under_any_torque_does_not_hold_itself(tmp_path):
    robot = load_robot(write_arm("talos-arm-like", tmp_path))
    arm = LimitedGuidedArm(SimulatedArm(robot, physics="guided"), robot.limits)
    outcomes, torque = result(measure_home_torque(arm, np.random.default_rng(0)))
    assert outcomes[0].kind is OutcomeKind.SETTLED
    assert torque is None
    # nor is it taken for one that hangs because a minute torque leaves it at rest
    search = partial(measure_home_torque, rng=np.random.default_rng(0))
    _, torque = result(babble(arm, np.random.default_rng(1), 60, search, always=True))
    assert torque is None
    _, torque = result(babble(arm, np.random.default_rng(1), 0, search))
    assert torque is not None
