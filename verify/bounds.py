"""Bounds on the torque error of a relation that hold for every configuration."""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import acb, arb, ctx
from numpy.typing import ArrayLike, NDArray

from symbolic.trigonometric import TrigonometricPolynomial
from verify.proof import PRECISION_BITS, exact_potential, lower, upper

ROUND_UP = 1 + 1e-12
"""More than float arithmetic loses in the sums of this file."""


def relation_error_bound(
    A: ArrayLike, d: ArrayLike, Y: ArrayLike, potential: TrigonometricPolynomial
) -> NDArray[np.float64]:
    """Bound |g_i(A q + d) - Y_i g_i(q)| per joint, for every configuration q.

    Parameters
    ----------
    A
        Integer matrix (n, n).
    d
        Offsets (n,) [rad].
    Y
        Signs (n,).
    potential
        Gravity potential with rational or float coefficients.

    Returns
    -------
    (n,) array
        Upper bounds [N m].

    Notes
    -----
    The error of each joint is itself a trigonometric polynomial, with the frequencies ``A^T k``
    and ``k``; it is expanded in ball arithmetic and the bound is the sum of its amplitudes,
    rounded up. Where A satisfies condition (i) this is ``eps_i = sum_k |k_i| |residual_k|``.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> relation_error_bound([[-1, 0], [2, 1]], [0, 1e-6], [1, 1], U).round(8)
    array([6.1e-06, 6.1e-06])
    """
    matrix = np.asarray(A, dtype=float).astype(np.int64)
    flips = np.asarray(Y, dtype=np.int64)
    exact = exact_potential(potential)
    n = exact.n
    waves: dict[tuple[int, ...], list[list[arb]]] = {}
    with ctx.workprec(PRECISION_BITS):
        offsets = [arb(float(x)) for x in np.asarray(d, dtype=float)]
        for k, a, b in zip(exact.frequencies.tolist(), exact.cos, exact.sin, strict=True):
            phase = sum((c * t for c, t in zip(k, offsets, strict=True) if c), arb(0))
            c, s, a, b = phase.cos(), phase.sin(), arb(a), arb(b)
            image = (np.asarray(k, dtype=np.int64) @ matrix).tolist()
            _add_torque(waves, image, b * c - a * s, -(a * c + b * s), k)
            weights = [-int(y) * x for x, y in zip(k, flips, strict=True)]
            _add_torque(waves, k, b, -a, weights)
        bound = [arb(0)] * n
        for amplitudes in waves.values():
            for i, (cos, sin) in enumerate(amplitudes):
                bound[i] = bound[i] + abs(acb(cos, sin))
        return np.array([upper(x) for x in bound])


def _add_torque(
    waves: dict[tuple[int, ...], list[list[arb]]],
    frequency: list[int],
    cos: arb,
    sin: arb,
    weights: list[int],
) -> None:
    """Add weight_i * (cos cos(f.q) + sin sin(f.q)) to the error of every joint i."""
    leading = next((x for x in frequency if x), 0)
    if leading < 0:
        frequency, sin = [-x for x in frequency], -sin
    if not leading:
        sin = arb(0)
    joints = waves.setdefault(tuple(frequency), [[arb(0), arb(0)] for _ in weights])
    for joint, weight in zip(joints, weights, strict=True):
        if weight:
            joint[0] = joint[0] + weight * cos
            joint[1] = joint[1] + weight * sin


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
        Real matrix (n, n), near an integer matrix A0: the one found by rounding.
    d, Y
        Offsets (n,) [rad] and signs (n,).
    potential
        Gravity potential with rational or float coefficients.
    center, half_widths
        The box |q - center| <= half_widths, (n,) each [rad]; one turn around zero by default.

    Returns
    -------
    (n,) array
        Upper bounds on |g_i(A q + d) - Y_i g_i(q)| for q in the box [N m].

    Notes
    -----
    With ``dA = A - A0`` the bound is that of (A0, d) plus ``sum_k |k_i| amp_k min(2, |k.dA center|
    + sum_j |(dA^T k)_j| half_widths_j)``.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> learned_map_bound([[-1, 1e-3], [2, 1]], [0, 0], [1, 1], U).round(4)
    array([0.077 , 0.0192])
    """
    matrix = np.asarray(A, dtype=float)
    nearest = np.round(matrix)
    n = potential.n
    middle = np.zeros(n) if center is None else np.asarray(center, dtype=float)
    width = np.full(n, np.pi) if half_widths is None else np.asarray(half_widths, dtype=float)
    base = relation_error_bound(nearest, d, Y, potential)
    k = potential.frequencies.astype(float)
    difference = matrix - nearest
    slope = k @ difference
    phase = np.minimum(2.0, np.abs(slope @ middle) + np.abs(slope) @ width)
    return (base + (potential.amplitudes() * phase) @ np.abs(k)) * ROUND_UP


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
    n = exact.n
    matrix, flips = np.asarray(A, dtype=float), np.asarray(Y, dtype=np.int64)
    with ctx.workprec(PRECISION_BITS):
        here = [arb(float(x)) for x in np.asarray(q, dtype=float)]
        there = [
            sum((arb(float(c)) * x for c, x in zip(row, here, strict=True) if c), arb(float(t)))
            for row, t in zip(matrix, np.asarray(d, dtype=float), strict=True)
        ]
        error = [arb(0)] * n
        for k, a, b in zip(exact.frequencies.tolist(), exact.cos, exact.sin, strict=True):
            at_image, at_q = _wave(k, a, b, there), _wave(k, a, b, here)
            for i, weight in enumerate(k):
                if weight:
                    error[i] = error[i] + weight * (at_image - int(flips[i]) * at_q)
        return np.array([max(0.0, lower(abs(x))) for x in error])


def _wave(k: list[int], a: Any, b: Any, q: list[arb]) -> arb:
    """Return b cos(k.q) - a sin(k.q): the torque that term k contributes per unit of k_i."""
    phase = sum((c * x for c, x in zip(k, q, strict=True) if c), arb(0))
    return arb(b) * phase.cos() - arb(a) * phase.sin()
