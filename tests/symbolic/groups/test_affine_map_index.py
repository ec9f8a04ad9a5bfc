"""Finding relations by matrix and offset modulo full turns."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.angles import circular_distance
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.affine_map_index import RelationLookup
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import three_r, two_r


@given(st.sampled_from([two_r(), three_r()]), st.integers(0, 2**32 - 1))
def test_every_relation_is_found_whatever_its_turns(potential, seed):
    group = primary_symmetries(potential)
    rng = np.random.default_rng(seed)
    order = rng.permutation(group.order)
    d = group.d_sat[order] + 2 * np.pi * rng.integers(-3, 4, group.d_sat.shape)
    d += rng.uniform(-1e-3, 1e-3, d.shape)
    linear = group.A_sat.astype(np.int64)
    found = RelationLookup(linear, group.d_sat).find(linear[order], d)
    np.testing.assert_array_equal(found, order)


def test_others_are_refused():
    group = primary_symmetries(two_r())
    lookup = RelationLookup(group.A_sat.astype(np.int64), group.d_sat)
    for A, d in (([[1, 0], [0, 1]], [1.0, 0.0]), ([[0, 1], [1, 0]], [0.0, 0.0])):
        with pytest.raises(InputError, match="closed"):
            lookup.find(np.array([A]), np.array([d]))


def test_circular_distance():
    a = np.array([[np.pi - 0.1, 0.0]])
    assert circular_distance(a, np.array([-np.pi + 0.1, 0.05])) == pytest.approx(0.2)
