from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.static_torques import incremental_kd_tree as growing_points
from isotorque.learning.static_torques.incremental_kd_tree import SCANNED, GrowingPoints
from isotorque.symbolic.common.errors import InputError


@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 3),
    st.integers(1, 300),
    st.floats(0, 0.9),
    st.sampled_from([0, 300, SCANNED]),  # a tree, first a scan and then a tree, a scan
)
def test_nearest_is_what_brute_force_finds(seed, dimension, count, removals, scanned):
    with patch.object(growing_points, "SCANNED", scanned):
        check_nearest(seed, dimension, count, removals)


def check_nearest(seed, dimension, count, removals):
    rng = np.random.default_rng(seed)
    points, alive = GrowingPoints(dimension), {}
    for step in range(count):
        point = rng.integers(-20, 20, dimension) / 4.0
        alive[points.append(point)] = point
        if rng.random() < removals:
            gone = rng.choice(list(alive))
            points.remove(int(gone))
            del alive[int(gone)]
        if step % 29 == 0 or step == count - 1:
            queries = rng.normal(size=(5, dimension)) * 4.0
            distance, index = points.nearest(queries)
            if not alive:
                assert np.isinf(distance).all()
                assert (index == -1).all()
                continue
            present = np.array(list(alive.values()))
            brute = np.linalg.norm(queries[:, None] - present[None], axis=2).min(axis=1)
            np.testing.assert_allclose(distance, brute, atol=1e-12)
            for query, i, d in zip(queries, index, distance, strict=True):
                assert np.isclose(np.linalg.norm(alive[int(i)] - query), d)
    assert len(points) == len(alive)
    assert points.indices.tolist() == sorted(alive)


def test_tree_is_rebuilt_only_when_it_has_grown(monkeypatch):
    monkeypatch.setattr(growing_points, "SCANNED", 0)
    built = []
    original = GrowingPoints._build_tree
    monkeypatch.setattr(
        GrowingPoints, "_build_tree", lambda self: (built.append(len(self)), original(self))
    )
    points = GrowingPoints(2)
    rng = np.random.default_rng(0)
    for _ in range(4000):
        points.append(rng.normal(size=2))
        points.nearest(np.zeros((1, 2)))
    # at most once per 33 additions, and per growth by an eighth
    assert len(built) <= 60
    assert sum(built) <= 12 * 4000


@given(st.integers(0, 2**32 - 1), st.integers(1, 7))
def test_scan_and_tree_give_the_same_distances_bit_for_bit(seed, dimension):
    rng = np.random.default_rng(seed)
    points = GrowingPoints(dimension)
    for point in rng.normal(size=(200, dimension)):
        points.append(point)
    queries = rng.normal(size=(9, dimension))
    scanned = points.nearest(queries)
    with patch.object(growing_points, "SCANNED", 0):
        searched = points.nearest(queries)
    assert len(points) * queries.size <= SCANNED
    assert np.array_equal(scanned[1], searched[1])
    if dimension <= 3:  # beyond, sums may be added up in another order
        assert np.array_equal(scanned[0], searched[0])
    else:
        np.testing.assert_allclose(scanned[0], searched[0], rtol=1e-14)


def test_queries_of_another_dimension_are_refused():
    with pytest.raises(InputError, match="shape of queries"):
        GrowingPoints(2).nearest(np.zeros((1, 3)))
