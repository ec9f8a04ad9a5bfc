"""The search climbs to the maximum; shrinking is deterministic and minimal."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.verify.testing.counterexamples import largest_value, simplest_configuration


@pytest.mark.parametrize("n", [1, 2, 4])
def test_the_highest_peak_is_found(n):
    peak = np.linspace(-1.7, 2.3, n)

    def value(q):
        return np.cos(q - peak).sum(axis=1) + 0.5 * np.cos(2 * (q - peak)).sum(axis=1)

    best, at = largest_value(value, n)
    assert best == pytest.approx(1.5 * n, abs=1e-9)
    assert np.allclose(at, peak, atol=1e-4)


def test_a_gradient_is_used():
    calls = []

    def gradient(q):
        calls.append(q)
        return -np.sin(q - 1.0)

    best, _ = largest_value(lambda q: np.cos(q[:, 0] - 1.0), 1, gradient=gradient)
    assert best == pytest.approx(1.0)
    assert calls


def test_a_constant_has_its_value():
    assert largest_value(lambda q: np.zeros(len(q)), 3)[0] == 0.0


def test_no_joints_moved_unless_needed():
    found = simplest_configuration(lambda q: abs(q[2]) > 1.04, np.array([2.2, 0.3, -2.9]))
    assert found.tolist() == [0.0, 0.0, 1.1]


def test_narrow_failures_keep_the_digits_they_need():
    found = simplest_configuration(
        lambda q: abs(q[0] - 0.123456) < 1e-6, np.array([0.12345612345, 2.0])
    )
    assert found.tolist() == [0.123456, 0.0]


def test_a_failure_at_one_point_is_kept():
    point = np.array([0.1234567891234, -2.3456789123456])
    found = simplest_configuration(lambda q: np.array_equal(q, point), point)
    assert np.array_equal(found, point)


def test_the_same_search_finds_the_same():
    def fails(q):
        return q[0] + q[1] > 2.05

    found = [simplest_configuration(fails, np.array([2.0, 2.0])) for _ in range(2)]
    assert np.array_equal(*found)
    assert fails(found[0])
