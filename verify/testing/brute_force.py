"""Symmetries found by brute force, from values of the torque alone: slow, and free of proofs."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import fsolve

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]


def brute_force_symmetries(
    torque: Callable[[Array], Array], n: int, rng: np.random.Generator
) -> list[SymmetryRelation]:
    """Find all relations ``g(A q + d) = Y g(q)`` with entries of A in -2..2.

    Parameters
    ----------
    torque : callable
        g, from (..., n) [rad] to (..., n) [N m].
    n : int
        Number of joints; the work grows as 8^n, so up to three.
    rng : numpy.random.Generator
        Draws the generic configurations that are looked at.

    Returns
    -------
    list of SymmetryRelation

    Notes
    -----
    The image p1 = A p0 + d of a generic p0 has torque Y g(p0): all such p1 are found from a grid
    of starts pi/4 apart, refined. Columns of A are then tried one by one along lines through p1,
    and what is left is tried on random points. Along free directions images are not isolated, and
    nothing is found.

    Examples
    --------
    >>> found = brute_force_symmetries(lambda q: np.cos(q), 1, np.random.default_rng(0))
    >>> sorted((int(r.A[0, 0]), int(r.Y[0])) for r in found)
    [(-1, -1), (-1, 1), (1, -1), (1, 1)]
    """
    p0 = rng.uniform(-np.pi, np.pi, n)
    grid = np.array(list(itertools.product(np.arange(8) * np.pi / 4, repeat=n)))
    columns = np.array(list(itertools.product(range(-2, 3), repeat=n)))
    steps = np.array([0.4, -0.9, 1.7])
    found = []
    for signs in itertools.product([1, -1], repeat=n):
        Y = np.array(signs)
        for p1 in _images(torque, Y * torque(p0), grid):
            choices = []
            for j in range(n):
                line = np.array([torque(p0 + t * np.eye(n)[j]) for t in steps]) * Y
                walked = torque(p1 + steps[:, None, None] * columns[None])
                choices.append(columns[np.abs(walked - line[:, None]).max(axis=(0, 2)) < 1e-6])
            for pick in itertools.product(*choices):
                A = np.array(pick).T
                d = p1 - A @ p0
                q = rng.uniform(-np.pi, np.pi, (20, n))
                if np.abs(torque(q @ A.T + d) - Y * torque(q)).max() < 1e-6:
                    found.append(SymmetryRelation(A, d, Y))
    return found


def _images(torque: Callable[[Array], Array], target: Array, grid: Array) -> list[Array]:
    """All configurations with the torque ``target`` (n,)."""
    images: list[Array] = []
    # starts whose torque is far off lead to roots that nearer starts find too
    near = np.argsort(np.abs(torque(grid) - target).max(axis=1))[: 64 * grid.shape[1]]
    for start in grid[near]:
        root, _, status, _ = fsolve(lambda q: torque(q) - target, start, full_output=True)
        root = wrap(root)
        if (
            status == 1
            and np.abs(torque(root) - target).max() < 1e-8
            and not any(np.abs(wrap(root - other)).max() < 1e-5 for other in images)
        ):
            images.append(root)
    return images
