"""Arms and potentials of any size: the right group, or one clear refusal."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import potentials

ORDERS = {"pendulum": 4, "2r": 8, "ur5": 16}


def result_or_refusal(make):
    """What ``make`` returns, or the words it refuses with."""
    try:
        return make(), ""
    except InputError as error:
        return None, str(error)


def sized(name, mass, length):
    """A built-in robot with all masses and all lengths multiplied."""
    model = load_robot(name).model.copy()
    for i in range(model.njoints):
        body = model.inertias[i]
        model.inertias[i] = pin.Inertia(mass * body.mass, length * body.lever, mass * body.inertia)
        model.jointPlacements[i].translation *= length
    return model


@given(st.sampled_from(sorted(ORDERS)), st.floats(-330, 300), st.floats(-60, 60))
@example("2r", -320.0, 0.0)  # denormal masses
@example("ur5", 300.0, 0.0)
@example("2r", 0.0, -160.0)
@example("2r", 48.0, 48.0)
@settings(max_examples=40)
def test_an_arm_of_any_size_has_its_group_or_is_refused(name, mass, length):
    with np.errstate(all="ignore"):
        mass, length = float(np.power(10.0, mass)), float(np.power(10.0, length))
    gravity, refusal = result_or_refusal(
        lambda: GravityModel(load_robot(sized(name, mass, length)))
    )
    group = None
    if gravity is not None:
        group, refusal = result_or_refusal(lambda: primary_symmetries(gravity.potential))
    if 1e-11 < mass < 1e40 and 1e-40 < length < 1e40:
        assert refusal == ""
    assert "Pinocchio" not in refusal
    assert "\n" not in refusal
    if group is not None and mass * length > 1e-300:
        assert group.order == ORDERS[name]
        assert group.exact


@given(potentials(), st.floats(-300, 300))
@settings(max_examples=30)
def test_the_unit_of_a_potential_changes_nothing(potential, power):
    usual = primary_symmetries(potential)
    factor = 2.0 ** round(power / np.log10(2.0))
    group, refusal = result_or_refusal(lambda: primary_symmetries(factor * potential))
    if group is None:
        assert abs(power) > 140, refusal
        return
    assert group.order == usual.order
    for one, other in zip(usual, group, strict=True):
        assert np.array_equal(one.Y, other.Y)
        assert np.array_equal(one.A, other.A)
        assert np.array_equal(one.d, other.d)


@pytest.mark.parametrize("size", [5e-324, 1e-320, 1e-160, 1e160, 1e308])
@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
def test_what_floating_point_cannot_hold_is_refused(size, tolerance):
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [size, size / 3])
    with pytest.raises(InputError, match="largest amplitude of the potential"):
        primary_symmetries(potential, tolerance)


def test_exact_numbers_beyond_floating_point_are_refused():
    potential = TrigonometricPolynomial([[1]], [0], [10**400])
    with pytest.raises(InputError, match="largest amplitude of the potential"):
        primary_symmetries(potential)


@given(st.sampled_from(sorted(ORDERS)), st.floats(-9, 9), st.floats(-9, 9))
def test_what_rounding_may_do_grows_with_masses_and_lengths(name, mass, length):
    """An absolute allowance would pass any torque of a light arm, and refuse a heavy one."""
    usual = GravityModel(load_robot(name)).rounding
    resized = GravityModel(load_robot(sized(name, 10**mass, 10**length))).rounding
    assert resized == pytest.approx(10 ** (mass + length) * usual, rel=1e-6)
