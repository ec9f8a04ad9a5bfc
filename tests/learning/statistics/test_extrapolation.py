"""Batch learners on data from a narrow box: right inside, never silently wild outside."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.registry import BATCH_LEARNERS, LearningTask, learner_by_name
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.learning.statistics.extrapolation import WILD, Extrapolation, extrapolation
from isotorque.learning.statistics.shrinkage import shrunk_least_squares
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

SILENT = 1.5 * WILD
"""Times the largest torque seen that no answer exceeds without a word."""


def narrow(name, rng, rows, width, noise):
    """Samples of a box, their noise level, and fresh exact ones of the same box."""
    gravity = GravityModel(load_robot(name))
    n = gravity.potential.n
    center = rng.uniform(-np.pi, np.pi, n)
    q, fresh = center + rng.uniform(-width, width, (2, rows, n))
    torque = gravity.torque(q)
    level = noise * np.abs(torque).max()
    return q, torque + level * rng.normal(size=q.shape), level, fresh, gravity.torque(fresh)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["pendulum", "2r", "3r"]),
    st.sampled_from(sorted({"trigonometric", "gaussian-process", "parametric"})),
    st.floats(0.03, 0.5),
    st.sampled_from([0.0, 1e-3, 0.02]),
)
@settings(max_examples=8)
def test_no_learner_is_wild_without_a_word_and_all_are_right_inside(seed, name, how, width, noise):
    rng = np.random.default_rng(seed)
    q, torque, level, fresh, truth = narrow(name, rng, 40, width, noise)
    n = q.shape[1]
    learner = learner_by_name(how, None, LearningTask(n, len(q), True, name)).fit(q, torque)
    limits = np.tile([-np.pi, np.pi], (n, 1))
    found = extrapolation(learner, q, torque, limits)
    answers = learner.predict(rng.uniform(-np.pi, np.pi, (500, n)))
    if np.abs(answers).max() > SILENT * found.seen:
        assert found.wild
        assert "not to be trusted" in found.remark
    if (found.high - found.low).max() < np.pi:
        assert "no data in" in found.remark
    inside = np.sqrt(np.mean((learner.predict(fresh) - truth) ** 2))
    assert inside < 2.0 * level + 0.01 * np.abs(torque).max()


@pytest.mark.slow
@pytest.mark.parametrize("how", sorted(BATCH_LEARNERS))
def test_every_batch_learner_says_where_it_knows_nothing(how):
    rng = np.random.default_rng(5)
    q, torque, *_ = narrow("2r", rng, 80, 0.3, 0.01)
    learner = learner_by_name(how, None, LearningTask(2, 80, True, "2r")).fit(q, torque)
    found = extrapolation(learner, q, torque, np.tile([-np.pi, np.pi], (2, 1)))
    answers = learner.predict(rng.uniform(-np.pi, np.pi, (2000, 2)))
    assert found.wild or np.abs(answers).max() <= SILENT * found.seen
    assert "no data in" in found.remark


def test_a_wave_fit_of_a_narrow_box_stays_of_the_size_of_the_torques():
    # plain least squares answers 700,000 times the largest torque here
    rng = np.random.default_rng(1)
    q, torque, *_ = narrow("3r", rng, 100, 0.05, 0.01)
    wild = EquivariantTrigonometric(ridge=1e-20).fit(q, torque)
    kept = EquivariantTrigonometric().fit(q, torque)
    anywhere = rng.uniform(-np.pi, np.pi, (500, 3))
    assert np.abs(wild.predict(anywhere)).max() > 1e3 * np.abs(torque).max()
    assert np.abs(kept.predict(anywhere)).max() < 10.0 * np.abs(torque).max()


@pytest.mark.parametrize("learner", [EquivariantTrigonometric(), StaticRegressor("2r")])
def test_standard_errors_are_those_of_repeated_fits(learner):
    gravity = GravityModel(load_robot("2r"))
    rng = np.random.default_rng(2)
    q = rng.uniform(-np.pi, np.pi, (40, 2))
    fresh = rng.uniform(-np.pi, np.pi, (50, 2))
    errors, stated = [], []
    for _ in range(60):
        learner.fit(q, gravity.torque(q) + 0.1 * rng.normal(size=q.shape))
        errors.append(learner.predict(fresh) - gravity.torque(fresh))
        stated.append(learner.standard_error(fresh))
    ratio = np.mean(stated, axis=0) / np.std(errors, axis=0)
    assert 0.8 < np.median(ratio) < 1.2


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(0, 20))
@settings(max_examples=20)
def test_exact_samples_are_not_shrunk(seed, unknowns, more):
    rng = np.random.default_rng(seed)
    features = rng.normal(size=(unknowns + more, unknowns))
    truth = rng.normal(size=unknowns)
    targets = features @ truth
    solution, _ = shrunk_least_squares(features, targets, 1e-3)
    plain = np.linalg.lstsq(features, targets, rcond=None)[0]
    np.testing.assert_allclose(solution, plain, rtol=1e-6, atol=1e-9)


def test_a_process_does_not_explain_each_sample_by_itself():
    # one joint is all noise: a length scale below the distance of the samples would fit it
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (60, 2))
    torque = np.stack([8.0 * np.cos(q[:, 0]), 5.0 + rng.normal(size=60)], axis=1)
    process = SymmetricGaussianProcess(None).fit(q, torque)
    for joint in range(2):
        assert process.covariance_sum(joint)[1] >= 0.2
    fresh = rng.uniform(-np.pi, np.pi, (200, 2))
    assert np.abs(process.predict(fresh)[:, 1] - 5.0).max() < 1.5


def test_data_that_cover_the_joints_need_no_remark():
    gravity = GravityModel(load_robot("2r"))
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (100, 2))
    learner = EquivariantTrigonometric().fit(q, gravity.torque(q))
    found = extrapolation(learner, q, gravity.torque(q), np.tile([-np.pi, np.pi], (2, 1)))
    assert found.remark is None
    assert not found.wild
    assert found.document()["trusted"]


@given(st.floats(0.1, 50.0), st.floats(0.1, 5000.0) | st.just(np.inf) | st.just(np.nan))
def test_answers_beyond_twice_the_largest_torque_are_wild_and_said(seen, predicted):
    low, high, where = np.array([-3.0]), np.array([3.0]), np.zeros(1)
    found = Extrapolation(low, high, 0.0, seen, predicted, where, np.nan)
    assert found.wild == (not predicted <= 2.0 * seen)
    assert found.document()["trusted"] != found.wild
    assert ("not to be trusted" in (found.remark or "")) == found.wild
