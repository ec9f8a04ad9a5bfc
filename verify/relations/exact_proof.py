"""Exact proof that an affine map of the configurations is a primary symmetry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from flint import acb, arb, ctx, fmpq, fmpq_mat, fmpz_mat
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.kinematic_tree import rational
from isotorque.verify.relations.exact_numbers import (
    PRECISION_BITS,
    Exact,
    angle,
    exact_matrix,
    exact_vector,
    phase,
    times,
    upper,
)

OFFSET_ROUNDING = 2.0**-51
"""How far each printed offset may lie from the exact one and still be its rounding [rad]: one
unit in the last place of a float near pi, 4.4e-16. Correct rounding stays within half of it."""

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
        Upper bound on the distance of any offset, as printed, from an exact one modulo 2 pi
        [rad]; inf where no exact offset exists.
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
        Matrix (n, n), taken exactly: integers of any size, floats as the rationals they are.
    d
        Offsets (n,) [rad], as printed and taken exactly, whole turns included: some exact offset
        must lie within one unit in the last place of pi (2^-51 rad) of each.
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
    the unit 1. The rows that remain generate the lattice of the frequencies, and the step from the
    printed ``d`` to an exact one is the shortest that turns their phases right; its length is
    bounded in ball arithmetic. A printed ``d`` farther off is not what is proved, and not proved.

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
    'd is 0.25 rad from the exact offset'
    """
    exact = exact_potential(potential)
    flips = np.asarray(Y, dtype=np.int64)
    nothing = np.zeros(0, dtype=np.int64)
    k = exact.frequencies
    signs = np.array(
        [
            _sign(image, flipped)
            for image, flipped in zip(
                times(k.tolist(), exact_matrix(A)), map(tuple, (k * flips).tolist()), strict=True
            )
        ],
        dtype=np.int64,
    )
    if not signs.all():
        worst = _text(k[int(np.argmin(np.abs(signs)))])
        return Proof(False, f"A^T k is neither Y k nor -Y k at k = {worst}", nothing, np.inf)
    units = _units(exact, signs, flips)
    for row, unit in zip(k, units, strict=True):
        if unit is None:
            return Proof(False, f"|C_Yk| differs from |C_k| at k = {_text(row)}", signs, np.inf)
    generators = _generators(k, [unit for unit in units if unit is not None])
    if generators is None:
        return Proof(False, "the phases admit no offset d", signs, np.inf)
    error = _offset_error(generators, exact_vector(d))
    if not error <= OFFSET_ROUNDING:
        return Proof(False, f"d is {error:.3g} rad from the exact offset", signs, error)
    return Proof(True, "", signs, error)


def _sign(image: tuple[Exact, ...], flipped: tuple[int, ...]) -> int:
    if image == flipped:
        return 1
    return -1 if image == tuple(-x for x in flipped) else 0


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


def _generators(
    frequencies: NDArray[np.int64], units: list[Gaussian]
) -> list[tuple[list[int], Gaussian]] | None:
    """Row-reduce (k | u_k) over Z: return what is left, None where no d has exp(i k.d) = u_k."""
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
                return None
    return list(pivots.values())


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


def _offset_error(generators: list[tuple[list[int], Gaussian]], d: list[Exact]) -> float:
    """Bound the largest entry of the shortest step from ``d`` to an exact offset.

    With the generators as rows of H and r what their phases lack, the step is
    ``H^T (H H^T)^-1 r``: then ``H (d + step)`` are the exact phases, and with them those of all
    frequencies, which are integer combinations of the generators.
    """
    if not generators:
        return 0.0
    H = fmpq_mat(fmpz_mat([row for row, _ in generators]))
    inverse = (H.transpose() * (H * H.transpose()).inv()).tolist()
    with ctx.workprec(PRECISION_BITS):
        printed = [angle(x) for x in d]
        lacking = []
        for row, (x, y) in generators:
            at = phase(row, printed)
            lacking.append((acb(arb(x), arb(y)) * acb(at.cos(), -at.sin())).arg())
        steps = [
            sum((arb(x) * r for x, r in zip(row, lacking, strict=True)), arb(0)) for row in inverse
        ]
        return max(upper(abs(step)) for step in steps)


def _text(k: NDArray[np.int64]) -> str:
    return "(" + ", ".join(str(int(x)) for x in k) + ")"
