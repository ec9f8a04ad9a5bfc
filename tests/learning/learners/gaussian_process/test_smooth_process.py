"""Tests of Gaussian processes of long length scale: against many digits, and how equivariant."""

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from isotorque.learning.export.forms.torque_form import largest_difference
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.gaussian_process import smooth_process
from isotorque.learning.learners.gaussian_process.smooth_process import kernel_waves, smooth_mean
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.gaussian_process.symmetric_kernel import distinct_rows
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.learners import planar_arm
from tests.learning.learners.random_groups import groups, worst_asymmetry


@settings(max_examples=40)
@given(group=groups(), length=st.floats(1.0, 50.0), seed=st.integers(0, 2**32 - 1))
def test_waves_are_the_kernel(group, length, seed):
    rows, weights = distinct_rows(group.A_sat)
    found = kernel_waves(rows, weights, length)
    assume(found is not None)
    kappa, variance = found
    y = np.random.default_rng(seed).uniform(-np.pi, np.pi, (20, group.rank))
    expected = np.exp(-(1 - np.cos(y @ rows.T)) @ weights / length**2)
    assert np.abs(np.cos(y @ kappa.T) @ variance - expected).max() < 1e-13
    assert (variance > 0).all()


def exact_mean(coordinates, output, length, noise, q, values, queries):
    """The mean of the process in 60 digits, from the definition of its kernel (B = 1)."""
    two, order = mpmath.mpf(length) ** 2, coordinates.order
    # as Python's whole numbers, so that all products are of many digits
    A_all = np.rint(coordinates.A_sat).astype(int).astype(object)
    half_turns = np.rint(coordinates.d_sat / np.pi).astype(int).astype(object)
    signs = np.rint(coordinates.Y[:, output]).astype(int).tolist()
    digits = np.vectorize(mpmath.mpf, otypes=[object])
    q, queries = digits(q), digits(queries)

    def kernel(a, b):
        total = mpmath.mpf(0)
        for A, turns, sign in zip(A_all, half_turns, signs, strict=True):
            away = A @ a + turns * mpmath.pi - b
            phases = A_all.reshape(-1, coordinates.rank) @ away
            total += sign * mpmath.exp(-sum(1 - mpmath.cos(x) for x in phases) / order / two)
        return total

    gram = mpmath.matrix([[kernel(a, b) for b in q] for a in q])
    for i in range(len(q)):
        gram[i, i] += mpmath.mpf(noise)
    weights = mpmath.lu_solve(gram, mpmath.matrix([float(v) for v in values]))
    sums = [sum(w * kernel(x, b) for w, b in zip(weights, q, strict=True)) for x in queries]
    return np.array([float(x) for x in sums])


@pytest.mark.parametrize("length", [8.0, 30.0])
@pytest.mark.parametrize("symmetric", [True, False])
def test_mean_in_many_digits(length, symmetric):
    """Errors of 3e-5 of the amplitude (noise 1e-9): that far doubles determine it."""
    group = planar_arm.group() if symmetric else None
    coordinates = SymmetryCoordinates.of(group, 2)
    rng = np.random.default_rng(3)
    q, queries = rng.uniform(-np.pi, np.pi, (7, 2)), rng.uniform(-np.pi, np.pi, (4, 2))
    values, noise = planar_arm.torque(q)[:, 1], 1e-9
    found = smooth_mean(coordinates, 1, length, noise, q, values).evaluate(queries)
    with mpmath.workdps(60):
        expected = exact_mean(coordinates, 1, length, noise, q, values, queries)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@settings(max_examples=20)
@given(group=groups(), seed=st.integers(0, 2**32 - 1))
def test_equivariant(group, seed):
    rng = np.random.default_rng(seed)
    q, labels = rng.uniform(-np.pi, np.pi, (2, 8, group.n))
    learner = SymmetricGaussianProcess(0.01, length_scale=20.0, group=group).fit(q, labels)
    assume(any(found is not None for found in learner.waves_))
    assert worst_asymmetry(learner.predict, group, q[:4] + 0.1, least=0.1) < 1e-12


def test_the_same_mean_as_the_sum_of_covariances(monkeypatch):
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, 2))
    torque, queries = planar_arm.torque(q), q + 0.5
    settings = {"noise": 0.05, "group": planar_arm.group()}
    waves = SymmetricGaussianProcess(**settings).fit(q, torque)
    assert all(found is not None for found in waves.waves_)
    monkeypatch.setattr(smooth_process, "MOST_WAVES", 0)
    sums = SymmetricGaussianProcess(**settings).fit(q, torque)
    assert all(found is None for found in sums.waves_)
    size = np.abs(torque).max()
    assert np.abs(waves.predict(queries) - sums.predict(queries)).max() < 1e-4 * size
    assert largest_difference(torque_form(waves), waves.predict) < 1e-12 * size
    mean, deviation = waves.predict(queries, return_std=True)
    np.testing.assert_array_equal(mean, waves.predict(queries))
    assert deviation.shape == mean.shape


def test_rows_that_are_no_integers_and_too_many_waves_are_left_alone():
    assert kernel_waves(np.array([[1.0, 0.3]]), np.ones(1), 20.0) is None
    assert kernel_waves(np.eye(7), np.ones(7), 0.5) is None


@pytest.mark.slow
def test_no_digits_are_lost_with_seven_coordinates():
    """Waves of less than 1e-12 of the variance are left out, and the model stays as good."""
    gravity = GravityModel(load_robot("panda"))
    group = primary_symmetries(gravity.potential)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (180, 7))
    learner = SymmetricGaussianProcess(group=group).fit(q, gravity.torque(q))
    assert [found is not None for found in learner.waves_[1:4]] == [True] * 3
    size = np.abs(gravity.torque(q)).max()
    assert largest_difference(torque_form(learner), learner.predict) < 1e-12 * size
    assert np.abs(learner.predict(q) - gravity.torque(q)).max() < 1e-3 * size
