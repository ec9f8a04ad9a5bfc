"""Numbers are exact, whatever their size; angles lose their turns and nothing else."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.relations.exact_numbers import angle, exact, lower, maps, times, upper

MANY = settings(max_examples=200, deadline=None, derandomize=True)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
NUMBERS = FINITE | st.integers(-(10**40), 10**40) | st.integers(-3, 3)


def fraction(value):
    return Fraction(int(value.p), int(value.q)) if isinstance(value, fmpq) else Fraction(value)


@MANY
@given(
    st.lists(st.lists(NUMBERS, min_size=2, max_size=2), min_size=2, max_size=2), NUMBERS, NUMBERS
)
def test_products_are_exact(matrix, x, y):
    rows = [[exact(value) for value in row] for row in matrix]
    (a, b), (c, d) = ([Fraction(value) for value in row] for row in matrix)
    x_, y_ = Fraction(x), Fraction(y)
    (product,) = times([(exact(x), exact(y))], rows)
    assert [fraction(value) for value in product] == [x_ * a + y_ * c, x_ * b + y_ * d]
    image = maps(rows, [exact(y), exact(x)], [exact(x), exact(y)])
    assert [fraction(value) for value in image] == [a * x_ + b * y_ + y_, c * x_ + d * y_ + x_]


@pytest.mark.parametrize("largest", [2**31, 2**61, 2**62, 2**63 - 1, 2**63])
def test_sums_near_the_largest_machine_integer_do_not_overflow(largest):
    assert times([(1, 1)], [[largest, 0], [largest, -largest]]) == [(2 * largest, -largest)]
    assert times([(2, 3)], [[largest], [largest]]) == [(5 * largest,)]


@MANY
@given(FINITE)
def test_angles_are_reduced_with_enough_digits(value):
    with mpmath.workdps(700), ctx.workprec(2200):
        turn = 2 * mpmath.pi
        true = mpmath.mpf(value) - turn * mpmath.nint(mpmath.mpf(value) / turn)
        reduced = angle(exact(value))
        off = abs(reduced - arb(mpmath.nstr(true, 620)))
        turns = off / (2 * arb.pi())
        near = abs(turns - (turns.mid() + 0.5).floor())
        assert upper(near) < 1e-37
        assert upper(reduced.rad()) < 1e-37


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(InputError, match="a finite number"):
        exact(value)


@MANY
@given(st.fractions())
def test_floats_enclose_a_ball(value):
    with ctx.workprec(128):
        ball = arb(fmpq(value.numerator, value.denominator))
        assert Fraction(lower(ball)) <= value <= Fraction(upper(ball))


def test_a_ball_of_everything_has_no_bound():
    assert not upper(arb("nan")) <= 1e308
    assert lower(arb("nan")) != 0.0
    assert upper(arb(10) ** 400) == np.inf
    assert upper(arb(10) ** -400) > 0.0
