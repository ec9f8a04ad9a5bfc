"""The simulated arm: how torques and torque profiles end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import Arm, LimitHit, OutcomeKind, ProfileArm, Settled, TimedOut
from isotorque.learning.simulator.settings import SettleRule
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.two_link_arm import ARM, GRAVITY, ROBOT, stable_targets

STABLE_SHARES = {"2r": 0.25, "3r": 0.107}  # of the torus


def test_it_is_an_arm():
    assert isinstance(ARM, Arm)
    assert isinstance(ARM, ProfileArm)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_it_settles_at_the_stable_equilibrium_nearby(seed):
    arm = SimulatedArm(ROBOT, home=[-1.5, 0.0])
    for target in stable_targets(3, seed):
        torque = GRAVITY(target)
        outcome = SimulatedArm(ROBOT, home=[-1.5, 0.0], q0=target + 0.02).apply(torque)
        assert isinstance(outcome, Settled)
        assert np.abs(outcome.q - target).max() < 1e-6
        assert np.abs(GRAVITY(outcome.q) - torque).max() <= 1e-9
        assert outcome.seconds >= arm.rule.dwell


@pytest.mark.parametrize("mode", ["finished", "raw"])
@pytest.mark.parametrize("name", list(STABLE_SHARES))
def test_open_loop_reaches_stable_configurations_alone(name, mode):
    arm = SimulatedArm(load_robot(name), settle=mode)
    rng = np.random.default_rng(4)
    low, high = arm.limits.T
    starts = rng.uniform(low, high, (300, arm.n))
    torques = np.array(
        [arm.equations.gravity_torque(q) for q in rng.uniform(low, high, starts.shape)]
    )
    ends = arm.settle_each(starts, torques)
    settled = [kind is OutcomeKind.SETTLED for kind in ends.kinds]
    assert sum(settled) > 50
    for q in ends.q[settled]:
        assert np.linalg.eigvalsh(arm.equations.stiffness(q))[0] > 0


@pytest.mark.parametrize(("name", "share"), STABLE_SHARES.items())
def test_share_of_configurations_that_can_be_held(name, share):
    equations = SimulatedArm(load_robot(name)).equations
    drawn = np.random.default_rng(1).uniform(-np.pi, np.pi, (20_000, equations.n))
    smallest = np.linalg.eigvalsh(np.array([equations.stiffness(q) for q in drawn]))[:, 0]
    deviation = np.sqrt(share * (1 - share) / len(drawn))
    assert abs((smallest > 0).mean() - share) < 4 * deviation


def test_torques_that_no_configuration_needs_never_settle():
    for scale in (1.05, 1.5, 3.0):
        torque = scale * GRAVITY(np.zeros(2))  # the largest gravity torque there is
        outcome = SimulatedArm(ROBOT).apply(torque)
        assert isinstance(outcome, LimitHit)


def test_a_limit_hit_stops_at_the_limit_and_goes_home():
    arm = SimulatedArm(ROBOT, limits=[[-2.0, -1.0], [-0.5, 0.5]])
    outcome = arm.apply(GRAVITY(np.array([-0.5, 0.0])))
    assert isinstance(outcome, LimitHit)
    assert np.isclose(outcome.q, [-1.0, 0.5]).any()
    assert (outcome.q <= arm.limits[:, 1]).all()
    assert outcome.seconds > 0.0
    assert np.array_equal(arm.q, arm.home)
    assert isinstance(arm.apply(GRAVITY(arm.home)), Settled)


def test_a_time_out_goes_home():
    arm = SimulatedArm(ROBOT, rule=SettleRule(time_limit=0.5), q0=[-0.6, 0.0])
    outcome = arm.apply(GRAVITY(arm.home))
    assert isinstance(outcome, TimedOut)
    assert outcome.seconds == 0.5
    assert np.array_equal(arm.q, arm.home)


def test_an_arm_that_is_there_already_waits_for_the_dwell():
    outcome = ARM.settle_each([ARM.home], [GRAVITY(ARM.home)])
    assert outcome.kinds == (OutcomeKind.SETTLED,)
    assert np.isclose(outcome.seconds[0], ARM.rule.dwell)
    assert np.abs(outcome.q[0] - ARM.home).max() < 1e-9


def test_starting_at_rest_is_not_settling():
    """At a turning point the velocity is zero, but not the acceleration."""
    target = np.array([-1.2, -0.3])
    for engine in ("compiled", "pinocchio"):
        arm = SimulatedArm(ROBOT, engine=engine, q0=target + 0.5)
        outcome = arm.apply(GRAVITY(target))
        assert outcome.seconds > 0.5
        assert np.abs(outcome.q - target).max() < 1e-6


def test_each_command_goes_on_from_where_the_last_one_ended():
    arm = SimulatedArm(ROBOT)
    targets = stable_targets(1, 3)[0] + np.linspace(0, 0.2, 3)[:, None]
    for target in targets:
        before = arm.q
        outcome = arm.apply(GRAVITY(target))
        alone = SimulatedArm(ROBOT, q0=before).apply(GRAVITY(target))
        assert np.array_equal(outcome.q, alone.q)
        assert np.array_equal(arm.q, outcome.q)


def test_raw_samples_are_off_by_some_millinewtonmetres_and_end_alike():
    finished, raw = SimulatedArm(ROBOT), SimulatedArm(ROBOT, settle="raw")
    targets = stable_targets(60, 5)
    starts, torques = targets + 0.05, np.array([GRAVITY(q) for q in targets])
    a, b = finished.settle_each(starts, torques), raw.settle_each(starts, torques)
    assert a.kinds == b.kinds
    assert np.array_equal(a.seconds, b.seconds)
    settled = [kind is OutcomeKind.SETTLED for kind in a.kinds]
    missing = np.array([np.abs(GRAVITY(q) - t).max() for q, t in zip(b.q, torques, strict=True)])
    assert 1e-3 < np.median(missing[settled]) < 6e-3
    # M a + D v, with the bounds of the settle rule.
    bound = 1e-2 * 0.84 + 1e-3 * ARM.damping[0] + 2e-3
    assert missing[settled].max() < bound


def test_a_raw_arm_goes_on_with_the_velocity_it_has():
    arm = SimulatedArm(ROBOT, settle="raw", q0=[-1.0, 0.2])
    arm.apply(GRAVITY(np.array([-1.3, 0.0])))
    assert 0.0 < np.abs(arm.state().v).max() <= arm.rule.velocity


def test_a_profile_of_one_torque_is_that_torque():
    target = np.array([-1.2, -0.3])
    played = SimulatedArm(ROBOT).play(np.tile(GRAVITY(target), (50, 1)), 0.02)
    applied = SimulatedArm(ROBOT).apply(GRAVITY(target))
    assert played.times[0] == 0.02
    assert np.isclose(played.times[-1], 1.0)
    assert played.q.shape == played.torques.shape == (50, 2)
    assert np.array_equal(played.torques[0], GRAVITY(target))
    assert isinstance(played.outcome, Settled)
    assert np.abs(played.outcome.q - applied.q).max() < 1e-6
    assert np.isclose(played.outcome.seconds, applied.seconds, rtol=0.05)


def test_a_slow_profile_is_followed_quasi_statically():
    path = np.linspace(ARM.home, ARM.home + np.array([0.6, -0.3]), 400)
    playback = SimulatedArm(ROBOT).play(np.array([GRAVITY(q) for q in path]), 0.1)
    assert np.abs(playback.q - path).max() < 0.05


def test_a_profile_ends_where_a_limit_is_hit():
    arm = SimulatedArm(ROBOT)
    ramp = GRAVITY(np.zeros(2)) * np.linspace(0.0, 3.0, 200)[:, None]
    playback = arm.play(ramp, 0.1)
    count = len(playback.times)
    assert isinstance(playback.outcome, LimitHit)
    assert count < 200
    assert playback.q.shape == playback.torques.shape == (count, 2)
    assert np.array_equal(playback.q[-1], playback.outcome.q)
    assert np.array_equal(playback.outcome.torque, ramp[count - 1])
    assert 0.1 * (count - 1) < playback.times[-1] <= 0.1 * count
    assert np.isclose(playback.outcome.seconds, playback.times[-1])
    assert np.array_equal(arm.q, arm.home)
