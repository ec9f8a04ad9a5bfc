"""Coordinates of representatives for learners, with groups and with their arrays alone."""

from types import SimpleNamespace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.network.canonical_coordinates import (
    CanonicalCoordinates,
    symmetry_group,
)
from tests.learning.learners.random_groups import groups


@settings(max_examples=30)
@given(group=groups(), seed=st.integers(0, 2**32 - 1))
def test_one_representative_per_orbit_and_the_sign_between(group, seed):
    rng = np.random.default_rng(seed)
    canonical = CanonicalCoordinates(group)
    q = rng.uniform(-np.pi, np.pi, (4, group.n))
    y, signs, linear = canonical.of(q)
    for relation in group:
        moved_y, moved_signs, _ = canonical.of(relation.configuration(q))
        assert np.abs(moved_y - y).max() < 1e-9
        assert np.array_equal(moved_signs, relation.Y * signs)
    step = 1e-6 * rng.normal(size=q.shape)
    change = np.einsum("mij,mj->mi", linear, step @ group.basis.T)
    assert np.abs(canonical.of(q + step)[0] - y - change).max() < 1e-11


@settings(max_examples=40)
@given(group=groups())
def test_arrays_alone_give_the_same_group(group):
    arrays = SimpleNamespace(basis=group.basis, A_sat=group.A_sat, d_sat=group.d_sat, Y=group.Y)
    again = symmetry_group(arrays)
    assert again.order == group.order
    assert all(relation in again for relation in group)
    assert again.is_closed
