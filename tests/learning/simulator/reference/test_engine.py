"""When the reference engine says settled: at rest for a while, at a stable equilibrium inside."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.settings import SettleMode, SettleRule
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot

PENDULUM = load_robot("pendulum")


def engine(limits=None, **rule):
    arm = SimulatedArm(
        PENDULUM, engine="pinocchio", limits=limits, home=None, rule=SettleRule(**rule)
    )
    return arm, arm._engine


@given(st.floats(-0.95, 0.95), st.floats(-3.1, 3.1))
@settings(max_examples=12)
def test_a_settled_arm_is_at_a_stable_equilibrium(share, start):
    arm, moved = engine()
    turn = np.linspace(-np.pi, np.pi, 9)[:, None]
    largest = max(np.abs(arm.equations.gravity_torque(q)).max() for q in turn)
    torque = np.array([share * largest])
    motion = moved.settle(np.array([start]), np.zeros(1), torque)
    if motion.kind is OutcomeKind.SETTLED:
        assert np.abs(arm.equations.gravity_torque(motion.q) - torque).max() <= arm._body.residual
        assert arm.equations.stiffness(motion.q)[0, 0] > 0
        assert motion.seconds >= SettleRule().dwell - 1e-9


def equilibria(arm):
    """The stable and the unstable equilibrium of the pendulum without torque."""
    places = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2])
    balanced = [x for x in places if abs(arm.equations.gravity_torque(np.array([x]))[0]) < 1e-9]
    stable = [x for x in balanced if arm.equations.stiffness(np.array([x]))[0, 0] > 0]
    unstable = [x for x in balanced if arm.equations.stiffness(np.array([x]))[0, 0] < 0]
    return stable[0], unstable[0]


@pytest.mark.parametrize("away", [0.0, 1e-12, 1e-9])
def test_at_rest_upside_down_is_not_settled(away):
    """Velocity and acceleration are next to nothing there for longer than the dwell time."""
    arm, moved = engine(limits=[[-50.0, 50.0]])
    stable, unstable = equilibria(arm)
    motion = moved.settle(np.array([unstable + away]), np.zeros(1), np.zeros(1))
    assert motion.kind is OutcomeKind.SETTLED
    assert abs(np.angle(np.exp(1j * (motion.q[0] - stable)))) < 1e-6
    assert motion.seconds > 1.0


@pytest.mark.parametrize("wide", [1e-5, 1e-2])
def test_an_equilibrium_beyond_a_limit_is_none(wide):
    """The arm rests just before its limit, and would come to rest just behind it."""
    arm, _ = engine()
    stable, _ = equilibria(arm)
    limits = np.array([[stable - 1.0, stable - 1e-9]])
    arm = SimulatedArm(
        PENDULUM,
        engine="pinocchio",
        limits=limits,
        home=[stable - 0.5],
        rule=SettleRule(time_limit=5.0, velocity=1.0, acceleration=100.0),
    )
    motion = arm._engine.settle(np.array([stable - wide]), np.zeros(1), np.zeros(1))
    assert motion.kind is not OutcomeKind.SETTLED


def test_a_moving_arm_has_not_settled():
    """Through the lowest point, where nothing accelerates it, an arm goes on."""
    arm, moved = engine(mode=SettleMode.RAW, dwell=0.0, velocity=1e-3, acceleration=10.0)
    stable, _ = equilibria(arm)
    motion = moved.settle(np.array([stable]), np.array([0.5]), np.zeros(1))
    assert motion.kind is OutcomeKind.SETTLED
    assert abs(motion.v[0]) <= 1e-3
    assert motion.seconds > 0.0


@pytest.mark.parametrize("dwell", [0.05, 0.5, 2.0])
def test_an_arm_that_rests_has_settled_after_the_dwell_time(dwell):
    arm, moved = engine(dwell=dwell)
    stable, _ = equilibria(arm)
    motion = moved.settle(np.array([stable]), np.zeros(1), np.zeros(1))
    assert motion.kind is OutcomeKind.SETTLED
    assert motion.seconds == pytest.approx(dwell, abs=1e-9)


def test_just_beyond_the_largest_torque_there_is_no_place_to_settle():
    """An arm that has come almost to a stop before the top, where its stiffness is next to none."""
    arm, _ = engine()
    grid = np.linspace(-np.pi, np.pi, 9)[:, None]
    torques = np.array([arm.equations.gravity_torque(q)[0] for q in grid])
    top, largest = grid[np.argmax(torques)], torques.max()
    allowed = arm._body.residual / largest
    away = 0.5 * np.sqrt(allowed)  # Newton's first step leads over the top, and misses by little
    stable = top - away
    if arm.equations.stiffness(stable)[0, 0] < 0:
        stable = top + away
    arm, moved = engine(limits=[[-50.0, 50.0]], dwell=0.0, time_limit=1.0)
    over = moved.settle(stable, np.zeros(1), np.array([largest * (1 + 0.3 * allowed)]))
    assert over.kind is OutcomeKind.TIMEOUT
