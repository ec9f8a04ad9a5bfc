import mpmath
import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.testing.strategies import configurations
from tests.symbolic.polynomials.random_polynomials import (
    X,
    number,
    numeric,
    pairs,
    polynomials,
    value,
)


def same(f, g, data, tolerance=1e-13):
    q = [mpmath.mpf(float(x)) for x in data.draw(configurations(f.n))]
    assert abs(value(f, q) - value(g, q)) <= tolerance * (1 + abs(value(f, q)))


# -- algebra -----------------------------------------------------------------------------------


@given(pairs(), st.data())
@settings(max_examples=40)
def test_sum_and_difference_are_pointwise(pair, data):
    f, g = pair
    q = [mpmath.mpf(float(x)) for x in data.draw(configurations(f.n))]
    scale = 1 + abs(value(f, q)) + abs(value(g, q))
    assert abs(value(f + g, q) - value(f, q) - value(g, q)) < 1e-12 * scale
    assert abs(value(f - g, q) - value(f, q) + value(g, q)) < 1e-12 * scale


@given(polynomials())
@settings(max_examples=50)
def test_a_difference_to_itself_has_no_terms(f):
    assert len(f - f) == 0
    assert len(f + f * -1) == 0


@given(polynomials(), st.data())
@settings(max_examples=40)
def test_scaling_is_pointwise_for_every_kind_of_number(f, data):
    factor = data.draw(st.sampled_from([3, -2, 0.5, fmpq(2, 3), sympy.Rational(-1, 4), X]))
    q = [mpmath.mpf(float(x)) for x in data.draw(configurations(f.n))]
    expected = number(factor) * value(f, q)
    for g in (f * factor, factor * f):
        assert abs(value(g, q) - expected) < 1e-12 * (1 + abs(expected))
    same(-f, f * -1, data)


def test_exact_and_float_polynomials_add_to_floats():
    exact = TrigonometricPolynomial([[1]], np.array([fmpq(1, 2)], "O"), np.array([fmpq(0)], "O"))
    both = exact + TrigonometricPolynomial([[1]], [0.25], [1.0])
    assert both.cos.dtype == float
    assert (both.cos[0], both.sin[0]) == (0.75, 1.0)


# -- derivatives -------------------------------------------------------------------------------


@given(numeric(), st.data())
@settings(max_examples=50)
def test_derivative_equals_mpmath(f, data):
    q = data.draw(configurations(f.n))
    j = data.draw(st.integers(0, f.n - 1))

    def along(t):
        return value(f, [mpmath.mpf(float(x)) if i != j else t for i, x in enumerate(q)])

    with mpmath.workdps(30):
        expected = mpmath.diff(along, mpmath.mpf(float(q[j])))
        points = [mpmath.mpf(float(x)) for x in q]
        found = value(f.derivative(j), points)
        assert abs(found - expected) < 1e-12 * (1 + abs(expected))


@given(numeric(), st.data())
def test_gradient_and_hessian_hold_the_derivatives(f, data):
    q = data.draw(configurations(f.n))
    scale = 1e-12 * (1 + 4 * f.sup_bound())
    first = [f.derivative(j) for j in range(f.n)]
    np.testing.assert_allclose(f.gradient(q), [d.evaluate(q) for d in first], atol=scale)
    second = [[d.derivative(j).evaluate(q) for j in range(f.n)] for d in first]
    np.testing.assert_allclose(f.hessian(q), second, atol=4 * scale)


def test_derivatives_stay_exact():
    f = TrigonometricPolynomial([[2, 1]], np.array([fmpq(1, 3)], "O"), np.array([fmpq(1, 7)], "O"))
    d = f.derivative(0)
    assert (d.cos[0], d.sin[0]) == (fmpq(2, 7), fmpq(-2, 3))


@given(polynomials(kind="sympy"), st.data())
@settings(max_examples=25)
def test_symbolic_derivative_equals_sympy(f, data):
    j = data.draw(st.integers(0, f.n - 1))
    q = sympy.symbols(f"q1:{f.n + 1}", real=True)
    difference = f.derivative(j).to_sympy(q) - sympy.diff(f.to_sympy(q), q[j])
    assert sympy.expand(difference) == 0


# -- values ------------------------------------------------------------------------------------


@given(numeric(), st.data())
def test_evaluate_equals_mpmath(f, data):
    q = data.draw(configurations(f.n))
    exact = value(f, [mpmath.mpf(float(x)) for x in q])
    assert abs(f.evaluate(q) - exact) < 1e-13 * (1 + 10 * f.sup_bound())


