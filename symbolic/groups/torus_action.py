"""A symmetry group as integer maps of a torus, also where its matrices A_sat are fractional."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.lattices.integer_lattice import hermite


@dataclass(frozen=True, eq=False)
class TorusAction:
    """A group acting by ``w -> A w + d`` modulo 2 pi, in coordinates w with y = scale w.

    Attributes
    ----------
    scale : (r, r) array
        The identity, except where relations are no maps of the torus of y = B q.
    A, d : (g, r, r) and (g, r) arrays
        Integer matrices, all different where ``scale`` is not the identity, and offsets [rad].
    members : (g, k) int array
        The relations of the given list that each map stands for: they differ by translations
        that are full turns of w.
    """

    scale: Floats
    A: Floats
    d: Floats
    members: Integers

    @property
    def is_plain(self) -> bool:
        """Whether w is y and every map stands for one relation."""
        return self.members.shape[1] == 1

    def relations(
        self, offsets: Floats, element: Integers, turns: Integers
    ) -> tuple[Integers, Integers]:
        """Translate maps and turns of w into relations and turns of y.

        Parameters
        ----------
        offsets : (G, r) array
            The offsets d_sat of the relations.
        element, turns : (m,) and (m, r) int arrays
            Maps of the torus and full turns of w.

        Returns
        -------
        relation : (m,) int array
        turns : (m, r) int array
            The same maps as ``y -> A_sat y + d_sat + 2 pi turns``.
        """
        if self.is_plain:
            return self.members[element, 0], turns
        wanted = (self.d[element] + TURN * turns) @ self.scale.T
        missing = (wanted[:, None] - offsets[self.members[element]]) / TURN
        whole = np.rint(missing)
        best = np.abs(missing - whole).max(axis=2, initial=0.0).argmin(axis=1)
        rows = np.arange(len(element))
        return self.members[element, best], whole[rows, best].astype(np.int64)


def torus_action(A: NDArray[np.number], d: Floats) -> TorusAction:
    """Return coordinates in which a group acts by integer maps.

    Parameters
    ----------
    A, d : (G, r, r) and (G, r) arrays
        Linear parts and offsets [rad] of all relations in y = B q coordinates.

    Raises
    ------
    InputError
        If there are none: the relations are no finite group modulo 2 pi.

    Notes
    -----
    Matrices A_sat of revolute arms are integer. Fitted or made-up potentials can have fractional
    ones; they map the turns of y into the lattice of all translations of the group (their
    frequencies generate a sublattice L of the saturated one). In coordinates of that lattice every
    matrix is integer.

    Examples
    --------
    >>> torus_action(np.array([[[1]], [[-1]]]), np.zeros((2, 1))).is_plain
    True
    """
    order, r = d.shape
    linear = np.asarray(A, dtype=float)
    if np.allclose(linear, np.round(linear), atol=1e-9):
        return TorusAction(np.eye(r), np.round(linear), d, np.arange(order)[:, None])
    same = np.abs(linear[:, None] - linear).max(axis=(2, 3)) < 1e-6
    first = np.flatnonzero(np.argmax(same, axis=1) == np.arange(order))
    count = same[first].sum(axis=1)
    translations = np.flatnonzero(np.abs(linear - np.eye(r)).max(axis=(1, 2)) < 1e-6)
    fractions = np.rint(d[translations] / TURN * len(translations)).astype(np.int64)
    steps = hermite(np.concatenate([fractions, len(translations) * np.eye(r, dtype=np.int64)]))
    scale = steps.T / len(translations)
    matrices = np.linalg.solve(scale, linear[first] @ scale)
    if np.any(count != len(translations)) or not np.allclose(
        matrices, np.round(matrices), atol=1e-6
    ):
        raise InputError(
            "fundamental domain",
            "A_sat",
            linear[np.abs(linear - np.round(linear)).max(axis=(1, 2)).argmax()].tolist(),
            "relations that form a group modulo 2 pi",
        )
    return TorusAction(
        scale=scale,
        A=np.round(matrices),
        d=np.asarray(np.linalg.solve(scale, d[first].T).T, dtype=float),
        members=np.array([np.flatnonzero(row) for row in same[first]]),
    )
