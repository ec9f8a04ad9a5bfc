"""Babbling about the torque that holds home, and leading an arm about."""

import numpy as np
import pytest

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.discovery.motor_babbling import FIRST_TORQUE, babble
from isotorque.learning.discovery.torque_limits import TorqueLimitedArm
from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings, lead
from isotorque.learning.exploration.guided_arm import LimitedGuidedArm
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.discovery.test_home_torque import propped, result
from tests.learning.two_link_arm import ROBOT


def test_an_arm_that_does_not_hang_is_driven_about_the_torque_that_holds_it():
    arm = propped([-0.9, 0.1])
    outcomes, home = result(babble(arm, np.random.default_rng(0), 60))
    true = arm.equations.gravity_torque(arm.home)
    np.testing.assert_allclose(home, true, atol=0.25 * np.abs(true).max())
    settled = [o for o in outcomes if o.kind is OutcomeKind.SETTLED]
    assert len(settled) > 20
    for joint in range(2):  # both sides of the home torque are known
        torques = np.array([o.torque[joint] for o in settled])
        assert torques.min() < home[joint] < torques.max()


def test_a_hanging_arm_begins_with_a_minute_torque_and_no_search():
    outcomes, home = result(babble(SimulatedArm(ROBOT), np.random.default_rng(0), 30))
    assert home.tolist() == [0.0, 0.0]
    assert outcomes[0].torque.tolist() == [FIRST_TORQUE, 0.0]
    assert outcomes[1].torque.tolist() == [2 * FIRST_TORQUE, 0.0]


def test_nothing_more_is_tried_where_no_torque_is_found():
    def search(arm):
        yield arm.apply(np.zeros(2))

    arm = propped([-0.9, 0.1])
    outcomes, home = result(babble(arm, np.random.default_rng(0), 60, search))
    assert home is None
    assert len(outcomes) == 2


def test_a_guided_arm_is_taken_everywhere_within_its_limits():
    robot = load_robot("panda")
    arm = LimitedGuidedArm(SimulatedArm(robot, physics="guided"), robot.limits)
    q = np.array([o.q for o in lead(arm, arm.reach, np.random.default_rng(0), 200)])
    low, high = robot.limits.T
    assert (q >= low).all()
    assert (q <= high).all()
    assert (np.ptp(q, axis=0) > 0.9 * (high - low)).all()


def test_a_scheme_leads_a_guided_arm_that_cannot_hold_itself(tmp_path):
    arm = propped([0.9, 0.1], width=0.6, physics="guided")
    guided = LimitedGuidedArm(arm, arm.limits)
    settings = SchemeSettings(
        DiscoverySettings(babbling=20, guided_places=10), guided=True, max_targets=2
    )
    scheme = Scheme(guided, np.random.default_rng(0), lambda *_: None, settings)
    motions = list(scheme.discover())
    assert scheme.home_torque is None
    assert scheme.learned is not None
    assert sum(m.new for m in motions) >= 40
    # one torque each: no profile is played on an arm that would fall
    assert all(m.playback is None for m in motions)


def test_no_torque_beyond_the_largest_is_ever_commanded():
    commanded = []

    class Watched(SimulatedArm):
        def apply(self, torque):
            commanded.append(np.abs(torque))
            return super().apply(torque)

        def play(self, torques, step_seconds):
            commanded.append(np.abs(torques).max(axis=0))
            return super().play(torques, step_seconds)

    largest = np.array([3.0, np.inf])
    arm = TorqueLimitedArm(Watched(ROBOT), largest)
    settings = SchemeSettings(DiscoverySettings(babbling=30, profiles_per_torque=3), max_targets=2)
    scheme = Scheme(arm, np.random.default_rng(0), lambda *_: None, settings)
    motions = list(scheme.discover())
    assert (np.array(commanded) <= largest).all()
    assert arm.cut > 0
    assert max(m.outcome.torque[0] for m in motions) == 3.0  # what is recorded was commanded


def test_settings_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="guided_places is 0"):
        DiscoverySettings(guided_places=0)
