"""How much two arms' gravity torques differ at most: what snapping an angle does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from symbolic.kinematic_tree import KinematicTree

_NEGLIGIBLE = 1e-16  # of gravity; what is left out below it is added to the bound


def torque_difference_bound(first: KinematicTree, second: KinematicTree) -> NDArray[np.float64]:
    """Bound the difference of two arms' gravity torques over all configurations.

    Parameters
    ----------
    first, second
        Trees of floats with the same joints and parents.

    Returns
    -------
    (n,) array
        For each joint a bound on ``|g_i(q) - g_i'(q)|`` for every q [N m].

    Notes
    -----
    The bound is ``sum_k |k_i| |(a, b)_k - (a, b)'_k|`` over the coefficients of both potentials
    ``U = sum_k a_k cos(k.q) + b_k sin(k.q)``. The coefficients are computed here in floats, as
    ``C_k exp(i k.q)`` with both of +-k: for a bound on small differences that is enough, and
    quick for angles that are not snapped, where nearly all 3^n coefficients are present.
    """
    fields = ("rotations", "translations", "axes", "masses", "levers", "gravity")
    if all(np.array_equal(getattr(first, name), getattr(second, name)) for name in fields):
        return np.zeros(first.n)
    frequencies, coefficients = [], []
    neglected = np.zeros(first.n)
    for tree, sign in ((first, 1.0), (second, -1.0)):
        k, c, rest = _potential(tree)
        frequencies.append(k)
        coefficients.append(sign * c)
        neglected += rest
    k = np.concatenate(frequencies)
    keys = np.ascontiguousarray(k).view(np.dtype((np.void, k.shape[1]))).ravel()
    _, index, inverse = np.unique(keys, return_index=True, return_inverse=True)
    difference = np.zeros(len(index), dtype=complex)
    np.add.at(difference, inverse, np.concatenate(coefficients))
    return np.abs(k[index]).T.astype(float) @ np.abs(difference) + neglected


def _potential(
    tree: KinematicTree,
) -> tuple[NDArray[np.int8], NDArray[np.complex128], NDArray[np.float64]]:
    """Return all C_k of the potential (equal k not yet added), and what was left out of g_i."""
    n = tree.n
    subtree, moments = _subtrees(tree)
    tiny = _NEGLIGIBLE * float(np.linalg.norm(tree.gravity))
    neglected = np.zeros(n)
    base = (np.zeros((1, n), dtype=np.int8), tree.gravity[None, :].astype(complex))
    rows: list[tuple[NDArray[np.int8], NDArray[np.complex128]]] = []
    frequencies, coefficients = [], []
    for i, parent in enumerate(tree.parents):
        k, v = base if parent < 0 else rows[parent]
        frequencies.append(k)
        coefficients.append(-subtree[i] * (v @ tree.translations[i]))
        k, v = _turned(k, v @ tree.rotations[i], i, tree.axes[i])
        sizes = np.linalg.norm(v, axis=1)
        neglected += sizes[sizes <= tiny].sum() * moments[i]
        k, v = k[sizes > tiny], v[sizes > tiny]
        frequencies.append(k)
        coefficients.append(-tree.masses[i] * (v @ tree.levers[i]))
        rows.append((k, v))
    return np.concatenate(frequencies), np.concatenate(coefficients), neglected


def _turned(
    k: NDArray[np.int8], v: NDArray[np.complex128], joint: int, axis: NDArray[np.float64]
) -> tuple[NDArray[np.int8], NDArray[np.complex128]]:
    """Return gravity as seen from behind a joint: exp(i q) parts for frequencies 0, 1, -1."""
    x, y, z = axis
    fixed = np.outer(axis, axis)
    turning = 1j * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    up, down = k.copy(), k.copy()
    up[:, joint], down[:, joint] = 1, -1
    cos = np.eye(3) - fixed
    return (
        np.concatenate([k, up, down]),
        np.concatenate([v @ fixed, v @ ((cos - turning) / 2), v @ ((cos + turning) / 2)]),
    )


def _subtrees(tree: KinematicTree) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mass (n,) and largest moment of mass about the joint (n,) of what each carries."""
    masses = np.array(tree.masses, dtype=float)
    moments = masses * np.linalg.norm(tree.levers, axis=1)
    for i in range(tree.n - 1, -1, -1):
        parent = tree.parents[i]
        if parent >= 0:
            masses[parent] += masses[i]
            moments[parent] += moments[i] + masses[i] * np.linalg.norm(tree.translations[i])
    return masses, moments
