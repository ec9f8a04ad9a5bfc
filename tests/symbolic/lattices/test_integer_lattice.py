"""Integer lattices against brute force and determinants."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.lattices.integer_lattice import (
    dependency_components,
    generate_lattice,
    hermite_with_transform,
    saturation,
)

matrices = st.integers(1, 4).flatmap(
    lambda n: st.lists(
        st.lists(st.integers(-2, 2), min_size=n, max_size=n), min_size=1, max_size=5
    ).map(lambda rows: np.array(rows, dtype=np.int64))
)


@given(matrices)
def test_saturation_is_all_integer_points_of_the_span(K):
    B, V = saturation(K)
    rank = np.linalg.matrix_rank(K.astype(float))
    assert len(B) == rank
    assert abs(round(np.linalg.det(V.astype(float)))) == 1
    np.testing.assert_array_equal(V[:rank], B)
    inverse = np.linalg.inv(V.astype(float))
    for point in itertools.product(range(-2, 3), repeat=K.shape[1]):
        p = np.array(point)
        in_span = np.linalg.matrix_rank(np.vstack([K, p]).astype(float)) == rank
        coordinates = p @ inverse
        assert in_span == bool(np.all(np.abs(coordinates[rank:]) < 1e-9))


@given(matrices)
def test_hermite_transform_is_unimodular(K):
    H, T = hermite_with_transform(K)
    np.testing.assert_array_equal(T @ K, H)
    assert abs(round(np.linalg.det(T.astype(float)))) == 1


@given(matrices)
def test_a_few_rows_generate_the_same_lattice(K):
    B, V = saturation(K)
    C = np.round(K @ np.linalg.inv(V.astype(float))).astype(np.int64)[:, : len(B)]
    lattice = generate_lattice(C)
    np.testing.assert_array_equal(lattice.T @ C[list(lattice.rows)], lattice.H)
    np.testing.assert_array_equal(lattice.coordinates(C) @ lattice.H, C)
    minors = [
        round(abs(np.linalg.det(C[list(rows)].astype(float))))
        for rows in itertools.combinations(range(len(C)), len(B))
    ]
    assert lattice.index == np.gcd.reduce(minors) if len(B) else lattice.index == 1
    # cosets: as many as the index, pairwise different solutions of H d = 2 pi z modulo 2 pi
    cosets = lattice.cosets()
    assert len(cosets) == lattice.index
    if len(B):
        d = np.linalg.solve(lattice.H.astype(float), cosets.T).T % 1.0
        for x, y in itertools.combinations(d, 2):
            assert np.abs((x - y + 0.5) % 1.0 - 0.5).max() > 1e-9


def _circuits(K):
    for size in range(1, len(K) + 1):
        for rows in itertools.combinations(range(len(K)), size):
            part = K[list(rows)].astype(float)
            dependent = np.linalg.matrix_rank(part) < size
            minimal = all(
                size == 1 or np.linalg.matrix_rank(np.delete(part, i, 0)) == size - 1
                for i in range(size)
            )
            if dependent and minimal:
                yield rows


@given(matrices)
def test_components_are_joined_exactly_by_circuits(K):
    label = dependency_components(K)
    joined = np.eye(len(K), dtype=bool)
    for rows in _circuits(K):
        joined[np.ix_(rows, rows)] = True
    for _ in range(len(K)):
        joined = (joined.astype(int) @ joined.astype(int)) > 0
    np.testing.assert_array_equal(joined, label[:, None] == label[None])
