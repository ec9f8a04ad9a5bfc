import numpy as np
import pytest
from scipy import stats

from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.testing.basis_functions import (
    Functions,
    angles,
    breaking_functions,
    waves,
)
from isotorque.learning.relations.testing.nested_models import compare, rank_of, scales


def line_and_parabola(count, rng):
    q = rng.uniform(-1, 1, (count, 1))
    small = Functions(np.concatenate([np.ones((count, 1)), q], axis=1), np.zeros((count, 2, 1)))
    return q, small, small.beside(Functions(q**2, np.zeros((count, 1, 1))))


def test_equals_the_textbook_f_test():
    rng = np.random.default_rng(0)
    q, small, large = line_and_parabola(30, rng)
    torque = 1.0 + 2.0 * q[:, 0] + 0.3 * q[:, 0] ** 2 + 0.1 * rng.normal(size=30)
    (scale,) = scales([large], torque[:, None], None)
    found = compare(small, large, torque, scale)
    squares = [np.polyfit(q[:, 0], torque, k, full=True)[1][0] for k in (1, 2)]
    statistic = (squares[0] - squares[1]) / (squares[1] / 27)
    assert found.p_value == pytest.approx(stats.f.sf(statistic, 1, 27), rel=1e-6)


def test_known_noise_makes_it_a_chi_square_test():
    rng = np.random.default_rng(1)
    q, small, large = line_and_parabola(25, rng)
    torque = q[:, 0] + 0.1 * rng.normal(size=25)
    (scale,) = scales([large], torque[:, None], MeasurementNoise(0.0, 0.1))
    found = compare(small, large, torque, scale)
    squares = [np.polyfit(q[:, 0], torque, k, full=True)[1][0] for k in (1, 2)]
    expected = stats.chi2.sf((squares[0] - squares[1]) / 0.01, 1)
    assert found.p_value == pytest.approx(expected, rel=1e-6)


def test_too_few_samples_are_no_test():
    rng = np.random.default_rng(2)
    q, small, large = line_and_parabola(3, rng)
    (scale,) = scales([large], q, None)
    assert compare(small, large, q[:, 0], scale) is None


def test_where_torques_are_steep_noisy_angles_count_less():
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (400, 1))
    torque = 5.0 * np.cos(q + 0.05 * rng.normal(size=q.shape)) + 0.02 * rng.normal(size=q.shape)
    functions = waves(q, np.array([[0], [1]]))
    (scale,) = scales([functions], torque, None)
    steep = np.abs(np.sin(q[:, 0])) > 0.9
    level = np.abs(np.sin(q[:, 0])) < 0.1
    assert scale.deviation[steep].mean() > 1.5 * scale.deviation[level].mean()


def test_slopes_are_derivatives():
    rng = np.random.default_rng(4)
    q, step = rng.uniform(-2, 2, (5, 3)), 1e-6
    frequencies = np.array([[1, -1, 0], [2, 0, 1], [0, 0, 0]])
    for make in (breaking_functions, angles, lambda x: waves(x, frequencies)):
        found = make(q)
        for joint in range(3):
            move = step * np.eye(3)[joint]
            slope = (make(q + move).values - make(q - move).values) / (2 * step)
            np.testing.assert_allclose(found.slopes[:, :, joint], slope, atol=1e-8)


def test_rank_counts_independent_functions():
    q = np.random.default_rng(5).uniform(-3, 3, (50, 2))
    assert rank_of(waves(q, np.array([[0, 0], [1, 0], [1, 0], [-1, 0]]))) == 3
