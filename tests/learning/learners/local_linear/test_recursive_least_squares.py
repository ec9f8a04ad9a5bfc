"""Tests of joint least squares on the tied basis against a plain solution written out here."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.learners import planar_arm

GROUP = planar_arm.group()


def stable_samples(rng, count):
    """Configurations of the quarter where the planar arm holds itself, and their torques."""
    sums = np.stack([rng.uniform(-np.pi / 2, 0, count), rng.uniform(-np.pi, 0, count)], axis=1)
    q = np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)
    return q, planar_arm.torque(q)


def plain_features(y, prototypes, d, kappa, group):
    """Tied features of one configuration for joint 0: the definition, image by image."""
    metric = sum(A.T @ A for A in group.A_sat)
    isometry = np.linalg.cholesky(metric / np.linalg.det(metric) ** (1 / len(metric))).T
    features = np.zeros((len(prototypes), 1 + len(y)))
    total = 0.0
    for A, shift, signs in zip(group.A_sat, group.d_sat, group.Y, strict=True):
        for i, p in enumerate(prototypes):
            for turn in itertools.product(range(-3, 4), repeat=len(y)):
                x = isometry @ (A @ y + shift - p + 2 * np.pi * np.array(turn)) / d
                h = np.exp(-(x @ x) / kappa**2)
                total += h
                features[i] += signs[0] * h * np.array([1.0, *x])
    return features.ravel() / total


def test_equals_plain_ridge_regression_on_the_tied_features():
    """Prototypes chosen by distance, features summed by hand, ridge normal equations."""
    rng = np.random.default_rng(0)
    q, torque = stable_samples(rng, 25)
    weights = rng.uniform(0.2, 1.0, 25)
    learner = RecursiveLeastSquares(0.9, kernel_width=1.2, ridge=1e-3, group=GROUP, cutoff=6.5)
    learner.fit(q, torque, weights)
    prototypes = learner.prototypes_
    phi = np.array([plain_features(x, prototypes, 0.9, 1.2, GROUP) for x in q])
    weighted = phi.T * weights
    theta = np.linalg.solve(weighted @ phi + 1e-3 * np.eye(phi.shape[1]), weighted @ torque)
    queries = rng.uniform(-np.pi, np.pi, (10, 2))
    expected = np.array([plain_features(x, prototypes, 0.9, 1.2, GROUP) for x in queries]) @ theta
    assert np.abs(learner.predict(queries) - expected).max() < 1e-9


def test_one_prototype_per_orbit_and_every_sample_near_one():
    """No two orbits of prototypes are nearer than d, and no sample is farther than d from all."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (300, 2))
    learner = RecursiveLeastSquares(0.5, group=GROUP).fit(q, planar_arm.torque(q))
    metric = sum(A.T @ A for A in GROUP.A_sat)
    isometry = np.linalg.cholesky(metric / np.sqrt(np.linalg.det(metric))).T

    def orbit_distance(a, b):
        turns = 2 * np.pi * np.array(list(itertools.product((-1, 0, 1), repeat=2)))
        return min(
            np.linalg.norm(isometry @ ((A @ a + d - b + np.pi) % (2 * np.pi) - np.pi + step))
            for A, d in zip(GROUP.A_sat, GROUP.d_sat, strict=True)
            for step in turns
        )

    prototypes = learner.prototypes_
    for a, b in itertools.combinations(prototypes, 2):
        assert orbit_distance(a, b) >= 0.5
    for x in q[::10]:
        assert min(orbit_distance(x, p) for p in prototypes) < 0.5 + 1e-12


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_equivariance_holds_whatever_was_learned(seed):
    """Even from meaningless labels: the map has the symmetry exactly, and is 2 pi periodic."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (30, 2))
    learner = RecursiveLeastSquares(group=GROUP, ridge=1e-4).fit(q, rng.normal(size=(30, 2)))
    query = rng.uniform(-np.pi, np.pi, (4, 2))
    answer = learner.predict(query)
    scale = 1 + np.abs(answer).max()
    for A, d, Y in zip(GROUP.A_sat, GROUP.d_sat, GROUP.Y, strict=True):
        assert np.abs(learner.predict(query @ A.T + d) - Y * answer).max() < 1e-8 * scale
    turns = 2 * np.pi * rng.integers(-2, 3, query.shape)
    assert np.abs(learner.predict(query + turns) - answer).max() < 1e-8 * scale


def test_joints_with_different_signs():
    """The 3R arm: Y differs between joints; 400 samples of the cell give the whole torus."""
    gravity = GravityModel(load_robot("3r"))
    group = primary_symmetries(gravity.potential)
    rng = np.random.default_rng(2)
    q = rng.uniform(-np.pi, np.pi, (400, 3))
    learner = RecursiveLeastSquares(group=group).fit(q, gravity.torque(q))
    dense = rng.uniform(-np.pi, np.pi, (200, 3))
    assert np.sqrt(np.mean((learner.predict(dense) - gravity.torque(dense)) ** 2)) < 0.01
    answer = learner.predict(dense[:5])
    for relation in group:
        mapped = learner.predict(np.array([relation.configuration(x) for x in dense[:5]]))
        assert np.abs(mapped - relation.Y * answer).max() < 1e-5


def test_learns_the_planar_arm_from_eighty_samples():
    """From the stable quarter alone, judged on the whole torus."""
    rng = np.random.default_rng(3)
    learner = RecursiveLeastSquares(group=GROUP).fit(*stable_samples(rng, 80))
    dense = rng.uniform(-np.pi, np.pi, (1500, 2))
    assert np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)) < 0.0053


def test_works_without_a_group():
    """No symmetries: more prototypes and samples, same learner."""
    rng = np.random.default_rng(4)
    q = rng.uniform(-np.pi, np.pi, (700, 2))
    learner = RecursiveLeastSquares().fit(q, planar_arm.torque(q))
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    assert np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)) < 0.02


def test_pieces_and_a_stop_in_the_middle_change_nothing():
    """One by one with predictions in between, and saved and restored, as at once."""
    rng = np.random.default_rng(5)
    q, torque = stable_samples(rng, 90)
    dense = rng.uniform(-np.pi, np.pi, (100, 2))
    options = {"group": GROUP, "ridge": 1e-8}
    whole = RecursiveLeastSquares(**options).fit(q, torque)
    pieces = RecursiveLeastSquares(**options)
    for i in range(60):
        pieces.partial_fit(q[i : i + 1], torque[i : i + 1]).predict(dense[:1])
    saved = json.loads(json.dumps(pieces.parameters()))
    resumed = RecursiveLeastSquares.from_arrays(pieces.to_arrays(), saved)
    assert np.abs(resumed.predict(dense) - pieces.predict(dense)).max() < 1e-9
    resumed.partial_fit(q[60:], torque[60:])
    assert np.abs(resumed.predict(dense) - whole.predict(dense)).max() < 1e-6
    assert resumed.n_samples_seen_ == 90


def test_noise_is_averaged_out():
    """With noisy labels and a fitting ridge the error falls below the noise."""
    rng = np.random.default_rng(6)
    q, torque = stable_samples(rng, 1500)
    learner = RecursiveLeastSquares(group=GROUP, ridge=1e-5)
    learner.fit(q, torque + rng.normal(0, 0.05, torque.shape))
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    assert np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)) < 0.02


def test_survives_constant_targets_repeats_far_angles_and_full_memory():
    rng = np.random.default_rng(7)
    q = rng.uniform(-1e6, 1e6, (600, 2))
    learner = RecursiveLeastSquares(memory=50, group=GROUP, ridge=1e-6)
    learner.fit(q, planar_arm.torque(q))
    repeated = np.tile(q[:1], (500, 1))
    learner.partial_fit(repeated, planar_arm.torque(repeated))
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    assert np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)) < 0.05
    constant = RecursiveLeastSquares().fit(dense, np.full((500, 2), 3.0))
    assert np.abs(constant.predict(dense) - 3.0).max() < 1e-4


def test_a_query_out_of_reach_of_all_kernels_is_answered():
    learner = RecursiveLeastSquares(0.05).fit([[0.0, 0.0], [0.1, 0.0]], [[1.0, 2.0], [1.0, 2.0]])
    assert np.isfinite(learner.predict([[3.0, 3.0]])).all()


@pytest.mark.parametrize("bad", [np.nan, -np.inf])
def test_refuses_what_is_no_number_and_stays_as_it_was(bad):
    learner = RecursiveLeastSquares().fit([[0.0, 0.0]], [[1.0, 2.0]])
    with pytest.raises(InputError, match="finite"):
        learner.partial_fit([[0.1, bad]], [[1.0, 2.0]])
    assert learner.n_samples_seen_ == 1


@pytest.mark.parametrize(
    "options", [{"radius": -1.0}, {"ridge": 0.0}, {"memory": 0}, {"cutoff": 0.1}]
)
def test_refuses_unusable_settings(options):
    with pytest.raises(InputError, match=next(iter(options))):
        RecursiveLeastSquares(**options).fit([[0.0, 0.0]], [[1.0, 2.0]])
