"""Corners and facets of the polytope of points nearer to the origin than to given points."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from isotorque.symbolic.common.arrays import Floats, Integers


def nearer_to_origin(points: Floats) -> tuple[Floats, Integers]:
    """Return corners and facets of {u : points . u <= |points|^2 / 2}.

    Parameters
    ----------
    points : (m, r) array
        None of them the origin; r >= 1.

    Returns
    -------
    corners : (v, r) array
        Corners of the polytope, none if it is unbounded; a corner can appear more than once.
    facets : (f,) int array
        Indices of the points whose half-spaces meet the polytope in r - 1 dimensions; the other
        half-spaces are redundant.

    Notes
    -----
    The corners are the facets of the convex hull of the dual points ``2 p / |p|^2``. Half-spaces
    that only touch the polytope in a corner or an edge, which hulls of symmetric sets abound in,
    are told from facets by the dimension that the corners on them span.

    References
    ----------
    Barber, Dobkin, Huhdanpaa, The quickhull algorithm for convex hulls, ACM TOMS 22, 1996.

    Examples
    --------
    >>> corners, facets = nearer_to_origin(np.array([[2.0], [-4.0], [6.0]]))
    >>> corners.tolist(), facets.tolist()
    ([[-2.0], [1.0]], [0, 1])
    """
    r = points.shape[1]
    unbounded = points[:0], np.zeros(0, dtype=np.int64)
    if not len(points):
        return unbounded
    dual = 2 * points / (points**2).sum(axis=1, keepdims=True)
    if r == 1:
        ends = np.array([dual[:, 0].argmin(), dual[:, 0].argmax()])
        if not dual[ends[0], 0] < 0 < dual[ends[1], 0]:
            return unbounded
        return 1 / dual[ends], np.sort(ends)
    try:
        hull = ConvexHull(dual)
    except (QhullError, ValueError):  # too few points, or all in one plane
        return unbounded
    outward, below = hull.equations[:, :-1], hull.equations[:, -1]
    if below.max() > -1e-9 * np.abs(dual).max():
        return unbounded
    corners = -outward / below[:, None]
    candidates = np.sort(hull.vertices).astype(np.int64)
    half = (points[candidates] ** 2).sum(axis=1) / 2
    touching = points[candidates] @ corners.T >= (half * (1 - 1e-11))[:, None]
    facet = touching.sum(axis=1) >= r
    for i in np.flatnonzero(facet):
        face = corners[touching[i]]
        spread = np.linalg.svd(face - face.mean(axis=0), compute_uv=False)
        facet[i] = spread[r - 2] > 1e-9 * math.sqrt(2 * half[i])
    return corners, candidates[facet]


def distinct(points: Floats) -> Floats:
    """Return points (m, r) without repetitions, up to rounding."""
    near = 1e-8 * np.abs(points).max(initial=0.0)
    pairs = cKDTree(points).query_pairs(near, output_type="ndarray")
    return np.asarray(np.delete(points, pairs[:, 1], axis=0))
