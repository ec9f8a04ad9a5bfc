"""Lattice points and reduced bases, against plain enumeration."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.lattices.short_vectors import (
    covering_radius_bound,
    lattice_points_within,
    reduced_basis,
)


@st.composite
def grams(draw):
    r = draw(st.integers(1, 3))
    rows = draw(arrays(np.int64, (r, r), elements=st.integers(-2, 2)))
    return rows.T @ rows + np.eye(r, dtype=np.int64)


@given(grams(), st.data())
def test_points_are_those_of_plain_enumeration(gram, data):
    r = len(gram)
    offsets = data.draw(arrays(float, (2, r), elements=st.floats(-1.7, 1.7)))
    radius = data.draw(st.floats(0.3, 2.2))
    box = np.array(list(itertools.product(range(-5, 6), repeat=r)))  # gram >= 1: |z| <= 2.2 + 1.7
    expected = {
        (i, *z)
        for i, t in enumerate(offsets)
        for z, v in zip(box.tolist(), box + t, strict=True)
        if v @ gram @ v <= radius**2 * (1 - 1e-9)
    }
    index, points = lattice_points_within(gram.astype(float), reduced_basis(gram), offsets, radius)
    found = {(int(i), *map(int, z)) for i, z in zip(index, points, strict=True)}
    assert len(found) == len(points)
    assert expected <= found
    for i, *z in found - expected:  # on the sphere itself
        v = np.array(z) + offsets[i]
        assert v @ gram @ v == pytest.approx(radius**2)


@given(grams())
def test_reduced_basis_is_a_shorter_basis_of_the_same_lattice(gram):
    basis = reduced_basis(gram)
    assert round(abs(np.linalg.det(basis))) == 1
    reduced = basis @ gram @ basis.T
    assert np.sort(np.diag(reduced))[0] <= np.sort(np.diag(gram))[0]
    r = len(gram)
    lovasz = 2 ** (r * (r - 1) / 2) * np.linalg.det(gram)
    assert np.prod(np.diag(reduced)) <= lovasz * (1 + 1e-9)


@given(grams(), st.data())
def test_covering_radius_bound_covers(gram, data):
    basis = reduced_basis(gram)
    offset = data.draw(arrays(float, (1, len(gram)), elements=st.floats(-3, 3)))
    radius = covering_radius_bound(gram.astype(float), basis)
    index, _ = lattice_points_within(gram.astype(float), basis, offset, radius)
    assert len(index) >= 1


def test_no_dimensions_one_point():
    none = np.zeros((0, 0), dtype=np.int64)
    index, points = lattice_points_within(none.astype(float), none, np.zeros((2, 0)), 1.0)
    assert index.tolist() == [0, 1]
    assert points.shape == (2, 0)
    assert reduced_basis(none).shape == (0, 0)


def test_too_many_points_are_refused():
    with pytest.raises(InputError, match="number of images"):
        lattice_points_within(np.eye(3), np.eye(3, dtype=np.int64), np.zeros((1, 3)), 9.0, limit=99)
