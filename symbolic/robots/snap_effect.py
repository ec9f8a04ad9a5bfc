"""Effect of snapping an angle: the largest difference between two arms' gravity torques."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.robots.kinematic_tree import KinematicTree

_TOO_MANY = 20_000  # coefficients that would take longer than some milliseconds
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
    The smaller one of two bounds. *Coefficients*: ``sum_k |k_i| |(a, b)_k - (a, b)'_k|`` over
    both potentials ``U = sum_k a_k cos(k.q) + b_k sin(k.q)``, computed here in floats as
    ``C_k exp(i k.q)`` with both of +-k: enough for a bound on small differences, and quick for
    angles that are not snapped, where nearly all 3^n coefficients are present. *Lengths*: what
    each rotation can do at most, being small and carrying a bounded moment of mass; looser by a
    small factor, but its cost grows with n only. Chains of more than eight joints get the latter.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> arm = load_robot("2r").tree
    >>> longer = replace(arm, translations=arm.translations * 1.01)
    >>> torque_difference_bound(arm, longer)  # 5 kg carried 2.5 mm further out by joint 1
    array([0.122625, 0.      ])
    """
    fields = ("rotations", "translations", "axes", "masses", "levers", "gravity")
    if all(np.array_equal(getattr(first, name), getattr(second, name)) for name in fields):
        return np.zeros(first.n)
    lengths = _by_lengths(first, second)
    if sum(3.0**depth for depth in _depths(first)) > _TOO_MANY:
        return lengths
    return np.minimum(_by_coefficients(first, second), lengths)


def _by_lengths(first: KinematicTree, second: KinematicTree) -> NDArray[np.float64]:
    """Bound by lengths, masses and norms of the differences.

    Seen from link i, gravity differs by at most ``|g| turned_i`` and the moment of mass of what
    it carries by ``moved_i``; the torque is axis . (moment x gravity).
    """
    n = first.n
    gravity = float(np.linalg.norm(first.gravity))
    masses, moments = _subtrees(first)
    other_masses, other_moments = _subtrees(second)
    moments = np.maximum(moments, other_moments)
    axis = np.linalg.norm(first.axes - second.axes, axis=1)
    # turning about axes that differ by s differs by at most 2 s
    own = np.linalg.norm(first.rotations - second.rotations, ord=2, axis=(1, 2)) + 2 * axis
    turned = np.full(n, np.linalg.norm(first.gravity - second.gravity) / gravity if gravity else 0)
    moved = np.linalg.norm(
        first.masses[:, None] * first.levers - second.masses[:, None] * second.levers, axis=1
    )
    steps = np.linalg.norm(
        masses[:, None] * first.translations - other_masses[:, None] * second.translations, axis=1
    )
    for i, parent in enumerate(first.parents):
        turned[i] = own[i] + (turned[parent] if parent >= 0 else turned[i])
    for i in range(n - 1, -1, -1):
        parent = first.parents[i]
        if parent >= 0:
            moved[parent] += moved[i] + steps[i] + own[i] * moments[i]
    return gravity * (moved + (turned + axis) * moments)


def _by_coefficients(first: KinematicTree, second: KinematicTree) -> NDArray[np.float64]:
    """Bound by the coefficients of both potentials."""
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


def _depths(tree: KinematicTree) -> list[int]:
    depths: list[int] = []
    for parent in tree.parents:
        depths.append(1 + (depths[parent] if parent >= 0 else 0))
    return depths


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
