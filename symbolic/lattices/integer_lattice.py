"""Exact integer linear algebra: bases, saturation and cosets of lattices of frequencies."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from flint import fmpz_mat
from numpy.typing import NDArray

from isotorque.symbolic.common.connected_components import connected_components

IntMatrix = NDArray[np.int64]


def _to_flint(matrix: IntMatrix) -> fmpz_mat:
    rows, columns = matrix.shape
    return fmpz_mat(rows, columns, [int(x) for x in matrix.ravel()])


def _from_flint(matrix: fmpz_mat) -> IntMatrix:
    entries = [int(x) for x in matrix.entries()]
    return np.array(entries, dtype=np.int64).reshape(matrix.nrows(), matrix.ncols())


def independent_rows(K: IntMatrix) -> list[int]:
    """Return the indices of the first rows of ``K`` that are linearly independent.

    Examples
    --------
    >>> independent_rows(np.array([[1, 0], [2, 0], [1, 1]]))
    [0, 2]
    """
    if not K.size:
        return []
    rank, step = int(np.count_nonzero(np.any(K, axis=0))), 4 * K.shape[1]  # the rank or more
    rows = _greedy(K[:step])
    while len(rows) < rank:
        outside = np.flatnonzero(coordinates_in(K, rows)[1] == 0)
        if not len(outside):
            break
        tried = np.concatenate([rows, outside[:step]])
        rows = tried[_greedy(K[tried])].tolist()
    return rows


def _greedy(K: IntMatrix) -> list[int]:
    rref, _, rank = _to_flint(np.ascontiguousarray(K.T)).rref()
    reduced = _from_flint(rref)
    return [int(np.flatnonzero(reduced[i])[0]) for i in range(rank)]


def coordinates_in(K: IntMatrix, rows: list[int]) -> tuple[IntMatrix, IntMatrix]:
    """Write every row of ``K`` as a rational combination of independent ones, exactly.

    Parameters
    ----------
    K : (m, n) int array
    rows : list of int
        Indices of r linearly independent rows.

    Returns
    -------
    numerators : (m, r) int array
    denominators : (m,) int array
        ``K[i] = numerators[i] @ K[rows] / denominators[i]`` in lowest terms; denominator 0 for
        rows outside the span of the independent ones.

    Notes
    -----
    Thousands of rows take one product of float matrices; each row is then checked in integers,
    which is a proof. Rows with other than small denominators are left to rational arithmetic.

    Examples
    --------
    >>> coordinates_in(np.array([[2, 0], [0, 1], [1, 1]]), [0, 1])[1].tolist()
    [1, 1, 2]
    """
    m, r = len(K), len(rows)
    numerators, denominators = np.zeros((m, r), dtype=np.int64), np.zeros(m, dtype=np.int64)
    if r == 0:
        return numerators, np.where(np.any(K, axis=1), 0, 1)
    H, right = K[rows].astype(float), K.astype(float)
    guess = right @ np.linalg.pinv(H)
    left = np.arange(m)
    for denominator in range(1, _SMALL_DENOMINATORS + 1):
        whole = np.round(denominator * guess[left])
        # sums of integers below 2^53 are exact in floats
        proved = np.all(whole @ H == denominator * right[left], axis=1)
        proved &= np.abs(whole).max(axis=1, initial=0.0) < _EXACT_IN_FLOATS
        done = left[proved]
        numerators[done], denominators[done] = whole[proved].astype(np.int64), denominator
        left = left[~proved]
    near = np.abs(guess[left] @ H - right[left]).max(axis=1, initial=0.0) < 1e-3
    for i in left[near].tolist():
        numerators[i], denominators[i] = _rational_coordinates(K[i], K[rows])
    return numerators, denominators


_SMALL_DENOMINATORS = 12
_EXACT_IN_FLOATS = 2.0**40


def _rational_coordinates(row: IntMatrix, basis: IntMatrix) -> tuple[IntMatrix, int]:
    """Return numerators and the common denominator, which is 0 outside the span."""
    both = np.concatenate([basis, row[None]])
    reduced, denominator, rank = _to_flint(np.ascontiguousarray(both.T)).rref()
    if rank > len(basis):
        return np.zeros(len(basis), dtype=np.int64), 0
    column = _from_flint(reduced)[:rank, -1]
    shared = int(np.gcd.reduce([*column.tolist(), int(denominator)]))
    sign = 1 if int(denominator) > 0 else -1
    return sign * column // shared, abs(int(denominator)) // shared


def dependency_components(K: IntMatrix) -> NDArray[np.int64]:
    """Label the rows of ``K`` by connected component of their linear matroid.

    Two rows have one label when a minimal linear dependency (a circuit) contains both.

    References
    ----------
    Oxley, Matroid Theory, Oxford 2011, proposition 4.1.2 and section 4.1.

    Examples
    --------
    >>> dependency_components(np.array([[1, 0, 0], [0, 1, 0], [0, 1, 1], [0, 1, -1]]))
    array([0, 1, 1, 1])
    """
    rows = independent_rows(K)
    label = -1 - np.arange(len(K))  # zero rows are circuits of their own
    if rows:
        used = coordinates_in(K, rows)[0] != 0  # fundamental circuits of the basis
        circuits = np.unique(used, axis=0).astype(np.int64)
        part = connected_components(circuits.T @ circuits > 0)
        touched = used.any(axis=1)
        label[touched] = part[used[touched].argmax(axis=1)]
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse].astype(np.int64)


def hermite_with_transform(matrix: IntMatrix) -> tuple[IntMatrix, IntMatrix]:
    """Return (H, T) with H = T matrix in row Hermite form, T unimodular."""
    rows, columns = matrix.shape
    wide = np.concatenate([matrix, np.eye(rows, dtype=np.int64)], axis=1)
    both = _from_flint(_to_flint(wide).hnf())
    return both[:, :columns], both[:, columns:]


def hermite(matrix: IntMatrix) -> IntMatrix:
    """Return the nonzero rows of the row Hermite form: a basis of the lattice of the rows."""
    if not matrix.size:
        return matrix[:0]
    form = _from_flint(_to_flint(matrix).hnf())
    return form[np.any(form, axis=1)]


def saturation(K: IntMatrix) -> tuple[IntMatrix, IntMatrix]:
    """Return a basis B of (span of the rows of K) intersected with Z^n, and its completion.

    Parameters
    ----------
    K : (m, n) int array

    Returns
    -------
    B : (r, n) int array
        Basis in Hermite form; the identity where r = n.
    V : (n, n) int array
        Unimodular matrix whose first r rows are B.

    Examples
    --------
    >>> B, V = saturation(np.array([[1, 1, 0], [1, -1, 0]]))
    >>> B.tolist(), V.tolist()
    ([[1, 0, 0], [0, 1, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    """
    n = K.shape[1]
    rows = K[independent_rows(K)]
    r = len(rows)
    if r == 0:
        return rows, np.eye(n, dtype=np.int64)
    B = hermite(_complete(rows)[:r])
    pivots = [int(np.flatnonzero(row)[0]) for row in B]
    unit = np.eye(n, dtype=np.int64)[[j for j in range(n) if j not in pivots]]
    V = np.concatenate([B, unit])
    if abs(int(_to_flint(V).det())) != 1:
        V = np.concatenate([B, _complete(B)[r:]])
    return B, V


def _complete(rows: IntMatrix) -> IntMatrix:
    """Return unimodular W such that rows = R W[:r] with an integer r x r matrix R."""
    _, T = hermite_with_transform(np.ascontiguousarray(rows.T))
    return np.ascontiguousarray(integer_inverse(T).T)


def integer_inverse(V: IntMatrix) -> IntMatrix:
    """Return the inverse of a unimodular matrix."""
    return np.round(np.linalg.inv(V.astype(float))).astype(np.int64)


@dataclass(frozen=True, eq=False)
class GeneratedLattice:
    """A full-rank lattice in Z^r generated by some of the given vectors.

    Attributes
    ----------
    rows : tuple of int
        Indices of a few given vectors that generate the lattice.
    H : (r, r) int array
        Its basis in Hermite form.
    T : (r, len(rows)) int array
        H = T C[rows].
    index : int
        Index of the lattice in Z^r.
    """

    rows: tuple[int, ...]
    H: IntMatrix
    T: IntMatrix
    index: int

    def coordinates(self, C: IntMatrix) -> IntMatrix:
        """Return the integer coordinates of the lattice vectors ``C`` (m, r) in the basis H."""
        return np.round(np.linalg.solve(self.H.T.astype(float), C.T.astype(float)).T).astype(
            np.int64
        )

    def cosets(self) -> IntMatrix:
        """Return representatives of Z^r / (column lattice of H), shape (index, r).

        These are the shifts 2 pi z for which ``H d = theta + 2 pi z`` has different solutions
        d modulo 2 pi.
        """
        column_form = hermite(np.ascontiguousarray(self.H.T))
        ranges = [range(int(x)) for x in np.diag(column_form)]
        shifts = list(itertools.product(*ranges))
        return np.array(shifts, dtype=np.int64).reshape(len(shifts), len(self.H))


def generate_lattice(C: IntMatrix) -> GeneratedLattice:
    """Return the lattice generated by the rows of ``C`` (m, r), which must have rank r.

    A Hermite or Smith form of hundreds of rows is needlessly slow; a few rows generate the same
    lattice, and membership of the others is one matrix product.
    """
    r = C.shape[1]
    rows = independent_rows(C)
    if r == 0:
        return GeneratedLattice((), np.zeros((0, 0), np.int64), np.zeros((0, 0), np.int64), 1)
    while True:
        H, T = hermite_with_transform(C[rows])
        H, T = H[:r], T[:r]
        coordinates = np.linalg.solve(H.T.astype(float), C.T.astype(float)).T
        outside = np.flatnonzero(np.any(np.abs(coordinates - np.round(coordinates)) > 1e-6, axis=1))
        if not len(outside):
            index = round(abs(float(np.linalg.det(H.astype(float)))))
            return GeneratedLattice(tuple(rows), H, T, index)
        rows.append(int(outside[0]))
