import mpmath
import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from tests.symbolic.polynomials.random_polynomials import (
    X,
    coefficients,
    number,
    polynomials,
    value,
)


@given(polynomials())
@settings(max_examples=40)
def test_of_each_pair_one_frequency_whose_first_entry_is_positive(f):
    rows = [tuple(k) for k in f.frequencies.tolist()]
    assert len(set(rows)) == len(rows)
    for k in rows:
        leading = next((x for x in k if x), 0)
        assert leading >= 0


@given(polynomials())
@settings(max_examples=40)
def test_no_term_is_zero_and_constants_have_no_sine(f):
    for k, a, b in zip(f.frequencies.tolist(), f.cos, f.sin, strict=True):
        assert not (a == 0 and b == 0)
        assert any(k) or b == 0


@given(polynomials())
@settings(max_examples=40)
def test_coefficients_are_of_one_kind(f):
    everything = [*f.cos, *f.sin]
    for kind in (float, fmpq, sympy.Basic):
        found = [isinstance(c, kind) for c in everything]
        assert all(found) or not any(found)
    assert f.is_exact + f.is_symbolic + (f.cos.dtype == float) == 1


@given(st.data())
@settings(max_examples=40)
def test_rows_may_come_in_any_order_and_sign(data):
    n = data.draw(st.integers(1, 3))
    rows = data.draw(st.lists(st.lists(st.integers(-2, 2), min_size=n, max_size=n), max_size=5))
    a = data.draw(st.lists(coefficients("rational"), min_size=len(rows), max_size=len(rows)))
    b = data.draw(st.lists(coefficients("rational"), min_size=len(rows), max_size=len(rows)))
    flip = data.draw(st.lists(st.sampled_from([1, -1]), min_size=len(rows), max_size=len(rows)))
    order = data.draw(st.permutations(range(len(rows))))
    f = TrigonometricPolynomial(
        np.array(rows, int).reshape(-1, n), np.array(a, "O"), np.array(b, "O")
    )
    g = TrigonometricPolynomial(
        np.array([[flip[i] * x for x in rows[i]] for i in order], int).reshape(-1, n),
        np.array([a[i] for i in order], "O"),
        np.array([flip[i] * b[i] for i in order], "O"),
    )
    assert len(f - g) == 0
    q = [mpmath.mpf(i) / 7 for i in range(1, n + 1)]
    with mpmath.workdps(30):
        raw = TrigonometricPolynomial(np.zeros((0, n)), [], [])
        direct = value(raw, q)
        for k, x, y in zip(rows, a, b, strict=True):
            phase = sum(c * p for c, p in zip(k, q, strict=True))
            direct += number(x) * mpmath.cos(phase) + number(y) * mpmath.sin(phase)
        assert abs(value(f, q) - direct) < 1e-25


@pytest.mark.parametrize(
    ("frequencies", "cos", "sin", "field"),
    [
        ([1, 0], [1.0], [1.0], "shape of frequencies"),
        ([[0.5]], [1.0], [1.0], "frequencies"),
        ([[np.inf]], [1.0], [1.0], "frequencies"),
        ([[np.nan]], [1.0], [1.0], "frequencies"),
        ([[1]], [1.0, 2.0], [1.0], "shape of coefficients"),
        ([[1]], [1.0], [np.nan], "coefficients"),
        ([[1]], np.array([np.inf], dtype=object), [1.0], "coefficients"),
        ([[1]], [1j], [1.0], "coefficients"),
        ([[1]], ["a"], [1.0], "coefficients"),
        ([[1]], np.array([None], dtype=object), np.array([fmpq(1)], dtype=object), "coefficient"),
    ],
)
def test_bad_input_is_refused_by_name(frequencies, cos, sin, field):
    with pytest.raises(InputError, match=f"trigonometric polynomial: {field} is "):
        TrigonometricPolynomial(frequencies, cos, sin)


def test_names_must_match_the_variables():
    with pytest.raises(InputError, match="accepted: 2 names"):
        TrigonometricPolynomial([[1, 1]], [1.0], [1.0], names=("a",))


def test_points_must_have_the_right_length():
    f = TrigonometricPolynomial([[1, 1]], [1.0], [1.0])
    for question in (f.evaluate, f.gradient, f.hessian):
        with pytest.raises(InputError, match=r"configuration: shape is \(3,\); accepted"):
            question([1.0, 2.0, 3.0])


def test_symbols_have_no_value():
    f = TrigonometricPolynomial([[1]], np.array([X], dtype=object), np.array([X], dtype=object))
    with pytest.raises(InputError, match="substitute the symbols"):
        f.evaluate([0.0])


def test_sums_need_the_same_variables():
    f = TrigonometricPolynomial([[1]], [1.0], [1.0])
    with pytest.raises(InputError, match="number of variables is 2; accepted: 1"):
        f + TrigonometricPolynomial([[1, 1]], [1.0], [1.0])
    with pytest.raises(TypeError):
        f + 3
