"""Dirichlet cell of a crystallographic group: the points nearer to a centre than to its images."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.affine_map_index import RelationLookup
from isotorque.symbolic.groups.direct_factors import TorusFactor, direct_factors
from isotorque.symbolic.lattices.short_vectors import (
    covering_radius_bound,
    lattice_points_within,
    reduced_basis,
)
from isotorque.symbolic.lattices.voronoi_polytope import distinct, nearer_to_origin

LARGEST_RANK = 10
"""Cells of more dimensions (direct factors apart) have too many corners."""
LEAST_SEPARATION = 1e-3
"""A centre nearer to one of its images than this [rad, in the group's metric] is refused."""


@dataclass(frozen=True, eq=False)
class DirichletCell:
    """Convex polytope of the points y that no image of the centre is nearer to.

    Attributes
    ----------
    center : (r,) array
        The centre c [rad].
    metric : (r, r) array
        Scalar product in which every map of the group is an isometry.
    basis : (r, r) int array
        Basis of Z^r, reduced in that metric, in its rows.
    normals : (f, r) array
        Row per facet such that ``normals . y - offsets`` is half of how much nearer, in squared
        distance, y is to the image beyond the facet than to the centre.
    offsets : (f,) array
        See ``normals``; the cell is ``normals . y <= offsets``.
    element, turns : (f,) and (f, r) int arrays
        The image beyond a facet is ``A[element] c + d[element] + 2 pi turns``.
    factors : tuple of (v_i, r_i) arrays
        Corners of the factors of the cell, each in its own coordinates (a single factor, unless
        the group is a direct product).
    coordinates : tuple of (r_i,) int arrays
        The coordinates of each factor.
    """

    center: Floats
    metric: Floats
    basis: Integers
    normals: Floats
    offsets: Floats
    element: Integers
    turns: Integers
    factors: tuple[Floats, ...]
    coordinates: tuple[Integers, ...]

    @property
    def vertices(self) -> Floats:
        """Corners of the cell [rad], shape (v, r)."""
        vertices = np.zeros((1, len(self.center)))
        for corners, part in zip(self.factors, self.coordinates, strict=True):
            count = len(vertices)
            vertices = np.repeat(vertices, len(corners), axis=0)
            vertices[:, part] = np.tile(corners, (count, 1))
        return vertices

    @property
    def halfspaces(self) -> Floats:
        """Rows ``[a.., b]`` with ``a . y <= b``, largest entry of a in size 1; shape (f, r + 1)."""
        return tidy_halfspaces(self.normals, self.offsets)


def tidy_halfspaces(normals: Floats, offsets: Floats) -> Floats:
    """Return rows ``[a.., b]`` scaled to a largest entry of 1, cleaned of rounding."""
    scale = np.abs(normals).max(axis=1, initial=0.0)
    rows = np.column_stack([normals, offsets]) / scale[:, None]
    whole = np.round(rows)
    return np.where(np.abs(rows - whole) < 1e-12, whole, rows) + 0.0


def invariant_metric(A: NDArray[np.number]) -> Integers:
    """Return the sum of A^T A over a finite group of integer matrices (G, r, r).

    Every matrix of the group is an isometry of this scalar product.

    Raises
    ------
    InputError
        If the matrices are not integer.
    """
    rounded = np.round(A)
    if not np.allclose(A, rounded, atol=1e-9):
        raise InputError(
            "fundamental domain",
            "A_sat",
            np.asarray(A)[np.any(np.abs(A - rounded) > 1e-9, axis=(1, 2))][0].tolist(),
            "integer matrices (maps of the torus y = B q modulo 2 pi)",
        )
    whole = rounded.astype(np.int64)
    return np.asarray(np.einsum("gki,gkj->ij", whole, whole))


def dirichlet_cell(A: NDArray[np.number], d: Floats, center: Floats) -> DirichletCell:
    """Build the Dirichlet cell of a group acting on R^r together with the turns 2 pi Z^r.

    Parameters
    ----------
    A : (G, r, r) array
        Integer linear parts of a group modulo 2 pi; all maps (A, d) different.
    d : (G, r) array
        Offsets [rad].
    center : (r,) array
        A point that no map of the group but the identity fixes.

    Raises
    ------
    InputError
        If a matrix is not integer, if the centre is fixed, or nearly, by a map of the group, or
        if there are too many dimensions.

    Notes
    -----
    Only images within twice the circumradius of the cell can bound it. Images are enumerated
    (Fincke-Pohst) in a growing ball until twice the circumradius of the polytope they bound fits
    in; the covering radius of the lattice 2 pi Z^r caps the ball. The cell of a direct product is
    the product of the cells of its factors.

    References
    ----------
    Schwarzenberger, N-dimensional crystallography, Pitman 1980 (Dirichlet cells).

    Examples
    --------
    >>> mirror = dirichlet_cell(np.array([[[1]], [[-1]]]), np.zeros((2, 1)), np.array([1.0]))
    >>> mirror.halfspaces.round(4).tolist()
    [[-1.0, 0.0], [1.0, 3.1416]]
    """
    total = invariant_metric(A)
    metric = total / len(A)
    blocks = direct_factors(np.round(A), d)
    parts = [_factor(block, center[block.coordinates]) for block in blocks]
    r = len(center)
    basis = np.zeros((r, r), dtype=np.int64)
    lookup = RelationLookup(np.round(A).astype(np.int64), d)
    normals, elements, turns = [], [], []
    for block, part in zip(blocks, parts, strict=True):
        here = block.coordinates
        f = len(part.element)
        basis[np.ix_(here, here)] = part.basis
        step, full = np.zeros((f, r)), np.zeros((f, r), dtype=np.int64)
        step[:, here] = part.steps
        linear, offset = np.tile(np.eye(r, dtype=np.int64), (f, 1, 1)), np.zeros((f, r))
        linear[:, here[:, None], here] = block.A[part.element]
        offset[:, here] = block.d[part.element]
        element = lookup.find(linear, offset)
        full[:, here] = part.turns + np.rint((offset - d[element])[:, here] / TURN).astype(int)
        normals.append(step @ metric)
        elements.append(element)
        turns.append(full)
    normal = np.concatenate(normals) if blocks else np.zeros((0, r))
    half = [np.einsum("fi,ij,fj->f", p.steps, p.metric, p.steps) / 2 for p in parts]
    return DirichletCell(
        center=center,
        metric=metric,
        basis=basis,
        normals=normal,
        offsets=(np.concatenate(half) if blocks else np.zeros(0)) + normal @ center,
        element=np.concatenate(elements) if blocks else np.zeros(0, dtype=np.int64),
        turns=np.concatenate(turns) if blocks else np.zeros((0, r), dtype=np.int64),
        factors=tuple(part.corners for part in parts),
        coordinates=tuple(block.coordinates for block in blocks),
    )


@dataclass(frozen=True, eq=False)
class _Factor:
    """The Dirichlet cell of one block; ``steps`` lead from the centre to the bounding images."""

    metric: Floats
    basis: Integers
    steps: Floats
    element: Integers
    turns: Integers
    corners: Floats


def _factor(block: TorusFactor, center: Floats) -> _Factor:
    """Build the cell of one block of coordinates."""
    r = len(center)
    if r > LARGEST_RANK:
        raise InputError(
            "fundamental domain",
            "rank of the symmetry group (direct factors apart)",
            r,
            f"at most {LARGEST_RANK}",
        )
    total = invariant_metric(block.A)
    metric = total / len(block.A)
    basis = reduced_basis(total)
    upper = np.linalg.cholesky(metric).T
    shift = (np.einsum("gij,j->gi", block.A, center) + block.d - center) / TURN
    largest = 2 * TURN * covering_radius_bound(metric, basis)
    per_image = TURN**r * upper.diagonal().prod() / len(block.A)
    radius = min(largest, _ball_radius(r, 8.0 * 2**r * per_image))
    while True:
        element, turns = lattice_points_within(metric, basis, shift, radius / TURN)
        steps = TURN * (turns + shift[element])
        length = np.linalg.norm(steps @ upper.T, axis=1)
        nearest = np.argsort(length, kind="stable")[1:]  # the first is the centre itself
        if len(nearest) and length[nearest[0]] < LEAST_SEPARATION:
            raise InputError(
                "fundamental domain",
                f"distance of the centre (y = {np.round(center, 6).tolist()}) from its images",
                f"{length[nearest[0]]:.2g} rad",
                "a generic centre, moved by every relation but the identity",
            )
        corners, facets = nearer_to_origin(steps[nearest] @ upper.T)
        reach = np.linalg.norm(corners, axis=1).max(initial=0.0) if len(corners) else math.inf
        if 2 * reach <= radius or radius >= largest:
            break
        radius = min(largest, 2.001 * reach, 1.6 * radius)
    chosen = nearest[facets]
    chosen = chosen[np.lexsort((*turns[chosen].T[::-1], element[chosen], length[chosen].round(9)))]
    return _Factor(
        metric=metric,
        basis=basis,
        steps=steps[chosen],
        element=element[chosen],
        turns=turns[chosen],
        corners=np.linalg.solve(upper, distinct(corners).T).T + center,
    )


def _ball_radius(r: int, volume: float) -> float:
    """Return the radius of the r-dimensional ball of the given volume."""
    return float((volume * math.gamma(r / 2 + 1)) ** (1 / r) / math.sqrt(math.pi))
