"""Oracle: the potential by multiplying 4x4 transforms, written without the code under test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath
import numpy as np

from isotorque.symbolic.robots.kinematic_tree import KinematicTree


def transform_potential(
    tree: KinematicTree, cos: Sequence[Any], sin: Sequence[Any], number: Callable[[Any], Any]
) -> Any:
    """Return -sum over links of m gravity . (world position of the centre of mass).

    ``cos`` and ``sin`` hold the cosines and sines of the joint angles, ``number`` converts the
    entries of the tree to something that can be multiplied with them.
    """
    worlds: list[np.ndarray] = []
    total = number(0.0)
    for i in range(tree.n):
        world = worlds[tree.parents[i]] if tree.parents[i] >= 0 else _eye(4, number)
        placement, turn = _eye(4, number), _eye(4, number)
        a = [number(x) for x in tree.axes[i]]
        cross = [[number(0.0), -a[2], a[1]], [a[2], number(0.0), -a[0]], [-a[1], a[0], number(0.0)]]
        for r in range(3):
            placement[r, 3] = number(tree.translations[i, r])
            for c in range(3):
                placement[r, c] = number(tree.rotations[i, r, c])
                same = number(float(r == c))
                turn[r, c] = (
                    a[r] * a[c] + (same - a[r] * a[c]) * cos[i] + cross[r][c] * sin[i]
                )  # Rodrigues
        world = world @ placement @ turn
        worlds.append(world)
        centre = world @ np.array([*(number(x) for x in tree.levers[i]), number(1.0)])
        for r in range(3):
            total = total - number(tree.masses[i]) * number(tree.gravity[r]) * centre[r]
    return total


def precise_potential(tree: KinematicTree, q: Sequence[Any]) -> Any:
    """Return the potential at ``q`` in the working precision of mpmath."""
    return transform_potential(
        tree, [mpmath.cos(x) for x in q], [mpmath.sin(x) for x in q], mpmath.mpf
    )


def _eye(n: int, number: Callable[[Any], Any]) -> np.ndarray:
    return np.array([[number(float(i == j)) for j in range(n)] for i in range(n)], dtype=object)
