"""Bounds, exactness and corrections of composed relations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
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


FLIP = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
TURN = SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1])


@given(st.integers(0, 2**32 - 1), st.booleans())
@settings(max_examples=40)
def test_relations_with_a_correction_hold_of_the_measured_torque_composed_and_inverted(
    seed, spring
):
    """Composed and inverted too; of gravity plus constants and springs, angles not wrapped."""
    rng = np.random.default_rng(seed)
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    correction = Correction(rng.normal(size=2), rng.normal(size=2) if spring else None)

    def measured(q):
        return potential.gradient(q) + correction.constant + correction.rate * q

    flip, turn = (r.of_measured(correction) for r in (FLIP, TURN))
    q = rng.uniform(-5.0, 5.0, (20, 2))
    for relation in (flip, turn, flip @ turn, turn @ flip, (flip @ turn).inverse()):
        there = relation.configuration(q)
        np.testing.assert_allclose(relation.torque(measured(q), q), measured(there), atol=1e-9)
        assert relation.correction.same_as(correction)
        plain = relation.of_measured(None)
        gravity = potential.gradient
        np.testing.assert_allclose(plain.torque(gravity(q)), gravity(there), atol=1e-9)
    assert correction.in_words() in str(flip)


def test_corrections_that_do_not_fit_are_refused():
    one, other = (TURN.of_measured(Correction([0.0, x])) for x in (0.5, 0.6))
    with pytest.raises(InputError, match="the same for relations that are composed"):
        one @ other
    with pytest.raises(InputError, match="the same for relations that are composed"):
        one @ FLIP
    with pytest.raises(InputError, match="the same for relations that are composed"):
        FLIP @ one
    with pytest.raises(InputError, match="configurations, as there is a correction"):
        one.torque([1.0, 2.0])
    with pytest.raises(InputError, match="joints of correction"):
        TURN.of_measured(Correction([0.5]))
    with pytest.raises(InputError, match="finite"):
        Correction([np.nan])
    with pytest.raises(InputError, match="shape of rate"):
        Correction([0.5], [0.5, 0.5])
    with pytest.raises(InputError, match="has a correction"):
        SymmetryGroup([one])  # its arrays would be applied to torques as they are
