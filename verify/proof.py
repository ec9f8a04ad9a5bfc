"""Exact proof that an affine map of the configurations is a primary symmetry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from flint import acb, arb, ctx, fmpq
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.kinematic_tree import rational
from symbolic.trigonometric import TrigonometricPolynomial

PRECISION_BITS = 128
OFFSET_ROUNDING = 1e-13
"""How far a printed phase k.d may lie from the exact one and still be its rounding [rad]."""

Gaussian = tuple[fmpq, fmpq]
"""A number of Q(i): real and imaginary part."""

ONE: Gaussian = (fmpq(1), fmpq(0))


@dataclass(frozen=True, eq=False)
class Proof:
    """The outcome of an attempt to prove a relation.

    Attributes
    ----------
    holds : bool
        Whether the relation is proved.
    reason : str
        Why not, in one line; empty where it is proved.
    signs : (m,) int array
        The signs s_k of condition (i), one per frequency; empty where (i) fails.
    offset_error : float
        Largest distance of exp(i k.d), as printed, from its exact value; inf where no exact
        offset exists.
    """

    holds: bool
    reason: str
    signs: NDArray[np.int64]
    offset_error: float


def exact_potential(potential: TrigonometricPolynomial) -> TrigonometricPolynomial:
    """Return the potential with rational coefficients: every float is a rational number.

    Raises
    ------
    InputError
        If coefficients contain symbols; nothing can be judged before numbers are put in.
    """
    if potential.is_symbolic:
        raise InputError(
            "potential", "coefficients", potential, "numbers (substitute the symbols first)"
        )
    if potential.is_exact:
        return potential
    return TrigonometricPolynomial(
        potential.frequencies,
        np.array([rational(x) for x in potential.cos], dtype=object),
        np.array([rational(x) for x in potential.sin], dtype=object),
        potential.names,
    )


def prove_relation(
    A: ArrayLike, d: ArrayLike, Y: ArrayLike, potential: TrigonometricPolynomial
) -> Proof:
    """Try to prove g(A q + d) = Y g(q) for every q, in exact arithmetic.

    Parameters
    ----------
    A
        Matrix (n, n).
    d
        Offsets (n,) [rad], as printed: an exact offset must round to them.
    Y
        Signs (n,), each +1 or -1.
    potential
        Gravity potential with rational or float coefficients.

    Returns
    -------
    Proof

    Notes
    -----
    The relation holds iff there are signs with (i) ``A^T k = s_k Y k`` and (ii)
    ``u_k := s_k C_{s_k Y k} / C_k = exp(i k.d)`` on the support of the potential. The ``u_k``
    are exact numbers of Q(i). An exact ``d`` exists iff they have modulus one and obey every
    integer relation of the frequencies; both are decided by row-reducing the pairs (k | u_k) over
    the integers, where the second column is multiplicative: each row that becomes zero must carry
    the unit 1. That the printed ``d`` rounds to an exact one is checked in ball arithmetic.

    References
    ----------
    Johansson, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic, 2017.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> prove_relation([[-1, 0], [2, 1]], [0, 0], [1, 1], U).holds
    True
    >>> prove_relation([[-1, 0], [2, -1]], [0, 0], [1, 1], U).reason
    'A^T k is neither Y k nor -Y k at k = (1, 1)'
    >>> prove_relation([[-1, 0], [2, 1]], [0, 0.25], [1, 1], U).reason
    'exp(i k.d) differs from its exact value by 0.249 at k = (1, 1)'
    """
    exact = exact_potential(potential)
    matrix = np.asarray(A, dtype=float)
    flips = np.asarray(Y, dtype=np.int64)
    nothing = np.zeros(0, dtype=np.int64)
    if not np.all(matrix == np.round(matrix)):
        return Proof(False, "A is not an integer matrix", nothing, np.inf)
    k = exact.frequencies
    image, flipped = k @ matrix.astype(np.int64), k * flips
    signs = np.where((image == flipped).all(axis=1), 1, 0)
    signs = np.where((image == -flipped).all(axis=1), -1, signs)
    if not signs.all():
        worst = _text(k[int(np.argmin(np.abs(signs)))])
        return Proof(False, f"A^T k is neither Y k nor -Y k at k = {worst}", nothing, np.inf)
    units = _units(exact, signs, flips)
    for row, unit in zip(k, units, strict=True):
        if unit is None:
            return Proof(False, f"|C_Yk| differs from |C_k| at k = {_text(row)}", signs, np.inf)
    complete = [unit for unit in units if unit is not None]
    if not _consistent(k, complete):
        return Proof(False, "the phases admit no offset d", signs, np.inf)
    error, at = _offset_error(k, complete, np.asarray(d, dtype=float))
    if error > OFFSET_ROUNDING:
        reason = f"exp(i k.d) differs from its exact value by {error:.3g} at k = {_text(k[at])}"
        return Proof(False, reason, signs, error)
    return Proof(True, "", signs, error)


def _units(
    potential: TrigonometricPolynomial, signs: NDArray[np.int64], flips: NDArray[np.int64]
) -> list[Gaussian | None]:
    """Return u_k = s_k C_{s_k Y k} / C_k per frequency, None where its modulus is not one."""
    amplitude: dict[tuple[int, ...], Gaussian] = {}
    for row, a, b in zip(potential.frequencies, potential.cos, potential.sin, strict=True):
        amplitude[tuple(row.tolist())] = (a, -b)  # 2 C_k; the factor cancels
        amplitude[tuple((-row).tolist())] = (a, b)
    units: list[Gaussian | None] = []
    for row, sign in zip(potential.frequencies, signs, strict=True):
        image = amplitude.get(tuple((sign * flips * row).tolist()))
        x, y = amplitude[tuple(row.tolist())]
        norm = x * x + y * y
        if image is None or image[0] * image[0] + image[1] * image[1] != norm:
            units.append(None)
            continue
        u, v = image
        s = fmpq(int(sign))
        units.append((s * (u * x + v * y) / norm, s * (v * x - u * y) / norm))
    return units


def _consistent(frequencies: NDArray[np.int64], units: list[Gaussian]) -> bool:
    """Say whether some d has exp(i k.d) = u_k for all k: row reduction of (k | u_k) over Z."""
    pivots: dict[int, tuple[list[int], Gaussian]] = {}
    for row, unit in zip(frequencies.tolist(), units, strict=True):
        current: tuple[list[int], Gaussian] = (row, unit)
        for column in range(frequencies.shape[1]):
            if not current[0][column]:
                continue
            pivot = pivots.pop(column, None)
            if pivot is None:
                pivots[column] = current
                break
            while current[0][column]:  # Euclid on the column, carried out on whole rows
                factor = current[0][column] // pivot[0][column]
                current = _minus(current, pivot, factor)
                if current[0][column]:
                    current, pivot = pivot, current
            pivots[column] = pivot
        else:
            if current[1] != ONE:
                return False
    return True


def _minus(
    row: tuple[list[int], Gaussian], pivot: tuple[list[int], Gaussian], factor: int
) -> tuple[list[int], Gaussian]:
    vector = [x - factor * y for x, y in zip(row[0], pivot[0], strict=True)]
    base = pivot[1] if factor < 0 else (pivot[1][0], -pivot[1][1])  # |u| = 1: inverse = conjugate
    unit = row[1]
    for bit in _bits(abs(factor)):
        if bit:
            unit = _times(unit, base)
        base = _times(base, base)
    return vector, unit


def _bits(number: int) -> Iterator[int]:
    while number:
        yield number & 1
        number >>= 1


def _times(x: Gaussian, y: Gaussian) -> Gaussian:
    return x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]


def _offset_error(
    frequencies: NDArray[np.int64], units: list[Gaussian], d: NDArray[np.float64]
) -> tuple[float, int]:
    """Return an upper bound on max |exp(i k.d) - u_k| and the index where it is reached."""
    errors = [0.0]
    with ctx.workprec(PRECISION_BITS):
        offsets = [arb(float(x)) for x in d]
        for row, (x, y) in zip(frequencies.tolist(), units, strict=True):
            phase = sum((c * t for c, t in zip(row, offsets, strict=True) if c), arb(0))
            errors.append(upper(abs(acb(phase.cos() - arb(x), phase.sin() - arb(y)))))
    worst = int(np.argmax(errors))
    return errors[worst], max(worst - 1, 0)


def upper(ball: arb) -> float:
    """Return a float that is not below any number of the ball."""
    return 0.0 if ball == 0 else float(np.nextafter(float(ball.upper()), np.inf))


def lower(ball: arb) -> float:
    """Return a float that is not above any number of the ball."""
    return 0.0 if ball == 0 else float(np.nextafter(float(ball.lower()), -np.inf))


def _text(k: NDArray[np.int64]) -> str:
    return "(" + ", ".join(str(int(x)) for x in k) + ")"
