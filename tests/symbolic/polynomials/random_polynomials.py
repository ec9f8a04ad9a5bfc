"""Hypothesis strategies for trigonometric polynomials of every kind, and their values."""

from __future__ import annotations

import mpmath
import numpy as np
import sympy
from flint import fmpq
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

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
