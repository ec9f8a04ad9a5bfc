"""Coordinates in which relations are integer maps of a torus."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.torus_action import torus_action
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.domains.test_fundamental_domain import FRACTIONAL
from tests.symbolic.gravity.small_potentials import potentials

TURN = 2 * np.pi


@given(st.one_of(potentials(max_joints=3), st.just(FRACTIONAL)), st.integers(0, 2**32 - 1))
def test_maps_of_the_torus_are_the_relations(potential, seed):
    group = primary_symmetries(potential)
    action = torus_action(group.A_sat, group.d_sat)
    np.testing.assert_array_equal(action.A, np.round(action.A))
    assert sorted(action.members.ravel()) == list(range(group.order))
    rng = np.random.default_rng(seed)
    element = rng.integers(len(action.A), size=10)
    turns = rng.integers(-3, 4, (10, group.rank))
    w = rng.uniform(-3, 3, (10, group.rank))
    image = np.einsum("mij,mj->mi", action.A[element], w) + action.d[element] + TURN * turns
    relation, whole = action.relations(group.d_sat, element, turns)
    y = w @ action.scale.T
    expected = np.einsum("mij,mj->mi", group.A_sat[relation], y) + group.d_sat[relation]
    np.testing.assert_allclose(image @ action.scale.T, expected + TURN * whole, atol=1e-9)


def test_fractional_matrices_need_coarser_coordinates():
    group = primary_symmetries(FRACTIONAL)
    action = torus_action(group.A_sat, group.d_sat)
    assert not action.is_plain
    assert len(action.A) * action.members.shape[1] == group.order
    assert abs(np.linalg.det(action.scale)) == pytest.approx(1 / action.members.shape[1])


def test_matrices_of_no_group_are_refused():
    A = np.array([np.eye(2), [[0.5, 0.0], [0.0, 1.0]]])
    with pytest.raises(InputError, match="form a group"):
        torus_action(A, np.zeros((2, 2)))
