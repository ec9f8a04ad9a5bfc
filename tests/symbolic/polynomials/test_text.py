import re

import numpy as np
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.testing.strategies import configurations
from tests.symbolic.polynomials.random_polynomials import X, numeric, polynomials


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
