"""Arms whose masses are multiplied move as before, under torques multiplied likewise."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.random_arms import arm_models
from tests.learning.scaled_arms import scaled

EXACT = st.sampled_from([2.0**-30, 2.0**-14, 2.0**14, 2.0**50])
"""Powers of four: floating point scales by them, and their square roots, without rounding."""


def check_same_motions(robot, factor, engine="compiled", count=8):
    one, other = (SimulatedArm(r, engine=engine) for r in (robot, scaled(robot, factor)))
    assert np.array_equal(one.home, other.home)
    assert np.array_equal(one.damping * factor, other.damping)
    rng = np.random.default_rng(0)
    starts = one.home + rng.normal(size=(count, one.n)) * 0.1
    low, high = one.limits.T
    starts = np.clip(starts, low, high)
    torques = np.array([one.equations.gravity_torque(q) for q in starts[::-1]])
    a, b = one.settle_each(starts, torques), other.settle_each(starts, factor * torques)
    assert a.kinds == b.kinds
    assert np.array_equal(a.q, b.q)
    assert np.array_equal(a.seconds, b.seconds)


@given(model=arm_models(1, 4), factor=EXACT)
@settings(max_examples=15)
def test_motions_of_random_arms_scale_bit_for_bit(model, factor):
    try:
        check_same_motions(load_robot(model), factor)
    except InputError as error:
        assume("a constant torque can hold" not in str(error))
        raise


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("name", ["2r", "ur5"])  # ur5: free directions
@pytest.mark.parametrize("factor", [2.0**-14, 2.0**14])
def test_motions_of_known_arms_scale_bit_for_bit(name, engine, factor):
    check_same_motions(load_robot(name), factor, engine, 3 if engine == "pinocchio" else 20)