@given(numeric())
@settings(max_examples=40)
def test_batches_are_evaluated_point_by_point(f):
    q = np.random.default_rng(3).normal(size=(2, 3, f.n))
    tolerance = 1e-13 * (1 + f.sup_bound())
    for index in np.ndindex(2, 3):
        np.testing.assert_allclose(f(q)[index], f.evaluate(q[index]), atol=tolerance)
        np.testing.assert_allclose(f.gradient(q)[index], f.gradient(q[index]), atol=4 * tolerance)
        np.testing.assert_allclose(f.hessian(q)[index], f.hessian(q[index]), atol=9 * tolerance)
    assert f.hessian(np.zeros((0, f.n))).shape == (0, f.n, f.n)


@given(numeric(), st.data())
def test_complex_coefficients_rebuild_the_values(f, data):
    q = data.draw(configurations(f.n))
    wave = f.complex() * np.exp(1j * (f.frequencies @ q))
    total = np.sum(wave + np.conj(wave))
    np.testing.assert_allclose(total, f.evaluate(q), atol=1e-12 * (1 + f.sup_bound()))


@given(st.integers(1, 3).flatmap(lambda n: st.tuples(numeric(n), configurations(n, turns=9.0))))
def test_bounds_are_never_exceeded(case):
    f, q = case
    rounding = 1e-12 * (1 + f.sup_bound())
    assert abs(f.evaluate(q)) <= f.sup_bound() + rounding
    assert np.all(np.abs(f.gradient(q)) <= f.gradient_bound() + rounding)


def test_bounds_are_reached_by_a_single_wave():
    f = TrigonometricPolynomial([[1, -2]], [3.0], [4.0])
    assert f.sup_bound() == 5
    assert f.gradient_bound().tolist() == [5, 10]


# -- substitution ------------------------------------------------------------------------------


@given(numeric(), st.data())
def test_substitute_composes_with_the_affine_map(f, data):
    entries = st.lists(st.integers(-2, 2), min_size=f.n, max_size=f.n)
    A = np.array(data.draw(st.lists(entries, min_size=f.n, max_size=f.n)))
    d, q = data.draw(configurations(f.n)), data.draw(configurations(f.n))
    expected = f.evaluate(A @ q + d)
    atol = 1e-12 * (1 + f.sup_bound())
    np.testing.assert_allclose(f.substitute(A, d).evaluate(q), expected, atol=atol)


def test_substitute_finds_the_reflection_of_the_2r_arm():
    """q1' = -q1, q2' = 2 q1 + q2 keeps both torques, though not the potential up to sign."""
    U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.39, 6.13])
    V = U.substitute([[-1, 0], [2, 1]], [0, 0])
    assert V.frequencies.tolist() == [[1, 0], [1, 1]]
    assert V.sin.tolist() == [-18.39, 6.13]


@pytest.mark.parametrize("A", [[[0.5]], [[1, 0], [0, 1]], [[np.nan]]])
def test_substitute_refuses_what_is_not_an_integer_matrix(A):
    f = TrigonometricPolynomial([[1]], [1.0], [0.0])
    with pytest.raises(InputError, match="accepted: an integer matrix 1 x 1"):
        f.substitute(A, [0.0])


@pytest.mark.parametrize("d", [[0.0, 0.0], [np.nan], [np.inf]])
def test_substitute_refuses_wrong_offsets(d):
    f = TrigonometricPolynomial([[1]], [1.0], [0.0])
    with pytest.raises(InputError, match=r"d is .*; accepted: 1 finite angles"):
        f.substitute([[1]], d)


def test_significant_drops_what_stands_for_rounding():
    a = np.array([fmpq(1), fmpq(1, 10**13), fmpq(1, 10**11)], "O")
    f = TrigonometricPolynomial([[1, 0], [0, 1], [1, 1]], a, np.array([fmpq(0)] * 3, "O"))
    assert f.significant().frequencies.tolist() == [[1, 0], [1, 1]]
    assert f.significant().is_exact
    assert len(f.significant(1e-14)) == 3
    symbolic = TrigonometricPolynomial([[1]], np.array([X], "O"), np.array([X], "O"))
    assert symbolic.significant() is symbolic


def test_terms_too_small_for_a_float_are_still_terms():
    exact = np.array([fmpq(1), fmpq(1, 10**400), fmpq(0)], dtype=object)
    f = TrigonometricPolynomial([[1, 0], [0, 1], [1, 1]], exact, exact[::-1].copy())
    for values in (f.amplitudes(), f.complex()):
        assert values.shape == (len(f),)
    assert sorted(f.amplitudes()) == [0.0, 1.0, 1.0]
    assert len(f.significant()) == 2
    np.testing.assert_array_equal(f.gradient_bound(), [2.0, 1.0])
