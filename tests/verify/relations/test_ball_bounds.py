"""Bounds hold for every configuration, and are sharp where they can be."""

from __future__ import annotations

import mpmath
import numpy as np
from flint import fmpq
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.relations.ball_bounds import (
    certified_error,
    learned_map_bound,
    relation_error_bound,
)
from isotorque.verify.testing import strategies

FEW = settings(
    max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


def errors(potential, relation, q):
    image = potential.gradient(relation.configuration(q))
    return np.abs(image - relation.torque(potential.gradient(q)))


@FEW
@given(st.data())
def test_no_configuration_exceeds_the_bound(data):
    arm = data.draw(strategies.known_arms(1, 3, planted=None))
    n = arm.gravity.n
    A = data.draw(st.lists(st.integers(-2, 2), min_size=n * n, max_size=n * n))
    relation = SymmetryRelation(
        np.reshape(A, (n, n)), data.draw(strategies.configurations(n)), np.ones(n)
    )
    potential = arm.gravity.potential
    bound = relation_error_bound(relation.A, relation.d, relation.Y, potential)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (500, n))
    assert np.all(errors(potential, relation, q).max(axis=0) <= bound + 1e-12)


def test_the_bound_is_reached_where_phases_are_free(two_link):
    potential = two_link.gravity.potential
    relation = SymmetryRelation([[-1, 0], [2, 1]], [0.3, -0.2], [1, 1])
    bound = relation_error_bound(relation.A, relation.d, relation.Y, potential)
    grid = np.stack(np.meshgrid(*[np.linspace(-np.pi, np.pi, 400)] * 2), axis=-1).reshape(-1, 2)
    assert np.all(errors(potential, relation, grid).max(axis=0) > 0.999 * bound)


@FEW
@given(st.data())
def test_no_configuration_of_the_box_exceeds_the_learned_bound(data):
    arm = data.draw(strategies.known_arms(1, 3))
    true = data.draw(strategies.relations(arm.group))
    n, seed = true.n, data.draw(st.integers(0, 99))
    rng = np.random.default_rng(seed)
    A = true.A + 1e-2 * rng.normal(size=(n, n))
    relation = SymmetryRelation(A, true.d + 1e-2 * rng.normal(size=n), true.Y)
    center, half = rng.uniform(-np.pi, np.pi, n), rng.uniform(0, 2, n)
    bound = learned_map_bound(
        A, relation.d, true.Y, arm.gravity.potential, center=center, half_widths=half
    )
    q = center + rng.uniform(-1, 1, (500, n)) * half
    assert np.all(errors(arm.gravity.potential, relation, q).max(axis=0) <= bound)


def test_leaving_out_the_matrix_error_would_break_the_learned_bound(two_link):
    A = np.array([[-1.01, 0.0], [2.0, 1.0]])
    potential = two_link.gravity.potential
    naive = relation_error_bound(np.round(A), [0, 0], [1, 1], potential)
    full = learned_map_bound(A, [0, 0], [1, 1], potential)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (2000, 2))
    found = errors(potential, SymmetryRelation(A, [0, 0], [1, 1]), q).max(axis=0)
    assert np.all(found > naive)
    assert np.all(found <= full)
    assert np.all(found > 0.5 * full)


def test_certified_errors_see_what_floats_cannot():
    potential = TrigonometricPolynomial(
        [[1]], np.array([fmpq(0)], dtype=object), np.array([fmpq(1, 3)], dtype=object)
    )
    shift, q = 1e-17, 0.7
    found = certified_error([[1]], [shift], [1], potential, [q])[0]
    with mpmath.workdps(50):
        angle = mpmath.mpf(q)
        expected = abs(mpmath.cos(angle + mpmath.mpf(shift)) - mpmath.cos(angle)) / 3
    assert 0 < found <= float(expected)
    assert found > 0.999 * float(expected)
    assert certified_error([[1]], [0.0], [1], potential, [q])[0] == 0.0


@FEW
@given(st.floats(0.05, 0.45), st.floats(0.5, 60.0), st.floats(-30.0, 30.0))
def test_waves_that_run_out_of_step_differ_by_up_to_twice_their_size(error, width, middle):
    """sin q under q -> (1 + error) q: in a wide box both waves meet with opposite signs."""
    potential = TrigonometricPolynomial([[1]], [0.0], [1.0])
    bound = learned_map_bound(
        [[1 + error]], [0.0], [1], potential, center=[middle], half_widths=[width]
    )
    q = np.linspace(middle - width, middle + width, 20001)[:, None]
    found = errors(potential, SymmetryRelation([[1 + error]], [0.0], [1]), q).max(axis=0)
    assert np.all(found <= bound * (1 + 1e-12))
    assert np.all(bound <= 2.0 + 1e-12)
    if width * error > 2 * np.pi:
        assert np.all(bound > 1.9)
