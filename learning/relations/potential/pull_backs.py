"""Pull-backs of a potential's coefficients by relations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.groups.group_arrays import CandidateGroup, Ints

Array = NDArray[np.float64]


class PullBacks:
    """Maps C_k -> s_k exp(-i k.d) C_{s_k Y k} of the relations of a group, A^T k = s_k Y k.

    Parameters
    ----------
    frequencies : (m, n) int array
        Frequencies of the potential, one of each pair +-k.
    group : CandidateGroup

    Attributes
    ----------
    coordinates : (m, r) int array
        Coordinates c with k = c B; zero where k lies outside the span of B.

    Notes
    -----
    Coefficients are real pairs (a, b), C = (a - i b) / 2. A potential has the symmetry exactly if
    its coefficients are a fixed point (docs/theory.md); where A^T k is not
    +-Y k, or that frequency is not among the given ones, the image is zero.
    """

    def __init__(self, frequencies: Ints, group: CandidateGroup) -> None:
        self._frequencies = np.ascontiguousarray(frequencies)
        self._group = group
        rows = group.basis.astype(float)
        raw = frequencies @ np.linalg.pinv(rows) if len(rows) else np.zeros((len(frequencies), 0))
        coordinates = np.round(raw).astype(np.int64)
        self._inside = (coordinates @ group.basis == frequencies).all(axis=1)
        coordinates[~self._inside] = 0
        self.coordinates = coordinates
        self._place = {k.tobytes(): j for j, k in enumerate(self._frequencies)}

    def matrix(self, i: int) -> Array:
        """Map of relation i on all a_k, then all b_k: shape (2 m, 2 m)."""
        frequencies, group = self._frequencies, self._group
        m = len(frequencies)
        moved = self.coordinates @ group.A[i] @ group.basis
        flipped = np.ascontiguousarray(frequencies * group.Y[i].astype(np.int64))
        plus = (np.abs(moved - flipped) < 1e-6).all(axis=1)
        minus = (np.abs(moved + flipped) < 1e-6).all(axis=1)
        phase = self.coordinates @ group.d[i]
        matrix = np.zeros((2 * m, 2 * m))
        for row in np.flatnonzero(self._inside & (plus | minus)):
            s = 1 if plus[row] else -1
            k = s * flipped[row]
            column, mirror = self._place.get(k.tobytes()), 1
            if column is None:
                column, mirror = self._place.get((-k).tobytes()), -1
            if column is None:
                continue
            cosine, sine = s * np.cos(phase[row]), s * np.sin(phase[row])
            matrix[row, column], matrix[row, m + column] = cosine, -mirror * sine
            matrix[m + row, column], matrix[m + row, m + column] = sine, mirror * cosine
        return matrix

    def average(self) -> Array:
        """Reynolds operator: projector onto the potentials with all symmetries of the group."""
        m = len(self._frequencies)
        total = np.zeros((2 * m, 2 * m))
        alive = np.ones(2 * m, dtype=bool)
        for i in range(len(self._group)):
            pulled = self.matrix(i)
            alive &= pulled.any(axis=1)
            total += pulled
        total[~alive] = 0.0
        return total / len(self._group)
