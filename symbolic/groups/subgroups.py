"""Subgroups of a symmetry group that avoid some of its relations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

MOST = 4000
"""Subgroups looked at; only groups of order 128 or so have more."""


def generated(table: NDArray[np.int64], members: frozenset[int]) -> frozenset[int]:
    """The smallest subgroup that contains some elements of a finite group.

    Parameters
    ----------
    table : (G, G) int array
        Multiplication table: ``table[i, j]`` is the element i j.
    members : frozenset of int
        Elements.

    Examples
    --------
    >>> rotations = (np.arange(6)[:, None] + np.arange(6)) % 6
    >>> sorted(generated(rotations, frozenset({4})))
    [0, 2, 4]
    """
    found = members
    while True:
        index = np.fromiter(found, dtype=np.int64)
        larger = found | frozenset(table[np.ix_(index, index)].ravel().tolist())
        if larger == found:
            return found
        found = larger


def largest_subgroups(
    table: NDArray[np.int64], allowed: NDArray[np.bool_], accepted: Callable[[list[int]], float]
) -> list[int]:
    """The largest subgroup of allowed elements that a test accepts.

    Parameters
    ----------
    table : (G, G) int array
        Multiplication table.
    allowed : (G,) bool array
        Elements that may be in it; the identity is.
    accepted : callable
        Says how well (> 0) or not at all (0) the data agree with a subgroup, a sorted list.

    Returns
    -------
    list of int
        The largest accepted one; of equally large ones that with which the data agree best; at
        last the identity alone.

    Notes
    -----
    All subgroups are found by adding one generator after the other, up to `MOST` of them.
    """
    identity = int(np.flatnonzero((table == np.arange(len(table))).all(axis=1))[0])
    usable = frozenset(np.flatnonzero(allowed).tolist()) | {identity}
    start = frozenset({identity})
    found, waiting = {start}, [start]
    while waiting and len(found) < MOST:
        subgroup = waiting.pop()
        for element in usable - subgroup:
            larger = generated(table, subgroup | {element})
            if larger <= usable and larger not in found:
                found.add(larger)
                waiting.append(larger)
    for order in sorted({len(subgroup) for subgroup in found}, reverse=True):
        ranked = [(accepted(sorted(s)), sorted(s)) for s in found if len(s) == order]
        agreement, best = max(ranked, key=lambda pair: (pair[0], pair[1]))
        if agreement > 0.0:
            return best
    return [identity]
