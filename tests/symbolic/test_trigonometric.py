import re

import mpmath
import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from symbolic.errors import InputError
from symbolic.trigonometric import TrigonometricPolynomial
from verify.strategies import configurations

KINDS = ("float", "rational", "sympy")
X = sympy.Symbol("x", positive=True)


def coefficients(kind):
    eighths = st.integers(-40, 40)
    if kind == "float":
        return eighths.map(lambda i: i / 8) | st.floats(-5, 5).map(lambda x: round(x, 6))
    if kind == "rational":
        return st.builds(fmpq, eighths, st.integers(1, 9))
    return st.builds(lambda i, j: sympy.Rational(i, 8) + j * X, eighths, st.integers(-1, 1))


@st.composite
def polynomials(draw, n=None, kind=None, largest=2):
    """Polynomials given by unsorted rows of any sign, some of them twice, some of them zero."""
    n = n or draw(st.integers(1, 3))
    kind = kind or draw(st.sampled_from(KINDS))
    row = st.lists(st.integers(-largest, largest), min_size=n, max_size=n)
    rows = draw(st.lists(row, max_size=5))
    a, b = (
        np.array([draw(coefficients(kind)) for _ in rows], dtype=float if kind == "float" else "O")
        for _ in range(2)
    )
    return TrigonometricPolynomial(np.array(rows, dtype=int).reshape(-1, n), a, b)


def numeric(n=None):
    return st.sampled_from(KINDS[:2]).flatmap(lambda kind: polynomials(n, kind))


def pairs(n_values=(1, 2, 3)):
    return st.sampled_from(n_values).flatmap(lambda n: st.tuples(polynomials(n), polynomials(n)))


def value(f, q):
    """Evaluate term by term in fifty digits, x = 1/3."""
    total = mpmath.mpf(0)
    for k, a, b in zip(f.frequencies.tolist(), f.cos, f.sin, strict=True):
        phase = sum(mpmath.mpf(c) * x for c, x in zip(k, q, strict=True))
        total += number(a) * mpmath.cos(phase) + number(b) * mpmath.sin(phase)
    return total


def number(c):
    if isinstance(c, fmpq):
        return mpmath.mpf(int(c.p)) / int(c.q)
    if isinstance(c, sympy.Basic):
        return mpmath.mpmathify(sympy.N(c.subs(X, sympy.Rational(1, 3)), 30))
    return mpmath.mpf(float(c))


def same(f, g, data, tolerance=1e-13):
    q = [mpmath.mpf(float(x)) for x in data.draw(configurations(f.n))]
    assert abs(value(f, q) - value(g, q)) <= tolerance * (1 + abs(value(f, q)))


# -- normal form -------------------------------------------------------------------------------


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


# -- views -------------------------------------------------------------------------------------


@given(numeric(), st.data())
def test_text_reads_back_to_the_same_values(f, data):
    q = data.draw(configurations(f.n))
    code = re.sub(r"(\d) (q|cos|sin)", r"\1*\2", str(f))
    names = {name: float(x) for name, x in zip(f.names, q, strict=True)}
    read = eval(code, {"cos": np.cos, "sin": np.sin}, names)
    assert abs(read - f.evaluate(q)) < 1e-5 * (1 + f.sup_bound())


@given(polynomials(kind="sympy"))
@settings(max_examples=25)
def test_symbolic_text_reads_back_to_the_same_expression(f):
    q = sympy.symbols(f.names)
    code = re.sub(r"(\d) (q)", r"\1*\2", str(f))
    read = sympy.sympify(code, {"x": X, **dict(zip(f.names, q, strict=True))})
    assert sympy.expand(read - f.to_sympy(q)) == 0


@given(numeric(), st.data())
@settings(max_examples=25)
def test_sympy_has_the_same_values(f, data):
    q = data.draw(configurations(f.n))
    symbols = sympy.symbols(f.names, real=True)
    expression = sympy.sympify(f.to_sympy()).subs(dict(zip(symbols, map(float, q), strict=True)))
    assert abs(float(expression) - f.evaluate(q)) < 1e-11 * (1 + f.sup_bound())


def test_names_are_printed_and_kept():
    f = TrigonometricPolynomial([[1, -2]], [0.0], [-1.5], names=("shoulder", "elbow"))
    assert str(f) == "-1.5 sin(shoulder - 2 elbow)"
    assert f.derivative(0).names == f.names
    assert str(f.renamed(["a", "b"])) == "-1.5 sin(a - 2 b)"
    assert str(f - f) == "0"


def test_significant_drops_what_stands_for_rounding():
    a = np.array([fmpq(1), fmpq(1, 10**13), fmpq(1, 10**11)], "O")
    f = TrigonometricPolynomial([[1, 0], [0, 1], [1, 1]], a, np.array([fmpq(0)] * 3, "O"))
    assert f.significant().frequencies.tolist() == [[1, 0], [1, 1]]
    assert f.significant().is_exact
    assert len(f.significant(1e-14)) == 3
    symbolic = TrigonometricPolynomial([[1]], np.array([X], "O"), np.array([X], "O"))
    assert symbolic.significant() is symbolic


# -- refusals ----------------------------------------------------------------------------------


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


@given(polynomials(kind="rational"))
@settings(max_examples=25)
def test_float_coefficients_are_correctly_rounded(f):
    rounded = f.to_float()
    for exact, x in zip((*f.cos, *f.sin), (*rounded.cos, *rounded.sin), strict=True):
        with mpmath.workdps(60):
            assert float(number(exact)) == x
