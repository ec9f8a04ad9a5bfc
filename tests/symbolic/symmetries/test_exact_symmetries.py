"""What is exact, what is only equal to rounding, and what is neither."""

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.exact_symmetries import exact_symmetries

ZERO = fmpq(0)


def cosines(frequencies, amplitudes):
    exact = isinstance(amplitudes[0], fmpq)
    return TrigonometricPolynomial(
        frequencies,
        np.array(amplitudes, dtype=object if exact else float),
        np.array([ZERO if exact else 0.0] * len(amplitudes), dtype=object if exact else float),
    )


@given(st.integers(10, 500))
@settings(max_examples=5)
def test_a_term_too_small_to_see_leaves_nothing_exact_but_the_identity(size):
    """cos q1 + cos q2 + 1e-13 cos(q1 + q2): 16 relations, and only one of them is exact."""
    tiny = fmpq(size, 10**15)
    U = cosines([[1, 0], [0, 1], [1, 1]], [fmpq(1), fmpq(1), tiny])
    group = exact_symmetries(U)
    assert group.order == 16
    assert [relation.is_identity for relation in group if relation.exact] == [True]
    assert not group.exact
    # and that is right: q1 -> -q1 alone is off by the term
    assert max(relation.bound.max() for relation in group) > 0.5e-15 * size
    q = np.random.default_rng(size).uniform(-np.pi, np.pi, (100, 2))
    for relation in group:
        torque = U.to_float().gradient(q)
        error = U.to_float().gradient(relation.configuration(q)) - relation.torque(torque)
        assert (np.abs(error).max(axis=0) <= relation.bound + 1e-14).all()
    whole = exact_symmetries(U, neglected=0.0)
    assert whole.order < 16


def test_a_tiny_term_of_other_joints_spoils_the_proofs_of_these():
    """Blocks {1} and {2, 3}; what was left out couples them."""
    U = cosines(
        [[1, 0, 0], [0, 1, 0], [0, 1, 1], [1, 0, 1]], [fmpq(2), fmpq(1), fmpq(3), fmpq(1, 10**14)]
    )
    group = exact_symmetries(U)
    assert sum(relation.exact for relation in group) == 1


@given(st.floats(1e-11, 1e-2), st.booleans())
@settings(max_examples=30)
def test_amplitudes_that_differ_by_more_than_rounding_are_different(difference, exact):
    """cos(q1 + q2) + (1 + x) cos(q1 - q2) has the symmetries of unequal waves."""
    one, more = 1.0, 1.0 + difference
    if exact:
        one, more = fmpq(1), fmpq(1) + fmpq(int(difference * 1e15), 10**15)
    waves = [[1, 1], [1, -1]]
    group = exact_symmetries(cosines(waves, [one, more]))
    unequal = exact_symmetries(cosines(waves, [1.0, 2.0]))
    equal = exact_symmetries(cosines(waves, [1.0, 1.0]))
    assert group.order == unequal.order < equal.order
    assert {tuple(r.Y) for r in group} == {tuple(r.Y) for r in unequal}


@pytest.mark.parametrize("difference", [0.0, 1e-15, 3e-14])
def test_amplitudes_equal_to_rounding_are_equal(difference):
    waves = [[1, 1], [1, -1]]
    assert exact_symmetries(cosines(waves, [1.0, 1.0 + difference])).order == 32
