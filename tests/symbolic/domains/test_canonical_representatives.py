"""Folding into Dirichlet cells: boundaries, relations that fit together only nearly, misuse."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.canonical_representatives import CanonicalMap
from isotorque.symbolic.domains.dirichlet_cell import dirichlet_cell
from isotorque.symbolic.domains.generic_center import generic_center
from isotorque.symbolic.groups.torus_action import torus_action
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import planar, potentials, three_r, two_r


def canonical_map(group, jitter=None):
    """Return the torus action, the cell and the canonical of a group (offsets optionally moved)."""
    d = group.d_sat if jitter is None else group.d_sat + jitter
    action = torus_action(group.A_sat, d)
    cell = dirichlet_cell(action.A, action.d, generic_center(action.A, action.d))
    return action, cell, CanonicalMap(cell, action)


def images_of(action, w):
    """Return the images of points w (m, r) under all maps, shape (g, m, r)."""
    return np.einsum("gij,mj->gmi", action.A, w) + action.d[:, None]


def boundary_points(cell, rng, m):
    """Return m random points on corners, edges, ... and facets of a cell."""
    points = []
    for row in cell.halfspaces[rng.integers(len(cell.halfspaces), size=m)]:
        face = cell.vertices[cell.vertices @ row[:-1] > row[-1] - 1e-9]
        corners = face[rng.choice(len(face), rng.integers(1, len(face) + 1), replace=False)]
        points.append(rng.dirichlet(np.ones(len(corners))) @ corners)
    return np.array(points)


@settings(max_examples=60)
@given(potentials(), st.integers(0, 2**32 - 1))
def test_boundary_points_have_one_representative_which_is_its_own(potential, seed):
    group = primary_symmetries(potential)
    if group.rank == 0:
        return
    action, cell, canonical = canonical_map(group)
    w = boundary_points(cell, np.random.default_rng(seed), 12)
    found = canonical.representatives(w)
    assert found.closed.all()
    again = canonical.representatives(found.points)
    np.testing.assert_array_equal(again.points, found.points)
    for image in images_of(action, w):
        np.testing.assert_allclose(canonical.representatives(image).points, found.points, atol=3e-7)


@pytest.mark.parametrize("potential", [two_r(), three_r(), planar([3.0, 2.0, 1.0])])
def test_grids_through_fixed_points_have_one_representative_per_orbit(potential):
    """Multiples of pi/4 lie on corners, edges and mirrors of all these cells."""
    group = primary_symmetries(potential)
    action, _, canonical = canonical_map(group)
    steps = np.arange(-4, 4) * np.pi / 4
    grid = np.stack(np.meshgrid(*[steps] * group.rank), axis=-1).reshape(-1, group.rank)
    found = canonical.representatives(grid)
    for image in images_of(action, grid):
        np.testing.assert_allclose(canonical.representatives(image).points, found.points, atol=1e-9)
    # as many representatives as orbits, counted by plain comparison of sorted images
    orbit = np.mod(np.rint(images_of(action, grid) * 4 / np.pi), 8).astype(int)
    orbits = {tuple(sorted(map(tuple, orbit[:, i]))) for i in range(len(grid))}
    assert len(np.unique(np.rint(found.points * 4 / np.pi), axis=0)) == len(orbits)


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_learned_offsets_that_fit_only_nearly_still_lead_into_the_cell(seed):
    rng = np.random.default_rng(seed)
    group = primary_symmetries(three_r())
    jitter = rng.uniform(-1e-3, 1e-3, group.d_sat.shape)
    jitter[0] = 0
    action, cell, canonical = canonical_map(group, jitter)
    w = np.concatenate([rng.uniform(-7, 7, (50, 3)), boundary_points(cell, rng, 10)])
    found = canonical.representatives(w)
    reached = np.einsum("mij,mj->mi", action.A[found.element], w) + action.d[found.element]
    np.testing.assert_allclose(found.points, reached + 2 * np.pi * found.turns, atol=1e-12)
    rows = cell.halfspaces
    assert (found.points @ rows[:, :-1].T - rows[:, -1]).max() < 1e-2


def test_relations_that_are_not_closed_are_refused():
    group = primary_symmetries(two_r())
    three = torus_action(group.A_sat[:3], group.d_sat[:3])
    cell = dirichlet_cell(three.A, three.d, np.array([0.5, 0.9]))
    with pytest.raises(InputError, match="closed under composition"):
        CanonicalMap(cell, three)
