"""Bounds and exactness of composed relations."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.residual_bound import residual_bound

shifts = st.floats(0.1, 0.3)


def shifted(potential, offset, sign, exact=False):
    """A relation of the 2R arm, its offset wrong by a little, with its bound."""
    A, Y = np.array([[-1.0, 0.0], [2.0, 1.0]]), np.array([1.0, 1.0])
    if sign > 0:
        A = np.eye(2)
    d = np.array([offset, 0.0])
    return SymmetryRelation(A, d, Y, exact=exact, bound=residual_bound(potential, A, d, Y))


@given(shifts, shifts, st.sampled_from([1, -1]), st.sampled_from([1, -1]), st.integers(0, 99))
@settings(max_examples=25)
def test_no_configuration_exceeds_the_bound_of_a_product(first, second, s, t, seed):
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    # errors that add up rather than cancel
    one = shifted(potential, first, s)
    other = shifted(potential, s * second, t)
    product = one @ other
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (2000, 2))
    error = potential.gradient(product.configuration(q)) - product.torque(potential.gradient(q))
    assert (np.abs(error).max(axis=0) <= product.bound + 1e-12).all()
    assert (np.abs(error).max(axis=0) > 1.05 * np.maximum(one.bound, other.bound)).any()


def test_a_product_is_exact_if_both_factors_are():
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    exact, other = shifted(potential, 0.0, -1, exact=True), shifted(potential, 0.1, 1)
    assert (exact @ exact).exact
    for product in (exact @ other, other @ exact, other @ other):
        assert not product.exact
