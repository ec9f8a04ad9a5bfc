"""Proved bounds on the torque error of a claimed symmetry relation."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial


def residual_bound(
    potential: TrigonometricPolynomial, A: ArrayLike, d: ArrayLike, Y: ArrayLike
) -> NDArray[np.float64]:
    """Bound |g_i(A q + d) - Y_i g_i(q)| over all q, for each joint i, where g = grad U.

    Parameters
    ----------
    potential
        U, with numeric coefficients.
    A : (n, n) array
        Linear part; any real matrix.
    d : (n,) array
        Offset [rad].
    Y : (n,) array
        Signs.

    Returns
    -------
    (n,) array
        Sum of the amplitudes of the difference [N m]: no configuration exceeds it.

    Notes
    -----
    Frequencies A^T k that agree with some +-k' to 1e-9 are subtracted coefficient by coefficient,
    which makes the bound tight for true and nearly true relations; all others add up in full.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> residual_bound(U, [[-1, 0], [2, 1]], [0.0, 0.0], [1, 1])
    array([0., 0.])
    >>> residual_bound(U, [[1, 0], [0, 1]], [0.0, 0.0], [-1, 1]).round(1)
    array([49.,  0.])
    """
    k = potential.frequencies.astype(float)
    moved = k @ np.asarray(A, dtype=float)
    C = potential.complex()
    shifted = C * np.exp(1j * (k @ np.asarray(d, dtype=float)))
    # coefficient of exp(i kappa.q) in g_i: rows "moved" of g_i(A q + d), rows "k" of -Y_i g_i(q)
    frequencies = np.concatenate([moved, k])
    values = np.concatenate([k * shifted[:, None], -k * np.asarray(Y, dtype=float) * C[:, None]])
    keys = np.round(frequencies * 1e9)
    leading = np.zeros(len(keys))
    for column in keys.T[::-1]:
        leading = np.where(column != 0, column, leading)
    flip = leading < 0
    keys[flip] *= -1
    # g has coefficients i k_i C_k: folding -kappa onto kappa conjugates i k C, i.e. -conj(k C)
    values[flip] = -np.conj(values[flip])
    _, group = np.unique(keys + 0.0, axis=0, return_inverse=True)
    total = np.zeros((int(group.max(initial=-1)) + 1, potential.n), dtype=complex)
    np.add.at(total, group.ravel(), values)
    return 2 * np.abs(total).sum(axis=0)
