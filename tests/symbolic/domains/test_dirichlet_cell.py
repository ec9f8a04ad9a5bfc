"""Dirichlet cells, against linear programmes, convex hulls and plain nearest-image search."""

import itertools

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.dirichlet_cell import dirichlet_cell
from isotorque.symbolic.domains.generic_center import generic_center
from isotorque.symbolic.groups.torus_action import torus_action
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import potentials, three_r, two_r


@st.composite
def cells(draw, least_rank=1):
    group = primary_symmetries(draw(potentials(max_joints=3)))
    assume(group.rank >= least_rank)
    action = torus_action(group.A_sat, group.d_sat)
    center = generic_center(action.A, action.d)
    if draw(st.booleans()):
        center = center + np.array([draw(st.floats(-0.05, 0.05)) for _ in center])
    return action, dirichlet_cell(action.A, action.d, center)


def images_of(action, w, turns=3):
    """Return all images of w with up to ``turns`` full turns per coordinate, shape (p, r)."""
    z = 2 * np.pi * np.array(list(itertools.product(range(-turns, turns + 1), repeat=len(w))))
    near = np.einsum("gij,j->gi", action.A, w) + action.d
    return (near[:, None] + z).reshape(-1, len(w))


@given(cells())
def test_volume_is_that_of_the_torus_over_the_order(case):
    action, cell = case
    order, r = action.d.shape
    hull = np.ptp(cell.vertices) if r == 1 else ConvexHull(cell.vertices).volume
    assert hull == pytest.approx((2 * np.pi) ** r / order, rel=1e-9)


@given(cells())
def test_relations_are_isometries_of_the_metric(case):
    action, cell = case
    for A in action.A:
        np.testing.assert_allclose(A.T @ cell.metric @ A, cell.metric, atol=1e-12)


@given(cells())
def test_no_half_space_is_redundant_and_corners_are_corners(case):
    _, cell = case
    r = len(cell.center)
    rows = cell.halfspaces
    slack = rows[:, -1] - cell.vertices @ rows[:, :-1].T
    assert slack.min() > -1e-9
    for slacks in slack:  # a corner: r independent half-spaces are tight there
        assert np.linalg.matrix_rank(rows[slacks < 1e-7, :-1], tol=1e-9) == r
    for i, row in enumerate(rows):
        others = np.delete(rows, i, axis=0)
        bounds = [(-50, 50)] * r
        best = linprog(-row[:-1], others[:, :-1], others[:, -1], bounds=bounds)
        assert best.status == 0
        assert -best.fun > row[-1] + 1e-10


@given(cells(), st.integers(0, 2**32 - 1))
def test_cell_is_where_no_image_of_the_centre_is_nearer(case, seed):
    action, cell = case
    images = images_of(action, cell.center)
    rng = np.random.default_rng(seed)
    low, high = cell.vertices.min(axis=0) - 0.5, cell.vertices.max(axis=0) + 0.5
    for y in rng.uniform(low, high, (20, len(low))):
        away = images - y
        nearest = np.sqrt(np.einsum("pi,ij,pj->p", away, cell.metric, away).min())
        own = np.sqrt((cell.center - y) @ cell.metric @ (cell.center - y))
        if abs(own - nearest) < 1e-9 and own > nearest:
            continue
        inside = bool(np.all(cell.halfspaces[:, :-1] @ y <= cell.halfspaces[:, -1]))
        assert inside == (own <= nearest)


@given(cells())
def test_each_facet_halves_the_way_to_the_image_it_names(case):
    action, cell = case
    for normal, offset, g, z in zip(
        cell.normals, cell.offsets, cell.element, cell.turns, strict=True
    ):
        image = action.A[g] @ cell.center + action.d[g] + 2 * np.pi * z
        np.testing.assert_allclose(normal, cell.metric @ (image - cell.center), atol=1e-9)
        assert normal @ (image + cell.center) / 2 == pytest.approx(offset)


@pytest.mark.parametrize(
    ("potential", "center", "facets"),
    [
        (two_r(), [0.3, 0.5], 4),
        (three_r(), [0.3, 0.5, 0.8], 8),
    ],
)
def test_known_numbers_of_facets(potential, center, facets):
    group = primary_symmetries(potential)
    cell = dirichlet_cell(group.A_sat, group.d_sat, np.array(center))
    assert len(cell.halfspaces) == facets


def test_a_fixed_centre_is_refused():
    group = primary_symmetries(two_r())
    for center in ([-np.pi / 2, 0.0], [0.0, 1.0], [0.0, 0.0], [1e-4, 1.0]):
        with pytest.raises(InputError, match="generic centre"):
            dirichlet_cell(group.A_sat, group.d_sat, np.array(center))


def test_maps_that_are_none_of_the_torus_are_refused():
    A = np.array([np.eye(2), [[0.5, 0.0], [0.0, 1.0]]])
    with pytest.raises(InputError, match="integer matrices"):
        dirichlet_cell(A, np.zeros((2, 2)), np.array([0.3, 0.4]))


def test_rank_zero_is_one_point():
    none = np.zeros((1, 0))
    cell = dirichlet_cell(np.zeros((1, 0, 0)), none, none[0])
    assert cell.vertices.shape == (1, 0)
    assert cell.halfspaces.shape == (0, 1)


def signed_permutations(generators):
    """Close signed permutation matrices to a group."""
    members = [np.eye(len(generators[0]), dtype=np.int64)]
    for member in members:
        for generator in generators:
            product = generator @ member
            if not any(np.array_equal(product, other) for other in members):
                members.append(product)
    return np.array(members)


@st.composite
def slender_cells(draw):
    """Groups in coordinates so skew that turns are long in some directions of the metric."""
    r = draw(st.integers(2, 3))
    generators = [
        np.eye(r, dtype=np.int64)[draw(st.permutations(range(r)))]
        * np.array([draw(st.sampled_from([1, -1])) for _ in range(r)])
        for _ in range(draw(st.integers(1, 2)))
    ]
    skew = np.eye(r, dtype=np.int64)
    for _ in range(draw(st.integers(1, 4))):
        i, j = draw(st.permutations(range(r)))[:2]
        shear = np.eye(r, dtype=np.int64)
        shear[i, j] = draw(st.integers(-9, 9))
        skew = skew @ shear
    center = [draw(st.floats(-np.pi, np.pi)) for _ in range(r)]
    return generators, skew, center


@given(slender_cells())
@example(
    (
        [np.array([[0, -1, 0], [-1, 0, 0], [0, 0, -1]])],
        np.array([[1, 4, 0], [-3, -11, 0], [7, 0, 1]]),
        [-1.72, -2.36, -1.33],
    )
)
@example(
    (
        [np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0]])],
        np.array([[1, 0, 0], [0, 1, 0], [8, -1, 1]]),
        [0.91, 2.57, -1.28],
    )
)
@settings(max_examples=25)
def test_slender_cells_have_their_volume_too(case):
    """Their corners are far away, and images from as far again cut them off."""
    generators, skew, center = case
    back = np.rint(np.linalg.inv(skew)).astype(np.int64)
    A = signed_permutations([skew @ g @ back for g in generators])
    r = len(center)
    try:
        cell = dirichlet_cell(A, np.zeros((len(A), r)), np.array(center))
    except InputError:
        assume(False)  # the centre is fixed by a relation
    volume = ConvexHull(cell.vertices).volume
    assert volume == pytest.approx((2 * np.pi) ** r / len(A), rel=1e-8)
