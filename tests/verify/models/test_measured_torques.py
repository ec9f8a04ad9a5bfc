"""Measured torques against analytic ones, with known differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.models.measured_torques import disagreement

GRAVITY = GravityModel(load_robot("2r"))


@given(st.integers(0, 10**6), st.integers(1, 20), st.floats(-5, 5), st.floats(-5, 5))
def test_a_constant_difference_comes_back(seed, count, first, second):
    q = np.random.default_rng(seed).uniform(-3, 3, (count, 2))
    found = disagreement(q, GRAVITY.torque(q) + np.array([first, second]), GRAVITY)
    assert found.rows == count
    np.testing.assert_allclose(found.mean_by_joint, [first, second], atol=1e-12)
    np.testing.assert_allclose(found.rmse_by_joint, np.abs([first, second]), atol=1e-12)
    assert found.rmse == pytest.approx(np.hypot(first, second) / np.sqrt(2), abs=1e-12)
    assert found.largest == pytest.approx(max(abs(first), abs(second)), abs=1e-12)


def test_the_largest_difference_is_named_by_its_own_number():
    q = np.random.default_rng(0).uniform(-3, 3, (9, 2))
    torque = GRAVITY.torque(q)
    torque[2] += 7.0
    torque[5, 1] -= 3.0
    assert disagreement(q, torque, GRAVITY).row == 2
    left_out = np.arange(9) == 2
    found = disagreement(q, torque, GRAVITY, leave_out=left_out)
    assert (found.row, found.rows) == (5, 8)
    assert found.largest == pytest.approx(3.0)


def test_signs_and_degrees():
    q = np.random.default_rng(0).uniform(-90, 90, (9, 2))
    found = disagreement(q, GRAVITY.torque(np.deg2rad(q)), GRAVITY)
    assert found.rmse_degrees == pytest.approx(0.0, abs=1e-12)
    assert found.rmse > 1.0
    q = np.deg2rad(q)
    found = disagreement(q, -GRAVITY.torque(q), GRAVITY)
    assert found.rmse_opposite == pytest.approx(0.0, abs=1e-12)
    assert found.share == pytest.approx(2.0)


def test_no_torque_at_all():
    found = disagreement([[np.pi / 2, 0.0]], [[0.0, 0.0]], GRAVITY)
    assert found.share == 0.0
    assert found.rmse == pytest.approx(0.0, abs=1e-12)


def test_rows_of_one_pose_count_once():
    rng = np.random.default_rng(1)
    q = rng.uniform(-3, 3, (8, 2))
    torque = GRAVITY.torque(q) + rng.normal(size=(8, 2))
    counts = np.array([1, 60, 1, 1, 1, 1, 1, 1])
    rows = np.repeat(np.arange(8), counts)
    once, often = disagreement(q, torque, GRAVITY), disagreement(q[rows], torque[rows], GRAVITY)
    assert (often.rows, often.poses, once.poses) == (67, 8, 8)
    for field in ("rmse", "rmse_by_joint", "mean_by_joint", "share", "rmse_beside_constants"):
        np.testing.assert_allclose(getattr(often, field), getattr(once, field), rtol=1e-9)


def test_a_constant_is_told_from_the_rest():
    q = np.random.default_rng(2).uniform(-3, 3, (50, 2))
    wrong = 0.1 * np.random.default_rng(3).normal(size=(50, 2))
    found = disagreement(q, GRAVITY.torque(q) + wrong + np.array([0.0, 5.0]), GRAVITY)
    assert found.rmse > 3.0
    assert found.rmse_beside_constants == pytest.approx(np.std(wrong, axis=0).mean(), rel=0.05)
