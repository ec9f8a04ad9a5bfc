"""Tests of symmetric copies, invariant distance and the wrapper for any regressor."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.neighbors import KNeighborsRegressor

from isotorque.learning.learners.augmented_samples import SymmetricSamples
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.symmetry_coordinates import SavedGroup, SymmetryCoordinates
from isotorque.symbolic.common.errors import InputError
from tests.learning.learners import planar_arm

GROUP = planar_arm.group()


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_copies_are_samples_and_distances_stay(seed):
    """Every copy satisfies the torque map; every relation keeps the distance; det L = 1."""
    rng = np.random.default_rng(seed)
    coordinates = SymmetryCoordinates.of(GROUP, 2)
    q = rng.uniform(-np.pi, np.pi, (5, 2))
    copies, torques = coordinates.copies(q, planar_arm.torque(q))
    assert copies.shape == (8, 5, 2)
    assert np.abs(planar_arm.torque(copies.reshape(-1, 2)) - torques.reshape(-1, 2)).max() < 1e-12
    step = rng.normal(0, 0.05, 2)
    moved, _ = coordinates.copies(q + step, planar_arm.torque(q))
    distances = coordinates.distance(copies, moved)
    assert np.abs(distances - np.linalg.norm(coordinates.isometry @ step)).max() < 1e-12
    assert np.linalg.det(coordinates.isometry) == pytest.approx(1.0)


def test_saved_group_is_the_same_group():
    coordinates = SymmetryCoordinates.of(GROUP, 2)
    again = SymmetryCoordinates.of(SavedGroup.from_arrays(coordinates.to_arrays()), 2)
    for name in ("basis", "A_sat", "d_sat", "Y", "isometry"):
        assert np.array_equal(getattr(again, name), getattr(coordinates, name))


def test_any_regressor_profits_from_copies():
    """Nearest neighbours from a quarter of the torus know the whole of it."""
    rng = np.random.default_rng(0)
    sums = np.stack([rng.uniform(-np.pi / 2, 0, 2000), rng.uniform(-np.pi, 0, 2000)], axis=1)
    q = np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    errors = []
    for group in (GROUP, None):
        learner = SymmetricSamples(KNeighborsRegressor(4, weights="distance"), group)
        learner.fit(q, planar_arm.torque(q))
        errors.append(np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)))
    assert errors[0] < 0.5 < 5 < errors[1]


def test_partial_fit_expands_weights_too():
    """The wrapper around a plain local linear map equals feeding the copies by hand."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (40, 2))
    torque, weights = planar_arm.torque(q), rng.random(40)
    wrapper = SymmetricSamples(LocalLinearMap(0.3), GROUP).partial_fit(q, torque, weights)
    copies, torques = SymmetryCoordinates.of(GROUP, 2).copies(q, torque)
    plain = LocalLinearMap(0.3).partial_fit(
        copies.reshape(-1, 2), torques.reshape(-1, 2), np.tile(weights, 8)
    )
    assert np.array_equal(wrapper.predict(q), plain.predict(q))


def test_a_group_of_another_arm_is_refused():
    with pytest.raises(InputError, match="joints"):
        SymmetryCoordinates.of(GROUP, 3)
