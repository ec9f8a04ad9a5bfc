"""A centre that every relation of a group moves as far as possible, for a Dirichlet cell."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.domains.dirichlet_cell import invariant_metric
from isotorque.symbolic.groups.direct_factors import direct_factors
from isotorque.symbolic.lattices.short_vectors import reduced_basis

_MOST_GRID_POINTS = 4096
_IRREGULAR_POINTS = 512


def generic_center(A: NDArray[np.number], d: Floats) -> Floats:
    """Choose a centre y for the Dirichlet cell of a group.

    Parameters
    ----------
    A, d : (G, r, r) and (G, r) arrays
        The group, modulo 2 pi, in y = B q coordinates.

    Returns
    -------
    (r,) array
        A point far from all of its images [rad], hence far from every fixed point: a multiple of
        pi/4 in each coordinate where such a point is nearly as good as any (simple half-spaces),
        the one nearest to y = 0, positive coordinates first. Always the same for the same group.

    Examples
    --------
    >>> mirror = np.array([[[1]], [[-1]]])
    >>> generic_center(mirror, np.zeros((2, 1))).round(4).tolist()
    [1.5708]
    """
    center = np.zeros(d.shape[1])
    for block in direct_factors(np.round(A), d):
        center[block.coordinates] = _block_center(block.A, block.d)
    return center


def _block_center(A: Floats, d: Floats) -> Floats:
    """Choose the centre for a group that is no direct product."""
    r = d.shape[1]
    grid = _grid(r)
    irregular = TURN * (_additive_sequence(_IRREGULAR_POINTS, r) - 0.5)
    grid_apart, irregular_apart = (_separation(A, d, x) for x in (grid, irregular))
    best = irregular_apart.max()
    if grid_apart.max() >= 0.6 * best:
        good = grid[grid_apart >= grid_apart.max() * (1 - 1e-9)]
        eighths = np.rint(good * 4 / np.pi).astype(int)
        order = np.lexsort((*(-eighths).T[::-1], (eighths**2).sum(axis=1)))
        return np.asarray(good[order[0]])
    return np.asarray(irregular[np.argmax(irregular_apart)])


def _grid(r: int) -> Floats:
    """Return points of the pi/4 grid in (-pi, pi]: all of them where they are few."""
    if 8**r <= _MOST_GRID_POINTS:
        steps = np.array(list(itertools.product(range(-3, 5), repeat=r)), dtype=float)
    else:
        steps = np.unique(np.rint(8 * _additive_sequence(_MOST_GRID_POINTS, r)) - 3, axis=0)
    return steps * np.pi / 4 + 0.0


def _additive_sequence(count: int, r: int) -> Floats:
    """Return evenly spread points of [0, 1)^r: multiples of powers of a generalised golden ratio.

    References
    ----------
    Roberts, The unreasonable effectiveness of quasirandom sequences, 2018 (the R_d sequence).
    """
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (r + 1))
    steps = ratio ** -np.arange(1.0, r + 1)
    return np.asarray(np.remainder(0.5 + np.outer(np.arange(1, count + 1), steps), 1.0))


def _separation(A: NDArray[np.number], d: Floats, points: Floats) -> Floats:
    """Return the distance of each point from its nearest image, nearly (Babai rounding)."""
    total = invariant_metric(A)
    basis = reduced_basis(total).astype(float)
    length = np.linalg.cholesky(basis @ total @ basis.T / len(A)).T
    to_basis = np.linalg.inv(basis)
    nearest = np.full(len(points), np.inf)
    r = points.shape[1]
    for matrix, offset in zip(A, d, strict=True):
        away = (points @ (matrix.T - np.eye(r)) + offset) / TURN @ to_basis
        away -= np.rint(away)
        distance = TURN * np.linalg.norm(away @ length.T, axis=1)
        if distance.max() < 1e-9:  # the identity
            continue
        np.minimum(nearest, distance, out=nearest)
    return np.where(np.isinf(nearest), TURN, nearest)
