"""Direct factors of a group that acts on a torus, each on coordinates of its own."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from isotorque.symbolic.common.angles import circular_distance
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.connected_components import connected_components
from isotorque.symbolic.groups.affine_map_index import SAME_EXACT_OFFSET


@dataclass(frozen=True, eq=False)
class TorusFactor:
    """A group acting on some of the coordinates by ``w -> A w + d`` modulo 2 pi.

    Attributes
    ----------
    coordinates : (b,) int array
        Which coordinates.
    A, d : (g, b, b) and (g, b) arrays
        The different maps of them.
    """

    coordinates: Integers
    A: Floats
    d: Floats


def direct_factors(A: Floats, d: Floats) -> list[TorusFactor]:
    """Split a group into a direct product over blocks of coordinates, as fine as it goes.

    Parameters
    ----------
    A, d : (G, r, r) and (G, r) arrays
        The group, all maps different.

    Returns
    -------
    list of TorusFactor
        One block with everything where the group is no such product.

    Notes
    -----
    The fingers of a hand, or two arms on a fixed base, have symmetry groups that are products.
    Cells and centres of a product can be built factor by factor.

    Examples
    --------
    >>> signs = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    >>> blocks = direct_factors(np.array([np.diag(s) for s in signs]), np.zeros((4, 2)))
    >>> [len(block.A) for block in blocks]
    [2, 2]
    """
    order, r = d.shape
    if r == 0:
        return []
    coupled = np.any(A != 0, axis=0)
    label = connected_components(coupled)
    count = int(label.max()) + 1
    parts = [np.flatnonzero(label == i) for i in range(count)]
    kinds = np.column_stack([_kinds(A[:, part[:, None], part], d[:, part]) for part in parts])
    groups = [[i] for i in range(count)]
    pair = _dependent_pair(groups, kinds)
    while pair is not None:
        groups[pair[0]] += groups.pop(pair[1])
        pair = _dependent_pair(groups, kinds)
    if np.prod([float(_count(kinds, group)) for group in groups]) != order:
        groups = [list(range(count))]
    blocks = []
    for group in groups:
        here = np.sort(np.concatenate([parts[i] for i in group]))
        _, first = np.unique(kinds[:, group], axis=0, return_index=True)
        first.sort()
        blocks.append(TorusFactor(here, A[np.ix_(first, here, here)], d[np.ix_(first, here)]))
    return blocks


def _count(kinds: Integers, group: list[int]) -> int:
    """Return how many different maps there are of some coordinates."""
    return len(np.unique(kinds[:, group], axis=0))


def _dependent_pair(groups: list[list[int]], kinds: Integers) -> tuple[int, int] | None:
    """Find two sets of coordinates whose maps do not combine freely."""
    for i, j in itertools.combinations(range(len(groups)), 2):
        first, second = groups[i], groups[j]
        if _count(kinds, first + second) != _count(kinds, first) * _count(kinds, second):
            return i, j
    return None


def _kinds(A: Floats, d: Floats) -> Integers:
    """Number the different maps in a list, equal ones alike."""
    kind = np.full(len(A), -1, dtype=np.int64)
    left = np.arange(len(A))
    while len(left):
        same = (A[left] == A[left[0]]).all(axis=(1, 2))
        same &= circular_distance(d[left], d[left[0]]) < SAME_EXACT_OFFSET
        kind[left[same]] = kind.max() + 1
        left = left[~same]
    return kind
