"""A chain written out as a trigonometric polynomial."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Rows = NDArray[np.int8]
Vectors = NDArray[np.complex128]

NEGLIGIBLE = 1e-14
"""Terms below, relative to the largest, are rounding and dropped."""
_STILL = np.diag([0.0, 0.0, 1.0]).astype(complex)
_TURNING = np.array([[0.5, 0.5j, 0.0], [-0.5j, 0.5, 0.0], [0.0, 0.0, 0.0]])


def expanded(chain: ChainParameters) -> TrigonometricPolynomial:
    """The potential [J] of the true torque of a chain, without its constant.

    Notes
    -----
    ``Rz(q) = E0 + E1 exp(i q) + conj(E1) exp(-i q)``: moments are carried inwards as one vector
    per frequency. A chain with right angles and absent levers has some dozen frequencies, a
    generic one 3^n / 2.

    Examples
    --------
    >>> sideways = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]]
    >>> print(expanded(ChainParameters.of(sideways, [[6.0, 0.0]])))
    6 sin(q1)
    """
    n = chain.n
    size = max(float(np.abs(chain.levers).max(initial=0.0)), np.finfo(float).tiny)
    zero = np.zeros((1, n), dtype=np.int8)
    carried: list[tuple[Rows, Vectors]] = [
        (zero, np.array([[x, y, 0.0]], dtype=complex)) for x, y in chain.levers
    ]
    total: list[tuple[Rows, Vectors]] = []
    for j in range(n - 1, -1, -1):
        k, h = _turned(*carried[j], j, NEGLIGIBLE * size)
        h = h @ chain.rotations[j].T
        p = int(chain.parents[j])
        if p < 0:
            total.append((k, h[:, 2]))
        else:
            carried[p] = _sum(carried[p], (k, h))
    frequencies = np.concatenate([k for k, _ in total])
    values = np.concatenate([h for _, h in total])
    # both of each pair +-k are there: one of them, doubled
    first = np.take_along_axis(frequencies, (frequencies != 0).argmax(axis=1)[:, None], axis=1)
    one = first[:, 0] > 0
    return TrigonometricPolynomial(
        frequencies[one].astype(np.int64), 2 * values[one].real, -2 * values[one].imag
    ).significant(NEGLIGIBLE)


def _turned(k: Rows, h: Vectors, joint: int, least: float) -> tuple[Rows, Vectors]:
    """Vectors seen from before the joint's turn."""
    rows, vectors = [], []
    for e, part in ((0, _STILL), (1, _TURNING), (-1, _TURNING.conj())):
        moved = h @ part.T
        keep = np.abs(moved).max(axis=1) > least
        turned = k[keep].copy()
        turned[:, joint] = e
        rows.append(turned)
        vectors.append(moved[keep])
    return np.concatenate(rows), np.concatenate(vectors)


def _sum(one: tuple[Rows, Vectors], two: tuple[Rows, Vectors]) -> tuple[Rows, Vectors]:
    """Equal frequencies joined."""
    k, which = np.unique(np.concatenate([one[0], two[0]]), axis=0, return_inverse=True)
    h = np.zeros((len(k), 3), dtype=complex)
    np.add.at(h, which.ravel(), np.concatenate([one[1], two[1]]))
    return k, h
