"""Bounds on the error of a relation: never exceeded, and reached where waves can meet."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.residual_bound import residual_bound
from tests.symbolic.gravity.small_potentials import potentials


def error(potential, A, d, Y, q):
    relation = SymmetryRelation(A, d, Y)
    image = potential.gradient(relation.configuration(q))
    return np.abs(image - relation.torque(potential.gradient(q))).max(axis=0)


@given(potentials(max_joints=3), st.integers(0, 2**32 - 1), st.booleans())
def test_no_configuration_exceeds_the_bound_of_any_map(potential, seed, whole):
    rng = np.random.default_rng(seed)
    n = potential.n
    A = rng.integers(-2, 3, (n, n)).astype(float)
    if not whole:
        A = A + rng.normal(size=(n, n))
    d, Y = rng.uniform(-np.pi, np.pi, n), rng.choice([-1.0, 1.0], n)
    q = rng.uniform(-np.pi, np.pi, (400, n))
    assert (error(potential, A, d, Y, q) <= residual_bound(potential, A, d, Y) + 1e-12).all()


@given(st.floats(0.1, 20.0), st.floats(0.1, 20.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
@settings(max_examples=40)
def test_independent_waves_reach_the_bound(a, b, first, second):
    """A cos q1 + B cos(q1 + q2): both waves of the error peak at one configuration."""
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [a, b])
    d = np.array([first, second])
    exact = [2 * a * abs(np.sin(d[0] / 2)) + 2 * b * abs(np.sin(d.sum() / 2))]
    exact += [2 * b * abs(np.sin(d.sum() / 2))]
    bound = residual_bound(potential, np.eye(2), d, [1, 1])
    np.testing.assert_allclose(bound, exact, rtol=1e-9, atol=1e-12)
    peak = np.pi / 2 - d[0] / 2
    q = np.array([[peak, np.pi / 2 - d.sum() / 2 - peak], [peak, -np.pi / 2 - d.sum() / 2 - peak]])
    assert (error(potential, np.eye(2), d, [1, 1], q) >= (1 - 1e-9) * bound - 1e-12).all()
