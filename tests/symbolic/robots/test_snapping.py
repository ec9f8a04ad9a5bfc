"""Snapping of angles, axes and rotation matrices."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from isotorque.symbolic.robots.rotations import rotation_from_rpy, unit_axis
from isotorque.symbolic.robots.snapping import (
    SNAP_ANGLE,
    clean_lengths,
    differs,
    rpy_from_rotation,
    snap_angle,
    snap_axis,
    snap_rotation,
)

any_angle = st.floats(-10.0, 10.0)
near_right = st.builds(lambda k, d: k * math.pi / 2 + d, st.integers(-6, 6), st.floats(-3e-5, 3e-5))
angles = st.one_of(any_angle, near_right)
triples = st.tuples(angles, angles, angles)
axes = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: max(map(abs, a)) > 1e-3)


@given(angles)
def test_an_angle_is_snapped_when_and_only_when_it_is_close(angle):
    snapped = snap_angle(angle)
    distance = abs(math.remainder(angle, math.pi / 2))
    assume(abs(distance - SNAP_ANGLE) > 1e-14)
    if distance <= SNAP_ANGLE:
        assert snapped == round(angle / (math.pi / 2)) * (math.pi / 2)
        assert abs(snapped - angle) <= SNAP_ANGLE + 1e-15
    else:
        assert snapped == angle


@given(angles)
def test_snapping_an_angle_twice_is_snapping_it_once(angle):
    assert snap_angle(snap_angle(angle)) == snap_angle(angle)


@given(triples)
def test_rotation_from_rpy_is_that_of_scipy(rpy):
    np.testing.assert_allclose(
        rotation_from_rpy(rpy), Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-14
    )


@given(st.tuples(*[st.integers(-8, 8)] * 3))
def test_right_angles_give_exact_rotations(turns):
    rotation = rotation_from_rpy(tuple(k * math.pi / 2 for k in turns))
    assert set(rotation.ravel()) <= {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(rotation @ rotation.T, np.eye(3))


@given(triples)
def test_roll_pitch_yaw_give_their_rotation_back(rpy):
    rotation = rotation_from_rpy(rpy)
    again = rotation_from_rpy(rpy_from_rotation(rotation))
    # near pitch = +-pi/2 roll is folded into yaw: exact up to twice the distance
    np.testing.assert_allclose(again, rotation, atol=2.1 * SNAP_ANGLE)
    if abs(math.cos(rpy[1])) > 2 * SNAP_ANGLE:
        np.testing.assert_allclose(again, rotation, atol=1e-9)


@given(triples)
def test_snapping_a_rotation_turns_it_by_no_more_than_three_angles_may(rpy):
    rotation = rotation_from_rpy(rpy)
    snapped, _, _ = snap_rotation(rotation)
    turn = Rotation.from_matrix(snapped @ rotation.T).magnitude()
    assert turn <= 3 * SNAP_ANGLE + 1e-9
    np.testing.assert_allclose(snapped @ snapped.T, np.eye(3), atol=1e-13)


@given(triples)
def test_a_snapped_rotation_is_left_alone(rpy):
    snapped, _, _ = snap_rotation(rotation_from_rpy(rpy))
    again, before, after = snap_rotation(snapped)
    distances = [abs(abs(math.remainder(a, math.pi / 2)) - SNAP_ANGLE) for a in before]
    assume(min(distances) > 1e-10)
    assert not differs(before, after)
    np.testing.assert_array_equal(again, snapped)


@given(st.tuples(*[st.floats(0.01, 1.5)] * 3))
def test_angles_far_from_right_keep_their_rotation_bit_for_bit(rpy):
    rotation = rotation_from_rpy(rpy)
    assume(np.abs(rotation).min() > 1e-10)
    snapped, before, after = snap_rotation(rotation)
    assert before == after
    np.testing.assert_array_equal(snapped, rotation)


@given(axes)
def test_an_axis_is_snapped_when_and_only_when_it_is_close(axis):
    unit = np.array(axis) / np.linalg.norm(axis)
    main = np.argmax(np.abs(unit))
    angle = math.asin(min(1.0, float(np.linalg.norm(np.delete(unit, main)))))
    assume(abs(angle - SNAP_ANGLE) > 1e-14)
    snapped = np.array(snap_axis(axis))
    if angle <= SNAP_ANGLE:
        expected = np.zeros(3)
        expected[main] = np.sign(unit[main])
        np.testing.assert_array_equal(snapped, expected)
    else:
        np.testing.assert_allclose(snapped, unit, atol=1e-12)


@given(axes, st.floats(1e-3, 1e3))
def test_a_unit_axis_has_length_one_and_keeps_its_direction(axis, stretch):
    unit = np.array(unit_axis(tuple(stretch * a for a in axis)))
    np.testing.assert_allclose(unit, np.array(axis) / np.linalg.norm(axis), atol=1e-12)
    assert unit_axis(tuple(unit)) == tuple(unit)


@pytest.mark.parametrize("angle", [1.5708, -1.5708, 3.1416, 1.57079632679, 0.999e-5, -3.14159])
def test_angles_as_people_round_them_are_snapped(angle):
    assert snap_angle(angle) != angle
    assert snap_angle(angle) % (math.pi / 2) == 0


@pytest.mark.parametrize("angle", [1.57, 3.14, 0.7853981633974483, 1.001e-5, 6.2832])
def test_other_angles_are_not(angle):
    assert snap_angle(angle) == angle


def test_noise_beside_an_angle_that_is_not_right_is_removed():
    noisy = rotation_from_rpy((0.0, 0.0, 0.3))
    noisy[2, 0], noisy[2, 1], noisy[2, 2] = 1e-16, -1e-16, 1 - 1e-16
    clean, before, after = snap_rotation(noisy)
    assert not differs(before, after)
    np.testing.assert_array_equal(clean[2], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(clean, rotation_from_rpy((0.0, 0.0, 0.3)), atol=1e-15)


def test_noise_is_measured_by_the_size_of_the_arm():
    lengths = np.array([0.3, 1e-13, -1e-16])
    np.testing.assert_array_equal(clean_lengths(lengths, 1.0), [0.3, 0.0, 0.0])
    np.testing.assert_array_equal(clean_lengths(lengths, 1e-2), [0.3, 1e-13, 0.0])
