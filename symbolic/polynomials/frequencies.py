"""Rows of integer frequencies in canonical form."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.coefficients import Coefficients, is_zero


def frequency_rows(values: ArrayLike) -> NDArray[np.int64]:
    """Return frequencies as an (m, n) integer array.

    Raises
    ------
    InputError
        For another shape, or entries that are not integers.
    """
    k = np.asarray(values)
    if k.ndim != 2:
        raise InputError("trigonometric polynomial", "shape of frequencies", k.shape, "(m, n)")
    if k.dtype.kind != "i":
        numbers = k.astype(float)
        if not np.all(np.isfinite(numbers) & (numbers == np.round(numbers))):
            raise InputError("trigonometric polynomial", "frequencies", k.tolist(), "integers")
    return k.astype(np.int64)


def canonical_terms(
    k: NDArray[np.int64], a: Coefficients, b: Coefficients
) -> tuple[NDArray[np.int64], Coefficients, Coefficients]:
    """Fold -k onto k, add equal rows, drop exact zeros; keep the order of first appearance.

    Parameters
    ----------
    k : (m, n) int array
        Frequencies of sum over k of a_k cos(k.q) + b_k sin(k.q).
    a, b : (m,) arrays
        Coefficients of one kind.

    Returns
    -------
    tuple
        The same sum, each frequency once and with its first nonzero entry positive.
    """
    if not len(k):
        return k, a, b
    leading = np.zeros(len(k), dtype=np.int64)
    for column in k.T[::-1]:
        leading = np.where(column != 0, column, leading)
    constant = leading == 0
    if constant.any():  # sin(0) = 0
        b = b.copy()
        b[constant] = b[constant] * 0
    flip = leading < 0
    if flip.any():
        k = np.where(flip[:, None], -k, k)
        b = b.copy()
        b[flip] = -b[flip]
    if a.dtype == object:
        keep = np.array([not (is_zero(x) and is_zero(y)) for x, y in zip(a, b, strict=True)])
    else:
        keep = (a != 0) | (b != 0)
    if not keep.all():
        k, a, b = k[keep], a[keep], b[keep]
    index: dict[bytes, int] = {}
    place = np.array(
        [index.setdefault(row.tobytes(), len(index)) for row in np.ascontiguousarray(k)]
    )
    if len(index) == len(k):
        return k, a, b
    first = np.array([int(np.argmax(place == j)) for j in range(len(index))])
    new_a, new_b = a[first].copy(), b[first].copy()
    for i, j in enumerate(place):
        if i != first[j]:
            new_a[j], new_b[j] = new_a[j] + a[i], new_b[j] + b[i]
    return canonical_terms(k[first], new_a, new_b)
