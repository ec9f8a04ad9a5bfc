import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from learning.static_torques.growing_points import GrowingPoints
from symbolic.errors import InputError


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 300), st.floats(0, 0.9))
def test_nearest_is_what_brute_force_finds(seed, dimension, count, removals):
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


def test_queries_of_another_dimension_are_refused():
    with pytest.raises(InputError, match="shape of queries"):
        GrowingPoints(2).nearest(np.zeros((1, 3)))
