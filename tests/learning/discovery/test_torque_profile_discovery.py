"""Babbling about the torque that holds home, and leading an arm about."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import LimitHit, OutcomeKind, Playback, Settled, TimedOut
from isotorque.learning.discovery.motor_babbling import FIRST_TORQUE, babble
from isotorque.learning.discovery.torque_limits import TorqueLimitedArm
from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings, discover, lead
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


class Scripted:
    """An arm that ends each profile as it is told to, and remembers what was played."""

    def __init__(self, ends):
        self.ends, self.played = iter(ends), []

    def play(self, torques, step_seconds):
        self.played.append(torques)
        kind, q = next(self.ends)
        outcome = kind(np.asarray(q, dtype=float), torques[-1], 1.0)
        return Playback(outcome, np.zeros(1), np.zeros((1, len(q))), torques[-1:])


@given(st.integers(0, 2**32 - 1), st.lists(st.booleans(), min_size=2, max_size=16))
@settings(max_examples=40)
def test_each_profile_starts_where_the_last_one_ended(seed, holds):
    """... and where the last one did not hold the arm, which went home, at tau* itself."""
    rng = np.random.default_rng(seed)
    tau = np.array([3.0, -1.0, 2.0])
    ends = [(Settled if held else LimitHit, rng.uniform(-3, 3, 3)) for held in holds]
    arm = Scripted(ends)
    wanted = DiscoverySettings(profiles_per_torque=len(holds), patience=len(holds))
    assert len(list(discover(arm, tau, np.ones(3), rng, wanted))) == len(holds)
    np.testing.assert_array_equal(arm.played[0][0], tau)
    for held, last, following in zip(holds, arm.played, arm.played[1:], strict=False):
        np.testing.assert_array_equal(following[0], last[-1] if held else tau)
    for profile in arm.played:
        np.testing.assert_array_equal(np.abs(profile[[0, -1]]), np.abs([tau, tau]))


@given(
    st.lists(st.integers(0, 3), min_size=1, max_size=16),
    st.integers(0, 2**32 - 1),
    st.booleans(),
)
@settings(max_examples=40)
def test_a_configuration_is_new_once_whatever_its_turns_and_its_last_digits(places, seed, before):
    rng = np.random.default_rng(seed)
    settings_ = DiscoverySettings(profiles_per_torque=16, patience=16)
    away = np.array([[0.0, 0.0], [0.0, 3e-3], [1.0, -1.0], [np.pi, 0.0]])  # apart by more
    ends = [
        (Settled, away[i] + rng.uniform(-3e-4, 3e-4, 2) + 2 * np.pi * rng.integers(-1, 2, 2))
        for i in places
    ]
    ends += [(TimedOut, np.zeros(2))] * (16 - len(ends))
    known = (lambda: away[:1]) if before else None
    found = discover(Scripted(ends), [1.0, 1.0], [1.0, 1.0], rng, settings_, known)
    new = [played.new for played in found]
    seen = {0} if before else set()
    for place, is_new in zip(places, new, strict=False):
        assert is_new == (place not in seen)
        seen.add(place)
    assert not any(new[len(places) :])


def test_patience_ends_where_nothing_new_comes():
    ends = [(Settled, [0.5, 0.5])] * 20
    wanted = DiscoverySettings(profiles_per_torque=20, patience=4)
    found = list(discover(Scripted(ends), [1.0, 1.0], [1.0, 1.0], np.random.default_rng(0), wanted))
    assert [played.new for played in found] == [True, False, False, False, False]
