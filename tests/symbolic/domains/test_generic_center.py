"""Default centres: far from fixed points, simple where that costs little, always the same."""

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.domains.generic_center import generic_center
from isotorque.symbolic.groups.torus_action import torus_action
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import potentials, three_r, two_r


def separation(action, points):
    """Return how far points (m, r) are from their nearest image, by plain enumeration."""
    metric = np.einsum("gki,gkj->ij", action.A, action.A) / len(action.A)
    turns = 2 * np.pi * np.array(list(itertools.product([-1, 0, 1], repeat=points.shape[1])))
    away = np.einsum("gij,mj->gmi", action.A, points) + action.d[:, None] - points
    away = wrap(away)[:, :, None] + turns
    length = np.sqrt(np.einsum("gmti,ij,gmtj->gmt", away, metric, away)).min(axis=2)
    length[length.max(axis=1) < 1e-9] = np.inf  # the identity
    return length.min(axis=0)


@settings(max_examples=40)
@given(potentials(max_joints=3), st.integers(0, 2**32 - 1))
def test_few_points_are_much_further_from_their_images(potential, seed):
    group = primary_symmetries(potential)
    action = torus_action(group.A_sat, group.d_sat)
    if group.rank == 0 or len(action.A) == 1:
        return
    center = generic_center(action.A, action.d)
    own = separation(action, center[None])[0]
    others = separation(action, np.random.default_rng(seed).uniform(-4, 4, (50, group.rank)))
    assert own > 0.5 * others.max()
    np.testing.assert_array_equal(generic_center(action.A, action.d), center)


def test_simple_centres_of_the_papers_arms():
    for potential in (two_r(), three_r()):
        group = primary_symmetries(potential)
        center = generic_center(group.A_sat, group.d_sat)
        quarters = center * 4 / np.pi
        np.testing.assert_allclose(quarters, np.rint(quarters), atol=1e-12)


def test_no_dimensions():
    assert generic_center(np.zeros((1, 0, 0)), np.zeros((1, 0))).shape == (0,)
