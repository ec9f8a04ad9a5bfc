import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.static_torques.alpha_shape import AlphaShape
from isotorque.symbolic.common.errors import InputError


def cloud(rng, count, dimension):
    return rng.uniform(-1.0, 1.0, (count, dimension))


@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_covers_nothing_beyond_the_box_and_its_own_simplices_wholly(seed, dimension):
    rng = np.random.default_rng(seed)
    shape = AlphaShape(cloud(rng, 60, dimension))
    outside = rng.normal(size=(40, dimension))
    outside *= 2.0 * np.sqrt(dimension) / np.linalg.norm(outside, axis=1, keepdims=True)
    assert not shape.contains(outside).any()
    weights = rng.dirichlet(np.ones(dimension + 1), len(shape.simplices))
    inside = np.einsum("sc,scd->sd", weights, shape.points[shape.simplices])
    assert shape.contains(inside).all()


@given(st.integers(0, 2**32 - 1), st.integers(2, 3))
def test_no_kept_edge_is_longer_than_the_limit(seed, dimension):
    shape = AlphaShape(cloud(np.random.default_rng(seed), 50, dimension), edge_factor=1.5)
    corners = shape.points[shape.simplices]
    edges = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3)
    assert edges.max(initial=0.0) <= shape.edge_limit + 1e-12


def test_volume_is_that_of_the_covered_region():
    rng = np.random.default_rng(3)
    shape = AlphaShape(cloud(rng, 1500, 2))
    share = shape.contains(rng.uniform(-1.0, 1.0, (20000, 2))).mean()
    assert abs(shape.volume - 4.0 * share) < 0.04
    assert 3.6 < shape.volume < 4.0


def test_a_gap_on_a_line_is_not_covered():
    points = np.concatenate([np.linspace(0, 1, 20), np.linspace(2, 3, 20)])[:, None]
    found = AlphaShape(points).contains(np.array([[0.0], [0.51], [1.5], [2.99], [3.0], [3.01]]))
    assert found.tolist() == [True, True, False, True, True, False]


def test_points_on_a_line_cover_no_area():
    shape = AlphaShape(np.linspace([0, 0], [1, 1], 9))
    assert shape.is_empty
    assert shape.volume == 0.0
    assert not shape.contains(np.array([[0.5, 0.5]])).any()


def test_four_dimensions_are_refused():
    with pytest.raises(InputError, match="dimension"):
        AlphaShape(np.zeros((9, 4)))
