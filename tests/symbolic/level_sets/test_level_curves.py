"""Component-wise level sets: on the curve everywhere, none missed, and crossing where they must."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.level_sets.level_curves import level_curves
from isotorque.symbolic.level_sets.level_set import level_set
from tests.symbolic.gravity.small_potentials import A, B, three_r, two_r


def along(curve, parts=7):
    """Return points spread over every segment of a polyline."""
    share = np.linspace(0, 1, parts)[:, None, None]
    return ((1 - share) * curve[:-1] + share * curve[1:]).reshape(-1, 2)


def distance(q, curves):
    """Return the distance of q from the nearest of some polylines."""
    nearest = np.inf
    for curve in curves:
        step = np.diff(curve, axis=0)
        share = ((q - curve[:-1]) * step).sum(axis=1) / (step**2).sum(axis=1)
        foot = curve[:-1] + np.clip(share, 0, 1)[:, None] * step
        nearest = min(nearest, np.linalg.norm(q - foot, axis=1).min())
    return nearest


@settings(max_examples=25)
@given(st.floats(1, 20), st.floats(1, 20), st.integers(0, 1), st.floats(-1.2, 1.2))
def test_every_point_of_a_curve_needs_the_torque(a, b, joint, share):
    potential = two_r(a, b)
    torque = share * potential.gradient_bound()[joint]
    found = level_curves(potential, joint, torque, tolerance=1e-4)
    for curve, level in zip(found.curves, found.torques, strict=True):
        assert abs(level) == abs(torque)
        error = potential.gradient(along(curve))[:, joint] - level
        assert np.abs(error).max() <= 1e-4
    if abs(share) > 1 + 1e-12:  # what is closer is a curve of one point, to rounding
        assert not found.curves


@settings(max_examples=25)
@given(st.integers(0, 1), st.floats(-0.9, 0.9), st.integers(0, 2**32 - 1))
def test_no_crossing_of_the_level_is_missed(joint, share, seed):
    """On random straight lines every change of sign of g - level lies on a curve."""
    potential = two_r()
    torque = share * potential.gradient_bound()[joint]
    assume(abs(abs(torque) - abs(A - B)) > 0.3)  # a curve that crosses itself
    found = level_curves(potential, joint, torque, tolerance=1e-3)
    ends = np.random.default_rng(seed).uniform(-3, 3, (2, 2))
    line = ends[0] + np.linspace(0, 1, 20_001)[:, None] * (ends[1] - ends[0])
    for level in (torque, -torque):
        miss = potential.gradient(line)[:, joint] - level
        for i in np.flatnonzero(np.sign(miss[:-1]) != np.sign(miss[1:]))[:4]:
            assert distance(line[i], found.curves) < 2e-3


@pytest.mark.parametrize("torque", [0.0, 3.0, 12.26, 20.0])
def test_default_accuracy(torque):
    found = level_curves(two_r(), 0, torque)
    assert found.curves
    for curve, level in zip(found.curves, found.torques, strict=True):
        assert np.abs(two_r().gradient(along(curve))[:, 0] - level).max() <= 1e-6


def test_configurations_of_a_torque_are_the_intersections():
    """Fig. 2B."""
    torque = two_r().gradient([1.1, 0.3])
    curves = [level_curves(two_r(), i, torque[i], tolerance=1e-3) for i in (0, 1)]
    found = level_set(two_r(), torque)
    assert len(found) == 16
    for q, tau in zip(found.configurations, found.torques, strict=True):
        for i, component in enumerate(curves):
            own = [
                curve
                for curve, level in zip(component.curves, component.torques, strict=True)
                if np.sign(level) == np.sign(tau[i])
            ]
            assert distance(q, own) < 1e-3


def test_a_single_frequency_gives_straight_lines_even_at_its_largest_torque():
    found = level_curves(two_r(), 1, B)
    assert all(len(curve) == 2 for curve in found.curves)
    np.testing.assert_allclose(
        [two_r().gradient(curve)[0, 1] for curve in found.curves], found.torques
    )
    sums = {round(abs(float(curve.sum(axis=1)[0])), 9) for curve in found.curves}
    assert sums == {0.0, round(np.pi, 9)}


def test_window():
    found = level_curves(two_r(), 0, 5.0, window=((0.0, 3.0), (-1.0, 1.0)), tolerance=1e-3)
    points = np.concatenate(found.curves)
    assert points[:, 0].min() > -0.01
    assert points[:, 0].max() < 3.01
    assert np.abs(points[:, 1]).max() < 1.01


def test_a_torque_no_configuration_needs_gives_no_curve():
    for joint in (0, 1):
        found = level_curves(two_r(), joint, 30.0)
        assert found.curves == ()
        assert found.torques.shape == (0,)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"potential": three_r()}, "number of joints"),
        ({"joint": 2}, "joint"),
        ({"torque": np.nan}, "torque"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"window": ((0, 0), (0, 1))}, "window"),
        ({"window": (0, 1)}, "window"),
    ],
)
def test_unusable_arguments_are_refused(change, match):
    arguments = {"potential": two_r(), "joint": 0, "torque": 1.0} | change
    with pytest.raises(InputError, match=match):
        level_curves(**arguments)


@given(st.integers(-30, 30), st.integers(0, 1), st.floats(-0.9, 0.9))
@settings(max_examples=10)
def test_curves_do_not_depend_on_the_unit_of_torque(power, joint, share):
    factor = 4.0**power
    torque = share * two_r().gradient_bound()[joint]
    usual = level_curves(two_r(), joint, torque, tolerance=1e-3)
    other = level_curves(factor * two_r(), joint, factor * torque, tolerance=factor * 1e-3)
    assert np.array_equal(factor * usual.torques, other.torques)
    for one, two in zip(usual.curves, other.curves, strict=True):
        assert np.array_equal(one, two)


@pytest.mark.parametrize("factor", [1e-6, 1.0, 1e6])
def test_the_default_tolerance_is_a_share_of_the_largest_torque(factor):
    potential = factor * two_r()
    for curve in level_curves(potential, 0, 5.0 * factor).curves:
        error = np.abs(potential.gradient(along(curve))[:, 0]) - 5.0 * factor
        assert np.abs(error).max() <= 1e-6 * factor
    with pytest.raises(InputError, match=r"accepted: a number >= .* \[N m\]"):
        level_curves(potential, 0, 5.0 * factor, tolerance=1e-10 * factor)
