"""Tests of the search for rank-1 lattices against brute force."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.sampling.korobov import korobov_generator, korobov_points
from isotorque.symbolic.common.errors import InputError


def shortest_by_brute_force(z, count, sides):
    """Shortest difference of points, with the box repeated in all directions."""
    points = korobov_points(z, count)
    turns = np.array(list(itertools.product((-1, 0, 1), repeat=len(z))))
    away = (points[:, None] + turns[None]).reshape(-1, len(z)) * sides
    length = np.linalg.norm(away, axis=1)
    return length[length > 1e-12].min()


@given(
    count=st.integers(4, 60),
    sides=st.lists(st.floats(0.2, 5.0), min_size=2, max_size=3),
)
def test_no_multiplier_does_better(count, sides):
    sides = np.array(sides)
    found = shortest_by_brute_force(korobov_generator(count, sides), count, sides)
    for a in range(1, count):
        z = np.array([a**j % count for j in range(len(sides))])
        assert shortest_by_brute_force(z, count, sides) <= found + 1e-12


@given(count=st.integers(1, 500), z=st.lists(st.integers(0, 499), min_size=1, max_size=4))
def test_points_form_a_lattice(count, z):
    """Differences of points are points again, modulo 1."""
    points = korobov_points(z, count)
    assert points.shape == (count, len(z))
    i, j = count // 3, count // 2
    difference = (points[j] - points[i]) % 1.0
    away = np.abs(points - difference)
    assert np.minimum(away, 1 - away).max(axis=1).min() < 1e-9


def test_many_points_are_searched_in_bounded_time_and_spread_well():
    """Beyond the multipliers tried: still near the densest packing, sqrt(2 / sqrt 3)."""
    count, sides = 5003, np.ones(2)
    z = korobov_generator(count, sides)
    index = np.arange(1, count)[:, None] * z % count / count
    shortest = np.linalg.norm(index - np.rint(index), axis=1).min()
    assert shortest * np.sqrt(count) > 0.9


@pytest.mark.parametrize(("count", "sides"), [(0, [1.0]), (5, [1.0, 0.0]), (5, [np.nan]), (5, [])])
def test_refuses_what_is_no_box(count, sides):
    with pytest.raises(InputError, match="lattice"):
        korobov_generator(count, sides)
