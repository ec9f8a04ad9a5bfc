"""Two engines, one physics: outcomes from far and unstable starts, under any torque."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from isotorque.learning.simulator.settings import SettleRule
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import finite_limits
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.random_arms import arm_models

MODES = ("open_loop", "geared")


def both(robot, physics="open_loop"):
    compiled = SimulatedArm(robot, physics=physics)
    return compiled, SimulatedArm(robot, physics=physics, engine="pinocchio")


def draw_motions(arm, count, rng):
    """Starts anywhere within the limits, and torques of equilibria far away, stable or not.

    One torque in four is larger than any configuration needs.
    """
    low, high = finite_limits(arm.limits).T
    starts = rng.uniform(low, high, (count, arm.n))
    targets = rng.uniform(low, high, (count, arm.n))
    torques = np.array([arm.equations.gravity_torque(q) for q in targets])
    return starts, torques * rng.choice([1.0, 1.0, 1.0, 1.5], (count, 1))


def mismatches(one, other, starts, torques):
    """Count motions that end differently: in kind, or by more than a milliradian."""
    a, b = one.settle_each(starts, torques), other.settle_each(starts, torques)
    return sum(
        kind_a != kind_b or np.abs(q_a - q_b).max() > 1e-3
        for kind_a, kind_b, q_a, q_b in zip(a.kinds, b.kinds, a.q, b.q, strict=True)
    )


@pytest.mark.parametrize("physics", MODES)
@pytest.mark.parametrize("name", ["2r", "3r", "ur5", "panda"])
def test_engines_agree(name, physics):
    compiled, reference = both(load_robot(name), physics)
    starts, torques = draw_motions(compiled, 25, np.random.default_rng(11))
    assert mismatches(compiled, reference, starts, torques) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["2r", "3r", "ur5", "panda"])
def test_engines_agree_on_a_thousand_motions(name):
    compiled, reference = both(load_robot(name))
    starts, torques = draw_motions(compiled, 1000, np.random.default_rng(12))
    ends = compiled.settle_each(starts, torques)
    far = np.linalg.norm(ends.q - starts, axis=1) > 1.0
    assert far.sum() >= 500
    assert mismatches(compiled, reference, starts, torques) <= 1


@given(arm_models(1, 4), st.integers(0, 2**32 - 1))
@settings(max_examples=15)
def test_engines_agree_on_random_arms(model, seed):
    try:
        compiled, reference = both(load_robot(model))
    except InputError as error:
        assume("a constant torque can hold" not in str(error))
        raise
    starts, torques = draw_motions(compiled, 4, np.random.default_rng(seed))
    assert mismatches(compiled, reference, starts, torques) == 0


@pytest.mark.parametrize("name", ["2r", "3r"])
def test_engines_fall_the_same_way_from_exact_unstable_equilibria(name):
    """Rounding would decide, were it not for the disturbance both engines share."""
    compiled, reference = both(load_robot(name))
    rng = np.random.default_rng(5)
    starts = []
    while len(starts) < 15:
        q = rng.uniform(-3.0, 3.0, compiled.n)
        if np.linalg.eigvalsh(compiled.equations.stiffness(q))[0] < -1.0:
            starts.append(q)
    starts = np.array(starts)
    torques = np.array([compiled.equations.gravity_torque(q) for q in starts])
    assert mismatches(compiled, reference, starts, torques) == 0
    ends = compiled.settle_each(starts, torques)
    settled = [str(kind) == "settled" for kind in ends.kinds]
    assert (np.abs(ends.q - starts).max(axis=1)[settled] > 0.01).all()


@pytest.mark.parametrize("name", ["2r", "3r"])
def test_default_accuracy_decides_outcomes_as_a_tight_one_does(name):
    robot = load_robot(name)
    usual = SimulatedArm(robot)
    tight = SimulatedArm(robot, rule=SettleRule(tolerance=1e-6, time_tolerance=1e-4))
    starts, torques = draw_motions(usual, 1000, np.random.default_rng(13))
    a, b = usual.settle_each(starts, torques), tight.settle_each(starts, torques)
    same = np.array([x == y for x, y in zip(a.kinds, b.kinds, strict=True)])
    settled = np.array([str(kind) == "settled" for kind in a.kinds])
    assert settled.sum() >= 200
    assert (~same).sum() <= 1
    assert np.abs(a.q - b.q)[same & settled].max() < 1e-6
    # Where a limit is hit at full speed, the other joints are right to some milliradians.
    assert np.quantile(np.abs(a.q - b.q)[same & ~settled].max(axis=1), 0.95) < 5e-3
    relative = np.abs(a.seconds / b.seconds - 1.0)[same]
    assert np.quantile(relative, 0.95) < 0.05


def test_profiles_and_accelerations_agree():
    compiled, reference = both(load_robot("3r"))
    home_torque = compiled.equations.gravity_torque(compiled.home)
    ramp = home_torque * np.linspace(1.0, 0.3, 40)[:, None]
    a, b = compiled.play(ramp, 0.05), reference.play(ramp, 0.05)
    assert a.q.shape == (40, 3)
    assert np.abs(a.q - b.q).max() < 1e-9
    assert a.outcome.kind == b.outcome.kind
    q = np.array([0.3, -0.4, 1.0])
    torque = np.array([1.0, 2.0, -1.0])
    ours = compiled.release_test(q, torque).acceleration
    assert np.allclose(ours, reference.release_test(q, torque).acceleration, atol=1e-9)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_absurd_torques_end_too(engine):
    arm = SimulatedArm(load_robot("2r"), engine=engine)
    for size, kind in ((1e10, "limit"), (1e300, "timeout")):
        outcome = arm.apply([size, -size])
        assert outcome.kind == kind
        assert np.isfinite(outcome.q).all()
        assert np.array_equal(arm.q, arm.home)
