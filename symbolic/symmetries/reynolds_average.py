"""The symmetric potential nearest to a given one: the average over a group."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]


def joint_offsets(
    A_sat: Array, d_sat: Array, information: Array, table: NDArray[np.int64]
) -> Array:
    """Make the offsets of a group fit together: d_ij = A_i d_j + d_i modulo 2 pi.

    Parameters
    ----------
    A_sat : (g, r, r) array
        Linear parts.
    d_sat : (g, r) array
        Offsets fitted one by one [rad], nearly fitting together.
    information : (g, r, r) array
        Weight of each fitted offset (inverse covariance, up to a factor).
    table : (g, g) int array
        ``table[i, j]`` is the position of the product of i after j.

    Returns
    -------
    (g, r) array
        The nearest offsets, in the weighted sense, that fit together exactly [rad].
    """
    g, r = d_sat.shape
    if r == 0:
        return d_sat
    rows, rhs = [], []
    for i in range(g):
        for j in range(g):
            equation = np.zeros((r, g, r))
            equation[:, table[i, j]] += np.eye(r)
            equation[:, j] -= A_sat[i]
            equation[:, i] -= np.eye(r)
            rows.append(equation.reshape(r, g * r))
            rhs.append(wrap(A_sat[i] @ d_sat[j] + d_sat[i] - d_sat[table[i, j]]))
    constraint, value = np.concatenate(rows), np.concatenate(rhs)
    # normal equations: the system is large, sparse and well scaled (entries are small integers)
    gram = constraint.T @ constraint
    eigenvalues, vectors = np.linalg.eigh(gram)
    null = vectors[:, eigenvalues < 1e-9 * max(1.0, float(eigenvalues[-1]))]
    step = np.linalg.pinv(gram, rcond=1e-9, hermitian=True) @ (constraint.T @ value)
    weight = np.zeros((g * r, g * r))
    for i in range(g):
        block = slice(i * r, (i + 1) * r)
        weight[block, block] = information[i] + 1e-9 * np.trace(information[i]) * np.eye(r)
    if null.shape[1]:
        step = step - null @ np.linalg.solve(null.T @ weight @ null, null.T @ weight @ step)
    return wrap(d_sat + step.reshape(g, r))


def symmetric_part_error(
    potential: TrigonometricPolynomial,
    B: NDArray[np.int64],
    A_sat: Array,
    d_sat: Array,
    Y: NDArray[np.int64],
) -> Array:
    """Bound the change of each torque when U is replaced by its average over a group.

    Parameters
    ----------
    potential
        U with numeric coefficients.
    B : (r, n) int array
        Basis of the coordinates y = B q that the group acts on; terms of U outside its span
        are averaged away.
    A_sat, d_sat, Y
        The group, shapes (g, r, r), (g, r), (g, n).

    Returns
    -------
    (n,) array
        e_i = sum over k of |k_i| |(a, b)_k - (a, b)_k of the average| [N m].
    """
    n, g = potential.n, len(Y)
    coefficient: dict[bytes, complex] = {}
    for k, c in zip(potential.frequencies, potential.complex(), strict=True):
        coefficient[k.tobytes()], coefficient[(-k).tobytes()] = c, np.conj(c)
    # the average may also populate frequencies that U does not have
    images = (potential.frequencies[None] * Y[:, None].astype(np.int64)).reshape(-1, n)
    leading = np.zeros(len(images), dtype=np.int64)
    for column in images.T[::-1]:
        leading = np.where(column != 0, column, leading)
    K = np.unique(np.where(leading[:, None] < 0, -images, images), axis=0)
    right = np.linalg.pinv(B.astype(float)) if len(B) else np.zeros((n, 0))
    y = K @ right
    inside = np.all(np.abs(y @ B - K) < 1e-9, axis=1)
    own = np.array([coefficient.get(k.tobytes(), 0.0) for k in np.ascontiguousarray(K)])
    average = np.zeros(len(K), dtype=complex)
    for A, d, signs in zip(A_sat, d_sat, Y.astype(np.int64), strict=True):
        moved, target = y @ A @ B, K * signs
        plus = np.all(np.abs(moved - target) < 1e-9, axis=1)
        minus = np.all(np.abs(moved + target) < 1e-9, axis=1)
        inside &= plus | minus
        s = np.where(plus, 1, -1)
        image = np.array(
            [coefficient.get(k.tobytes(), 0.0) for k in np.ascontiguousarray(target * s[:, None])]
        )
        average += s * np.exp(-1j * (y @ d)) * image / g
    average[~inside] = 0.0
    return np.asarray(2 * np.abs(own - average) @ np.abs(K))
