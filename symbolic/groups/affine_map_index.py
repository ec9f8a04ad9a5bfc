"""Index of affine maps: found in a list of relations, offsets compared modulo full turns."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.common.angles import circular_distance
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.errors import InputError

SAME_EXACT_OFFSET = 1e-2
"""Offsets that differ by less [rad] are taken as equal: those of learned relations fit together
only nearly, and different relations of one matrix are much further apart."""


class RelationLookup:
    """Index of maps ``y -> A y + d`` modulo 2 pi.

    Parameters
    ----------
    A, d : (G, r, r) int and (G, r) arrays
        The maps, all different.
    """

    def __init__(self, A: Integers, d: Floats) -> None:
        self._d = d
        classes: dict[bytes, list[int]] = {}
        for index, matrix in enumerate(np.ascontiguousarray(A, dtype=np.int64)):
            classes.setdefault(matrix.tobytes(), []).append(index)
        self._classes = {key: np.array(members) for key, members in classes.items()}

    def find(self, A: Integers, d: Floats) -> Integers:
        """Return the index of each of the maps ``A`` (m, r, r), ``d`` (m, r).

        Raises
        ------
        InputError
            If one is not in the list.
        """
        found = np.full(len(A), -1, dtype=np.int64)
        wanted: dict[bytes, list[int]] = {}
        for row, matrix in enumerate(np.ascontiguousarray(A, dtype=np.int64)):
            wanted.setdefault(matrix.tobytes(), []).append(row)
        for key, rows in wanted.items():
            members = self._classes.get(key)
            if members is not None:
                distance = circular_distance(d[rows][:, None], self._d[members])
                best = distance.argmin(axis=1)
                near = distance[np.arange(len(rows)), best] < SAME_EXACT_OFFSET
                found[np.array(rows)[near]] = members[best[near]]
        if np.any(found < 0):
            row = int(np.argmin(found))
            raise InputError(
                "fundamental domain",
                "product of relations",
                f"A_sat = {A[row].tolist()}, d_sat = {np.round(d[row], 6).tolist()}, not listed",
                "relations closed under composition and inverse",
            )
        return found
