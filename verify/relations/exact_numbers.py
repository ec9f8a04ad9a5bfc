"""Numbers as they are written: floats as the rationals they are, angles modulo a turn in balls."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np
from flint import arb, ctx, fmpq, fmpq_mat, fmpz_mat
from numpy.typing import ArrayLike

from isotorque.symbolic.common.errors import InputError

PRECISION_BITS = 128
"""Bits of the balls; reducing an angle modulo a turn takes as many more as it has whole turns."""

Exact: TypeAlias = int | Any
"""An integer of any size, or a rational (``flint.fmpq``) that is none."""


def exact(value: Any) -> Exact:
    """Return a finite number exactly: an int where it is one, otherwise a rational.

    Raises
    ------
    InputError
        If it is not a finite number.

    Examples
    --------
    >>> exact(2.0**70) == 2**70, exact(0.375)
    (True, 3/8)
    """
    if isinstance(value, fmpq):
        return int(value.p) if value.q == 1 else value
    if isinstance(value, int | np.integer):
        return int(value)
    number = float(value)
    if not np.isfinite(number):
        raise InputError("claim", "number", value, "a finite number")
    numerator, denominator = number.as_integer_ratio()
    return numerator if denominator == 1 else fmpq(numerator, denominator)


def exact_vector(values: ArrayLike | Sequence[Exact]) -> list[Exact]:
    """Return numbers (n,) exactly, integers of any size among them."""
    return [exact(x) for x in np.array(values, dtype=object)]


def exact_matrix(values: ArrayLike) -> list[list[Exact]]:
    """Return a matrix (n, n) exactly, as rows."""
    return [exact_vector(row) for row in np.array(values, dtype=object)]


def times(rows: Sequence[Sequence[Exact]], matrix: list[list[Exact]]) -> list[tuple[Exact, ...]]:
    """Return the products ``row @ matrix``, exactly and without overflow.

    Examples
    --------
    >>> times([(1, 1)], [[2**63, 0], [2**63, fmpq(1, 2)]])
    [(18446744073709551616, 1/2)]
    """
    entries = [x for row in matrix for x in row]
    if all(isinstance(x, int) for row in (entries, *rows) for x in row):
        largest = max((abs(x) for row in rows for x in row), default=0)
        if max(largest, 1) * max(sum(map(abs, entries)), 1) < 2**62:  # neither does a sum
            factor = np.array(matrix, dtype=np.int64)
            return [tuple(row) for row in (np.array(rows, dtype=np.int64) @ factor).tolist()]
        whole = fmpz_mat([list(row) for row in rows]) * fmpz_mat(matrix)
        return [tuple(map(int, row)) for row in whole.tolist()]
    product = fmpq_mat([list(row) for row in rows]) * fmpq_mat(matrix)
    return [tuple(map(exact, row)) for row in product.tolist()]


def over_one_denominator(matrix: list[list[Exact]]) -> tuple[list[list[int]], int]:
    """Return integers and what all of them are to be divided by.

    Examples
    --------
    >>> over_one_denominator([[1, exact(0.25)], [exact(1.5), 0]])
    ([[4, 1], [6, 0]], 4)
    """
    divisor = math.lcm(*(int(x.q) for row in matrix for x in row if isinstance(x, fmpq)))
    return [[int(x * divisor) for x in row] for row in matrix], divisor


def maps(matrix: list[list[Exact]], offset: list[Exact], point: Sequence[Exact]) -> list[Exact]:
    """Return ``matrix @ point + offset``, exactly."""
    return [exact(_dot(row, point) + t) for row, t in zip(matrix, offset, strict=True)]


def _dot(row: Sequence[Exact], column: Sequence[Exact]) -> Exact:
    return sum(x * y for x, y in zip(row, column, strict=True) if x and y)


def angle(value: Exact) -> arb:
    """Return an angle modulo 2 pi in a ball, about as sharp however many turns it has.

    Examples
    --------
    >>> print(angle(exact(2e300 * np.pi)).str(12, radius=False))
    2.25091309216
    """
    size = abs(value)
    bits = (int(size.floor()) if isinstance(size, fmpq) else size).bit_length()
    with ctx.workprec(PRECISION_BITS + bits):
        ball = arb(value)
        if size > 3:
            turn = 2 * arb.pi()
            ball = ball - turn * ((ball / turn).mid() + 0.5).mid().floor().unique_fmpz()
    return ball


def phase(frequency: Iterable[int], angles: Sequence[arb]) -> arb:
    """Return k.angles for an integer frequency k."""
    return sum((c * x for c, x in zip(frequency, angles, strict=True) if c), arb(0))


def upper(ball: arb) -> float:
    """Return a float that is not below any number of the ball."""
    return 0.0 if ball == 0 else float(np.nextafter(float(ball.upper()), np.inf))


def lower(ball: arb) -> float:
    """Return a float that is not above any number of the ball."""
    return 0.0 if ball == 0 else float(np.nextafter(float(ball.lower()), -np.inf))


def nearest(ball: arb) -> float:
    """Return the float in the middle of a ball."""
    return float(ball.mid())
