import numpy as np
import pytest

from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.inactive_joints import (
    active_joints,
    fit_on_active_joints,
    stood_still,
)
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from tests.learning.static_data import known_potential, with_angle_noise


def test_joints_without_torque_are_left_out():
    potential, _ = known_potential("ur5")
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (12, 6))
    tau = potential.gradient(q)
    assert active_joints(tau, None).tolist() == [False, True, True, True, False, False]
    fit, unmoved = fit_on_active_joints(q, tau, None, 0.05)
    assert unmoved == []
    assert not fit.frequencies[:, [0, 4, 5]].any()
    assert (fit.potential - potential).sup_bound() < 1e-9


def test_torque_noise_does_not_make_a_joint_active():
    rng = np.random.default_rng(1)
    tau = np.stack([rng.normal(size=50), 1e-3 * rng.normal(size=50)], axis=1)
    assert active_joints(tau, None).all()
    assert active_joints(tau, MeasurementNoise(0.0, 1e-3)).tolist() == [True, False]


def test_a_joint_that_only_ever_rested_where_it_needs_no_torque_is_not_called_free():
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(2)
    first = rng.uniform(-np.pi, np.pi, 40)
    q = np.stack([first, -np.pi / 2 - first], axis=1)  # the forearm always hangs
    tau = potential.gradient(q)
    tau[:, 1] = 0.0
    with pytest.raises(Undetermined, match="torque on joint 2"):
        fit_on_active_joints(q, tau, None, 0.05)


def test_a_silent_joint_the_torque_depends_on_is_taken_in():
    # joint 2 turns the arm's plane; at its two rest angles it needs no torque
    potential = TrigonometricPolynomial([[1, 1], [1, -1]], [0.0, 0.0], [3.0, 3.0])
    rng = np.random.default_rng(3)
    q = np.stack([rng.uniform(-3, 3, 40), rng.choice([0.0, np.pi], 40)], axis=1)
    tau = potential.gradient(q)
    assert np.abs(tau[:, 1]).max() < 1e-12
    with pytest.raises(Undetermined, match="torque on joint 2"):
        fit_on_active_joints(q, tau, None, 0.05)


def test_a_joint_that_stood_still_is_named():
    potential, _ = known_potential("ur5")
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (20, 6))
    q[:, 5] = 0.7
    q[::2, 5] += 2 * np.pi
    assert stood_still(q, 5, None)
    assert not stood_still(q, 4, None)
    _, unmoved = fit_on_active_joints(q, potential.gradient(q), None, 0.05)
    assert unmoved == [5]


def test_a_joint_that_barely_moved_is_named_unless_it_can_be_judged():
    potential, _ = known_potential("ur5")
    rng = np.random.default_rng(5)
    q = rng.uniform(-np.pi, np.pi, (20, 6))
    q[:, 0] = 3e-4 * (rng.random(20) < 0.1)  # shaken twice by the others, held by nothing
    _, unmoved = fit_on_active_joints(q, potential.gradient(q), None, 0.05)
    assert unmoved == [0]
    q[:, 0] = 0.03 * (rng.random(20) < 0.1)  # far enough that not knowing has to be said
    with pytest.raises(Undetermined, match="torque on joint 1"):
        fit_on_active_joints(q, potential.gradient(q), None, 0.05)


def test_noise_leaves_a_free_joint_free():
    potential, _ = known_potential("ur5")
    for seed in range(5):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (60, 6))
        noisy = with_angle_noise(q, 0.1, rng)
        fit, unmoved = fit_on_active_joints(noisy, potential.gradient(q), None, 0.05)
        assert not fit.frequencies[:, [0, 4, 5]].any()
        assert unmoved == []


def test_no_torque_at_all_is_said():
    with pytest.raises(Undetermined, match="all given torques are zero"):
        fit_on_active_joints(np.ones((5, 2)), np.zeros((5, 2)), None, 0.05)
