"""Trigonometric polynomials that have a group's symmetries: a basis of their coefficients."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def multi_affine_frequencies(basis: Array) -> Integers:
    """All kappa with ``B^T kappa`` in {-1, 0, 1}^n, one of each pair, 0 first.

    Parameters
    ----------
    basis : (r, n) array
        Integer matrix B of full rank.

    Returns
    -------
    (m, r) int array
        Frequencies in y = B q that a rigid arm's gravity can have: no joint twice.

    Examples
    --------
    >>> multi_affine_frequencies(np.array([[1, 1, 0]])).tolist()
    [[0], [1]]
    """
    rows = np.asarray(basis, dtype=float)
    rank, joints = rows.shape
    if np.array_equal(rows, np.eye(joints)):
        found = np.array(list(itertools.product((-1, 0, 1), repeat=joints)), dtype=np.int64)
    else:
        # kappa is fixed by r independent components of k = B^T kappa: try those, check the rest.
        pivots = _independent(rows)
        chosen = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=rank)))
        kappa = chosen.reshape(-1, rank) @ np.linalg.inv(rows[:, pivots])
        k = kappa @ rows
        good = (np.abs(kappa - np.rint(kappa)) < 1e-9).all(axis=1) & (np.abs(k) < 1.5).all(axis=1)
        found = np.rint(kappa[good]).astype(np.int64)
    leading = np.array([next((x for x in row if x), 1) for row in found.tolist()])
    found = found[leading > 0]
    return found[np.argsort(np.abs(found).sum(axis=1), kind="stable")]


def _independent(rows: Array) -> list[int]:
    """Columns that form an invertible square matrix."""
    chosen: list[int] = []
    for j in range(rows.shape[1] if len(rows) else 0):  # NumPy 2.2 knows no rank of no rows
        if np.linalg.matrix_rank(rows[:, [*chosen, j]]) > len(chosen):
            chosen.append(j)
    return chosen


def torque_basis(coordinates: SymmetryCoordinates, frequencies: Integers, signs: Array) -> Array:
    """`sparse_torque_basis` as an ordinary array."""
    return np.asarray(sparse_torque_basis(coordinates, frequencies, signs).toarray())


def sparse_torque_basis(
    coordinates: SymmetryCoordinates, frequencies: Integers, signs: Array
) -> csc_array:
    """Coefficients of functions with ``f(A y + d) = s f(y)`` for every relation.

    Parameters
    ----------
    coordinates : SymmetryCoordinates
        The group.
    frequencies : (m, r) int array
        kappa of ``f = sum a cos(kappa.y) + b sin(kappa.y)``, one of each pair.
    signs : (G,) array
        s of every relation: one column of Y.

    Returns
    -------
    (2 m, p) sparse array
        Orthonormal columns: all (a, then b) that are possible.

    Notes
    -----
    A relation takes frequency kappa to ``A^T kappa``. Frequencies from which one gets out of the
    given ones must be absent. On the rest the average over the group is a projection; its range
    is found orbit by orbit.
    """
    m = len(frequencies)
    index = {tuple(k): i for i, k in enumerate(frequencies.tolist())}
    target = np.full((coordinates.order, m), -1)
    phase = np.zeros((coordinates.order, m))
    mirrored = np.ones((coordinates.order, m))
    for g, (A, d) in enumerate(zip(coordinates.A_sat, coordinates.d_sat, strict=True)):
        image = frequencies @ A
        phase[g] = frequencies @ d
        whole = np.rint(image)
        for i in np.flatnonzero(np.abs(image - whole).max(axis=1, initial=0.0) < 1e-6):
            row = tuple(whole[i].astype(int).tolist())
            flip = tuple(-x for x in row)
            if row in index:
                target[g, i] = index[row]
            elif flip in index:
                target[g, i], mirrored[g, i] = index[flip], -1.0
    return _range_by_orbit(target, mirrored, phase, signs[:, None] * np.ones(m))


def potential_basis(coordinates: SymmetryCoordinates, frequencies: Integers) -> Array:
    """Coefficients of potentials U whose torque has the symmetries, ``g(A q + d) = Y g(q)``.

    Parameters
    ----------
    coordinates : SymmetryCoordinates
        The group.
    frequencies : (m, r) int array
        kappa of ``U = sum a cos(kappa.y) + b sin(kappa.y)``, one of each pair.

    Returns
    -------
    (2 m, p) array
        Orthonormal columns: all (a, then b) that are possible, without a constant.

    Notes
    -----
    U itself need not be symmetric: with k = B^T kappa a relation must satisfy ``A^T k = s_k Y k``
    and ``C_{s_k Y k} = s_k C_k exp(i k.d)`` with a sign of its own for each k; other
    frequencies must be absent (docs/theory.md, "Primary symmetries: the complete list").
    """
    m = len(frequencies)
    k = frequencies @ np.rint(coordinates.basis).astype(np.int64)
    index = {tuple(row): i for i, row in enumerate(k.tolist())}
    target = np.full((coordinates.order, m), -1)
    phase = np.zeros((coordinates.order, m))
    mirrored, signs = np.ones((coordinates.order, m)), np.ones((coordinates.order, m))
    for g in range(coordinates.order):
        moved = frequencies @ coordinates.A_sat[g] @ coordinates.basis
        wanted = k * coordinates.Y[g]
        phase[g] = frequencies @ coordinates.d_sat[g]
        for sign in (1.0, -1.0):
            fits = np.abs(moved - sign * wanted).max(axis=1) < 1e-6
            for i in np.flatnonzero(fits & k.any(axis=1)):
                row = tuple(np.rint(moved[i]).astype(int).tolist())
                flip = tuple(-x for x in row)
                signs[g, i] = sign
                if row in index:
                    target[g, i] = index[row]
                elif flip in index:
                    target[g, i], mirrored[g, i] = index[flip], -1.0
    return np.asarray(_range_by_orbit(target, mirrored, phase, signs).toarray())


def _range_by_orbit(
    target: NDArray[np.int64], mirrored: Array, phase: Array, signs: Array
) -> csc_array:
    """Coefficients (2 m, p) that all relations leave alone, sparse.

    Relation g takes ``a cos x + b sin x`` of frequency i to ``sign (a cos(x' + phase) + ..)`` with
    x' = +-x of frequency ``target`` (minus where ``mirrored`` is -1; -1: none).
    """
    order, m = target.shape
    rows: list[Array] = []
    values: list[Array] = []
    starts = [0]
    waiting = np.ones(m, dtype=bool)
    absent = np.asarray((target < 0).any(axis=0))
    for start in range(m):
        if not waiting[start]:
            continue
        members = np.unique(np.append(target[:, start][target[:, start] >= 0], start))
        waiting[members] = False
        if absent[members].any():
            continue
        place = {int(i): j for j, i in enumerate(members)}
        size = len(members)
        average = np.zeros((2 * size, 2 * size))
        for g in range(order):
            for j, i in enumerate(members):
                to, mirror, s = place[int(target[g, i])], mirrored[g, i], signs[g, i] / order
                c, sn = np.cos(phase[g, i]), np.sin(phase[g, i])
                # a cos(m x + p) + b sin(m x + p), written in cos x and sin x
                average[to, j] += s * c
                average[to, size + j] += s * sn
                average[size + to, j] -= s * mirror * sn
                average[size + to, size + j] += s * mirror * c
        left, kept, _ = np.linalg.svd(average)
        for column in left[:, kept > 0.5].T:
            rows.append(np.concatenate([members, m + members]))
            values.append(column)
            starts.append(starts[-1] + 2 * size)
    if not rows:
        return csc_array((2 * m, 0))
    return csc_array((np.concatenate(values), np.concatenate(rows), starts), (2 * m, len(rows)))
