"""Bounds on the torque error of a relation that hold for every configuration."""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpz_mat
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.relations.exact_numbers import (
    PRECISION_BITS,
    angle,
    exact_matrix,
    exact_vector,
    lower,
    maps,
    phase,
    upper,
)
from isotorque.verify.relations.exact_proof import exact_potential
from isotorque.verify.relations.residual import Residual


def relation_error_bound(
    A: ArrayLike, d: ArrayLike, Y: ArrayLike, potential: TrigonometricPolynomial
) -> NDArray[np.float64]:
    """Bound |g_i(A q + d) - Y_i g_i(q)| per joint, for every configuration q.

    Parameters
    ----------
    A
        Matrix (n, n), taken exactly: integers of any size, floats as the rationals they are.
    d
        Offsets (n,) [rad], taken exactly, whole turns included.
    Y
        Signs (n,).
    potential
        Gravity potential with rational or float coefficients.

    Returns
    -------
    (n,) array
        Upper bounds [N m], rounded up.

    Notes
    -----
    The error of each joint is itself a trigonometric polynomial, with the frequencies ``A^T k``
    and ``k``; it is expanded in ball arithmetic and the bound is the sum of its amplitudes. Where
    A satisfies condition (i) this is ``eps_i = sum_k |k_i| |residual_k|``.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> relation_error_bound([[-1, 0], [2, 1]], [0, 1e-6], [1, 1], U).round(8)
    array([6.1e-06, 6.1e-06])
    """
    signs = [int(y) for y in np.asarray(Y)]
    return Residual.of(exact_matrix(A), exact_vector(d), signs, exact_potential(potential)).bound()


def learned_map_bound(
    A: ArrayLike,
    d: ArrayLike,
    Y: ArrayLike,
    potential: TrigonometricPolynomial,
    *,
    center: ArrayLike | None = None,
    half_widths: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Bound the torque error of a learned map with a real matrix on a box of configurations.

    Parameters
    ----------
    A
        Real matrix (n, n), taken exactly, near an integer matrix A0: the one found by rounding.
    d, Y
        Offsets (n,) [rad], taken exactly, and signs (n,).
    potential
        Gravity potential with rational or float coefficients.
    center, half_widths
        The box |q - center| <= half_widths, (n,) each [rad]; one turn around zero by default.

    Returns
    -------
    (n,) array
        Upper bounds on |g_i(A q + d) - Y_i g_i(q)| for q in the box [N m], rounded up.

    Notes
    -----
    With ``dA = A - A0`` the bound is that of (A0, d) plus ``sum_k |k_i| amp_k min(2, |k.dA center|
    + sum_j |(dA^T k)_j| half_widths_j)``, in ball arithmetic. An error of the offset, dd, is part
    of ``d``: nothing in these bounds is measured from the exact offset.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> learned_map_bound([[-1, 1e-3], [2, 1]], [0, 0], [1, 1], U).round(4)
    array([0.077 , 0.0192])
    """
    rows = exact_matrix(A)
    n = potential.n
    whole = [[int(x) if isinstance(x, int) else int(x.round()) for x in row] for row in rows]
    middle = [0] * n if center is None else exact_vector(center)
    exact = exact_potential(potential)
    base = relation_error_bound(whole, d, Y, exact)
    with ctx.workprec(PRECISION_BITS):
        widths = (
            [arb.pi()] * n if half_widths is None else [arb(x) for x in exact_vector(half_widths)]
        )
        difference = arb_mat(
            [
                [arb(x) - y for x, y in zip(a, b, strict=True)]
                for a, b in zip(rows, whole, strict=True)
            ]
        )
        k = exact.frequencies.tolist()
        slopes = arb_mat(fmpz_mat(len(k), n, [x for row in k for x in row])) * difference
        bound = [arb(x) for x in base]
        for j, (row, a, b) in enumerate(zip(k, exact.cos, exact.sin, strict=True)):
            slope = [slopes[j, i] for i in range(n)]
            turned = abs(sum((x * m for x, m in zip(slope, middle, strict=True)), arb(0)))
            turned = turned + sum((abs(x) * w for x, w in zip(slope, widths, strict=True)), arb(0))
            size = (arb(a) ** 2 + arb(b) ** 2).sqrt() * min(2.0, upper(turned))
            for i, weight in enumerate(row):
                if weight:
                    bound[i] = bound[i] + abs(weight) * size
        return np.array([upper(x) for x in bound])


def certified_error(
    A: ArrayLike,
    d: ArrayLike,
    Y: ArrayLike,
    potential: TrigonometricPolynomial,
    q: ArrayLike,
) -> NDArray[np.float64]:
    """Return lower bounds on |g_i(A q + d) - Y_i g_i(q)| at one configuration, per joint.

    Parameters
    ----------
    A, d, Y, potential
        As in `relation_error_bound`; A may be real.
    q
        Configuration (n,) [rad].

    Returns
    -------
    (n,) array
        Errors [N m], in ball arithmetic and rounded down: an error that is positive here is
        there, however small, and no rounding.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1]], [0.0], [1.0])
    >>> bool(certified_error([[1]], [1e-12], [1], U, [1.0])[0] > 0)
    True
    """
    exact = exact_potential(potential)
    point = exact_vector(q)
    signs = [int(y) for y in np.asarray(Y)]
    with ctx.workprec(PRECISION_BITS):
        here = [angle(x) for x in point]
        there = [angle(x) for x in maps(exact_matrix(A), exact_vector(d), point)]
        error = [arb(0)] * exact.n
        for k, a, b in zip(exact.frequencies.tolist(), exact.cos, exact.sin, strict=True):
            at_image, at_q = _wave(k, a, b, there), _wave(k, a, b, here)
            for i, weight in enumerate(k):
                if weight:
                    error[i] = error[i] + weight * (at_image - signs[i] * at_q)
        return np.array([max(0.0, lower(abs(x))) for x in error])


def _wave(k: list[int], a: Any, b: Any, q: list[arb]) -> arb:
    """Return b cos(k.q) - a sin(k.q): the torque that term k contributes per unit of k_i."""
    at = phase(k, q)
    return arb(b) * at.cos() - arb(a) * at.sin()
