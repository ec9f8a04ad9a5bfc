"""Tests of Levenberg-Marquardt against SciPy and linear algebra."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

from isotorque.learning.learners.network.levenberg_marquardt import Stop, levenberg_marquardt


@given(seed=st.integers(0, 2**32 - 1), ridge=st.sampled_from((0.0, 1e-3, 1.0)))
def test_linear_problems_are_solved_like_ridge_regression(seed, ridge):
    rng = np.random.default_rng(seed)
    matrix, right = rng.normal(size=(12, 4)), rng.normal(size=12)

    def residuals(x):
        return matrix @ x - right

    fit = levenberg_marquardt(
        residuals, lambda x: (residuals(x), matrix), np.zeros(4), ridge=ridge, least_progress=0.0
    )
    expected = np.linalg.solve(matrix.T @ matrix + ridge * np.eye(4), matrix.T @ right)
    assert np.abs(fit.x - expected).max() < 1e-5 * (1 + np.abs(expected).max())


@given(seed=st.integers(0, 2**32 - 1))
def test_ends_where_scipy_does(seed):
    """A sum of two exponentials, started near the truth."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 4, 30)
    truth = np.array([2.0, rng.uniform(0.3, 0.6), -1.0, rng.uniform(1.5, 3.0)])

    def model(x):
        return x[0] * np.exp(-x[1] * t) + x[2] * np.exp(-x[3] * t)

    data = model(truth) + 0.01 * rng.normal(size=30)

    def residuals(x):
        return model(x) - data

    def slopes(x):
        first, second = np.exp(-x[1] * t), np.exp(-x[3] * t)
        return np.stack([first, -t * x[0] * first, second, -t * x[2] * second], axis=1)

    start = truth * rng.uniform(0.8, 1.25, 4)
    ours = levenberg_marquardt(
        residuals, lambda x: (residuals(x), slopes(x)), start, least_progress=1e-12
    )
    theirs = least_squares(residuals, start, slopes, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    assert ours.rms**2 * 30 / 2 <= theirs.cost * (1 + 1e-6) + 1e-15


def test_stops_for_the_reason_it_says():
    def residuals(x):
        return np.array([x[0] - 1.0, 0.1])

    def jacobian(x):
        return residuals(x), np.array([[1.0], [0.0]])

    start = np.array([5.0])
    assert levenberg_marquardt(residuals, jacobian, start, tolerance=0.2).stop is Stop.REACHED
    assert levenberg_marquardt(residuals, jacobian, start, iterations=1).stop is Stop.ITERATIONS
    assert levenberg_marquardt(residuals, jacobian, start).stop is Stop.STALLED
    early = levenberg_marquardt(
        residuals, jacobian, start, held_out=lambda x: abs(x[0] - 5.0), patience=3
    )
    assert early.stop is Stop.HELD_OUT
    assert early.iterations == 3
    assert early.x == pytest.approx([5.0])


def test_more_parameters_than_residuals():
    """Singular normal equations: some solution, exactly fitted."""
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(3, 8))

    def residuals(x):
        return matrix @ x - 1.0

    fit = levenberg_marquardt(
        residuals, lambda x: (residuals(x), matrix), np.zeros(8), tolerance=1e-12
    )
    assert np.abs(residuals(fit.x)).max() < 1e-11
