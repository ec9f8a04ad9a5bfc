"""Dirichlet cell of a crystallographic group: the points nearer to a centre than to its images."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from symbolic.errors import InputError
from symbolic.lattice_points import (
    Floats,
    Integers,
    covering_radius_bound,
    lattice_points_within,
    reduced_basis,
)

TURN = 2 * np.pi
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
    vertices : (v, r) array
        Corners of the cell [rad].
    """

    center: Floats
    metric: Floats
    basis: Integers
    normals: Floats
    offsets: Floats
    element: Integers
    turns: Integers
    vertices: Floats

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
        Integer linear parts of a group modulo 2 pi, in y = B q coordinates.
    d : (G, r) array
        Offsets [rad].
    center : (r,) array
        A point that no map of the group but the identity fixes.

    Raises
    ------
    InputError
        If a matrix is not integer, or the centre is fixed, or nearly, by a map of the group.

    Notes
    -----
    Only images within twice the circumradius of the cell can bound it. Images are enumerated
    (Fincke-Pohst) in a growing ball until twice the circumradius of the polytope they bound fits
    in; the covering radius of the lattice 2 pi Z^r caps the ball. The polytope is computed as the
    convex hull of the dual points (Qhull). A half-space is a facet where the corners that lie on
    it span r - 1 dimensions, all others are redundant.

    References
    ----------
    Schwarzenberger, N-dimensional crystallography, Pitman 1980 (Dirichlet cells).
    Barber, Dobkin, Huhdanpaa, The quickhull algorithm, ACM TOMS 22, 1996.

    Examples
    --------
    >>> mirror = dirichlet_cell(np.array([[[1]], [[-1]]]), np.zeros((2, 1)), np.array([1.0]))
    >>> mirror.halfspaces.round(4).tolist()
    [[-1.0, 0.0], [1.0, 3.1416]]
    """
    total = invariant_metric(A)
    order, r = len(A), len(center)
    metric = total / order
    basis = reduced_basis(total)
    if r == 0:
        none = np.zeros((0, 0))
        whole = none.astype(np.int64)
        empty = np.zeros(0, dtype=np.int64)
        return DirichletCell(
            center, metric, basis, none, np.zeros(0), empty, whole, np.zeros((1, 0))
        )
    upper = np.linalg.cholesky(metric).T
    shift = (np.einsum("gij,j->gi", A, center) + d - center) / TURN
    largest = 2 * TURN * covering_radius_bound(metric, basis)
    radius = min(largest, _ball_radius(r, 8.0 * 2**r * TURN**r * upper.diagonal().prod() / order))
    while True:
        element, turns = lattice_points_within(metric, basis, shift, radius / TURN)
        steps = TURN * (turns + shift[element]) @ upper.T
        length = np.linalg.norm(steps, axis=1)
        nearest = np.argsort(length, kind="stable")[1:]  # the first is the centre itself
        if len(nearest) and length[nearest[0]] < LEAST_SEPARATION:
            raise InputError(
                "fundamental domain",
                f"distance of the centre (y = {np.round(center, 6).tolist()}) from its images",
                f"{length[nearest[0]]:.2g} rad",
                "a generic centre, moved by every relation but the identity",
            )
        corners = _corners(steps[nearest])
        reach = np.linalg.norm(corners, axis=1).max(initial=0.0) if len(corners) else math.inf
        if radius >= largest or 2 * reach <= radius:
            break
        radius = min(largest, 2.001 * reach, 1.6 * radius)
    chosen = nearest[_is_facet(steps[nearest], corners)]
    chosen = chosen[np.lexsort((*turns[chosen].T[::-1], element[chosen], length[chosen].round(9)))]
    normals = steps[chosen] @ upper
    return DirichletCell(
        center=center,
        metric=metric,
        basis=basis,
        normals=normals,
        offsets=length[chosen] ** 2 / 2 + normals @ center,
        element=element[chosen],
        turns=turns[chosen],
        vertices=np.linalg.solve(upper, _distinct(corners).T).T + center,
    )


def _ball_radius(r: int, volume: float) -> float:
    """Return the radius of the r-dimensional ball of the given volume."""
    return float((volume * math.gamma(r / 2 + 1)) ** (1 / r) / math.sqrt(math.pi))


def _corners(steps: Floats) -> Floats:
    """Return the corners of {u : steps . u <= |steps|^2 / 2}; none if that is unbounded.

    The corners are the facets of the convex hull of the dual points ``2 s / |s|^2``.
    """
    dual = 2 * steps / (steps**2).sum(axis=1, keepdims=True)
    if steps.shape[1] == 1:
        ends = np.array([dual.min(initial=0.0), dual.max(initial=0.0)])
        return (1 / ends)[:, None] if ends[0] < 0 < ends[1] else dual[:0]
    try:
        hull = ConvexHull(dual)
    except (QhullError, ValueError):  # too few points, or all in one plane
        return dual[:0]
    outward, below = hull.equations[:, :-1], hull.equations[:, -1]
    if below.max() > -1e-9 * np.abs(dual).max():
        return dual[:0]
    return np.asarray(-outward / below[:, None])


def _distinct(corners: Floats) -> Floats:
    """Return corners without repetitions (a corner of many facets is found more than once)."""
    pairs = cKDTree(corners).query_pairs(1e-8 * np.abs(corners).max(), output_type="ndarray")
    return np.asarray(np.delete(corners, pairs[:, 1], axis=0))


def _is_facet(steps: Floats, corners: Floats) -> NDArray[np.bool_]:
    """Say which half-spaces meet the polytope in a face of r - 1 dimensions."""
    r = steps.shape[1]
    half = (steps**2).sum(axis=1) / 2
    touching = steps @ corners.T >= (half * (1 - 1e-11))[:, None]
    facet = touching.sum(axis=1) >= r
    for i in np.flatnonzero(facet):
        face = corners[touching[i]]
        spread = np.linalg.svd(face - face.mean(axis=0), compute_uv=False)
        facet[i] = r == 1 or spread[r - 2] > 1e-9 * math.sqrt(2 * half[i])
    return facet
