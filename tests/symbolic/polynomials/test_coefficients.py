import mpmath
import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.coefficients import (
    coefficient_arrays,
    is_zero,
    to_float,
    to_sympy,
)
from tests.symbolic.polynomials.random_polynomials import X, number, polynomials


@given(polynomials(kind="rational"))
@settings(max_examples=25)
def test_float_coefficients_are_correctly_rounded(f):
    rounded = f.to_float()
    for exact, x in zip((*f.cos, *f.sin), (*rounded.cos, *rounded.sin), strict=True):
        with mpmath.workdps(60):
            assert float(number(exact)) == x


def test_the_richest_kind_wins():
    floats, exact = [0.5, 1.0], [fmpq(1, 3), fmpq(2)]
    a, b = coefficient_arrays(2, exact, exact)
    assert all(isinstance(x, fmpq) for x in (*a, *b))
    a, b = coefficient_arrays(2, floats, exact)
    assert (a.dtype, b.dtype) == (np.float64, np.float64)
    assert b[0] == 1 / 3
    a, b = coefficient_arrays(2, exact, [X, 0.5])
    assert all(isinstance(x, sympy.Basic) for x in (*a, *b))
    assert a[0] == sympy.Rational(1, 3)
    a, b = coefficient_arrays(2, [1, 2], np.array([3, 4], dtype=object))
    assert a.tolist() == [fmpq(1), fmpq(2)]
    assert b.tolist() == [fmpq(3), fmpq(4)]
    (a,) = coefficient_arrays(2, [1, 2])
    assert a.dtype == np.float64


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_floats_survive_as_they_are(x):
    (a,) = coefficient_arrays(1, [x])
    assert a[0] == x
    assert to_sympy(fmpq(*x.as_integer_ratio())) == sympy.Rational(*x.as_integer_ratio())


def test_zero_is_recognised_in_every_kind():
    for zero in (0.0, -0.0, fmpq(0), sympy.Integer(0), X - X, (X + 1) ** 2 - X**2 - 2 * X - 1):
        assert is_zero(zero)
    for other in (5e-324, fmpq(1, 10**400), sympy.Rational(1, 7), X, (X + 1) ** 2 - X**2):
        assert not is_zero(other)


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ([1.0], "shape of coefficients"),
        ([[1.0, 2.0]], "shape of coefficients"),
        ([1.0, np.inf], "coefficients"),
        ([fmpq(1), np.nan], "coefficients"),
        ([1.0, 1j], "coefficients"),
        ([fmpq(1), "one"], "coefficient"),
    ],
)
def test_what_is_no_list_of_two_numbers_is_refused(values, field):
    with pytest.raises(InputError, match=f"trigonometric polynomial: {field} is "):
        coefficient_arrays(2, values)


def test_a_symbol_is_not_a_float():
    with pytest.raises(InputError, match="coefficient is x; accepted: a number"):
        to_float(X)
