"""Polytopes of nearest points, against linear programmes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from isotorque.symbolic.lattices.voronoi_polytope import distinct, nearer_to_origin


@settings(max_examples=25)
@given(st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_facets_are_the_half_spaces_that_cut(r, seed):
    rng = np.random.default_rng(seed)
    points = np.concatenate([4 * np.eye(r), -4 * np.eye(r), rng.uniform(-3, 3, (20, r))])
    half = (points**2).sum(axis=1) / 2
    corners, facets = nearer_to_origin(points)
    assert (points @ corners.T - half[:, None]).max() < 1e-8
    for i, (point, limit) in enumerate(zip(points, half, strict=True)):
        others = np.arange(len(points)) != i
        best = -linprog(-point, points[others], half[others], bounds=[(-9, 9)] * r).fun
        if abs(best - limit) > 1e-6:
            assert (i in facets) == (best > limit)


@pytest.mark.parametrize("r", [2, 3, 4])
def test_half_spaces_that_only_touch_are_no_facets(r):
    """The cube, with the half-spaces that touch it in its edges and corners."""
    steps = np.array(list(np.ndindex(*[3] * r))) - 1.0
    steps = steps[np.abs(steps).sum(axis=1) > 0]
    corners, facets = nearer_to_origin(steps)
    assert len(distinct(corners)) == 2**r
    assert (np.abs(steps[facets]).sum(axis=1) == 1).all()
    assert len(facets) == 2 * r


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((0, 2)),
        np.eye(2),
        np.array([[1.0, 0.0], [-1.0, 0.0], [2.0, 0.0]]),
        np.array([[1.0], [2.0]]),
    ],
)
def test_unbounded_has_no_corners(points):
    corners, facets = nearer_to_origin(points)
    assert len(corners) == 0
    assert len(facets) == 0
