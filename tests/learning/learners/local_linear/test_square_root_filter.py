"""Tests of the square-root filter against the normal equations and NumPy's least squares."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.local_linear.square_root_filter import SquareRootFilter


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), features=st.integers(1, 8), samples=st.integers(1, 20))
def test_equals_the_normal_equations(seed, features, samples):
    """Updates one by one, all at once, and the ridge normal equations agree."""
    rng = np.random.default_rng(seed)
    phi, targets = rng.normal(size=(samples, features)), rng.normal(size=(samples, 2))
    weights = rng.uniform(0, 2, samples)
    one_by_one = SquareRootFilter(features, 2, 1e-2)
    for row, target, weight in zip(phi, targets, weights, strict=True):
        one_by_one.update(row, target, weight)
    root = np.sqrt(weights)[:, None]
    at_once = SquareRootFilter.from_samples(root * phi, root * targets, 1e-2)
    information = (phi.T * weights) @ phi + 1e-2 * np.eye(features)
    expected = np.linalg.solve(information, (phi.T * weights) @ targets)
    assert np.abs(one_by_one.solution() - expected).max() < 1e-9
    assert np.abs(at_once.solution() - expected).max() < 1e-9
    assert np.abs(one_by_one.factor.T @ one_by_one.factor - information).max() < 1e-10


def test_stays_accurate_where_normal_equations_fail():
    """Polynomial features on a short interval: condition 1e10, squared beyond double."""
    x = np.linspace(1.0, 1.2, 60)
    phi = np.vander(x, 7)
    truth = np.arange(1.0, 8.0)
    filtered = SquareRootFilter(7, 1, 1e-30)
    for row in phi:
        filtered.update(row, np.array([row @ truth]))
    normal = np.linalg.solve(phi.T @ phi, phi.T @ (phi @ truth))
    error = np.abs(phi @ filtered.solution()[:, 0] - phi @ truth).max()
    assert error < 1e-9
    assert np.abs(filtered.solution()[:, 0] - truth).max() < 0.01 * np.abs(normal - truth).max()


def test_inputs_are_left_alone():
    row, target = np.ones(3), np.ones(1)
    SquareRootFilter(3, 1, 1.0).update(row, target)
    assert row.tolist() == [1.0] * 3
    assert target.tolist() == [1.0]
