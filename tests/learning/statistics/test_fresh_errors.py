"""Errors at fresh poses: chances are as stated, and what noise hides counts as not tested."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from isotorque.learning.statistics.fresh_errors import (
    LEAST_POSES,
    RESOLVED,
    errors_by_pose,
    fresh_errors,
    scatter_within_poses,
    unknown_noise,
)
from isotorque.learning.statistics.poses import Poses

TRIALS = 300


def recordings(rng, wrong, noise, poses, freedom):
    """Errors of poses of a model that errs by so much (RMS), with noise, known or estimated."""
    for _ in range(TRIALS):
        own = rng.normal(size=(poses, 1))
        own *= wrong / np.sqrt(np.mean(own**2))
        known = 1.0 if np.isinf(freedom) else np.sqrt(rng.chisquare(freedom) / freedom)
        yield own + noise * rng.normal(size=(poses, 1)), np.full((poses, 1), noise * known)


@settings(max_examples=12)
@given(
    st.integers(0, 99),
    st.floats(0.01, 2.0),
    st.integers(LEAST_POSES, 60),
    st.sampled_from([3.0, 10.0, 60.0, np.inf]),
)
def test_errors_of_the_tolerance_are_refuted_as_rarely_as_stated(seed, noise, poses, freedom):
    rng, refuted, missed = np.random.default_rng(seed), 0, 0
    for errors, deviation in recordings(rng, 1.0, noise, poses, freedom):
        found = fresh_errors(errors, deviation, freedom, np.ones(1), chance=0.1)
        refuted += bool(found.refuted[0])
        # no pose errs by more than the tolerance
        single = fresh_errors(
            rng.normal(size=(poses, 1)) * noise, deviation, freedom, np.zeros(1), chance=0.1
        )
        missed += bool(single.missed.any())
    # half of a tenth each, and four standard deviations of so many trials
    assert refuted <= TRIALS * 0.05 + 4.0 * np.sqrt(TRIALS * 0.05)
    assert missed <= TRIALS * 0.05 + 4.0 * np.sqrt(TRIALS * 0.05)


@settings(max_examples=12)
@given(
    st.integers(0, 99),
    st.floats(0.01, 5.0),
    st.integers(LEAST_POSES, 60),
    st.sampled_from([2.0, 5.0, 20.0, 100.0, np.inf]),
)
def test_errors_of_three_times_the_tolerance_never_pass_for_tested(seed, noise, poses, freedom):
    passed = 0
    rng = np.random.default_rng(seed)
    for errors, deviation in recordings(rng, RESOLVED, noise, poses, freedom):
        found = fresh_errors(errors, deviation, freedom, np.ones(1))
        passed += bool(not found.refuted[0] and found.resolved[0])
    assert passed <= TRIALS * 0.01 + 4.0 * np.sqrt(TRIALS * 0.01)


@settings(max_examples=12)
@given(st.integers(0, 99), st.floats(0.05, 1.0), st.integers(8, 60), st.floats(0.0, 2.0))
def test_what_noise_does_not_explain_is_at_most_what_is_said(seed, noise, poses, wrong):
    rng = np.random.default_rng(seed)
    said = [
        fresh_errors(errors, deviation, np.inf, np.ones(1)).unexplained[0]
        for errors, deviation in recordings(rng, wrong, noise, poses, np.inf)
    ]
    assert np.mean(np.array(said) >= wrong) >= 0.95 - 4.0 * np.sqrt(0.05 / TRIALS)
    assert np.median(said) <= wrong + 2.0 * noise  # and not far above it


def test_limits_of_the_rmse_hold_over_poses_drawn_alike():
    rng = np.random.default_rng(0)
    held = 0
    for _ in range(TRIALS):
        found = fresh_errors(rng.normal(size=(10, 1)), np.zeros((10, 1)), np.inf, np.ones(1))
        low, high = found.rmse_limits
        held += bool(low[0] <= 1.0 <= high[0])
    assert abs(held / TRIALS - 0.95) < 0.05


@given(st.floats(1e-9, 1e9))
def test_nothing_depends_on_units(scale):
    rng = np.random.default_rng(3)
    errors, deviation = rng.normal(size=(12, 2)), np.full((12, 2), 0.3)
    one = fresh_errors(errors, deviation, 20.0, np.array([0.9, 2.0]))
    other = fresh_errors(scale * errors, scale * deviation, 20.0, scale * np.array([0.9, 2.0]))
    for name in ("allowed", "noticeable", "allowed_at_poses", "unexplained", "rmse"):
        np.testing.assert_allclose(getattr(other, name), scale * getattr(one, name), rtol=1e-6)


def test_without_noise_the_tolerance_alone_is_allowed():
    errors = np.full((6, 1), 0.5)
    nothing = np.zeros((6, 1))
    for tolerance, fine in ((0.5001, True), (0.4999, False)):
        found = fresh_errors(errors, nothing, np.inf, np.array([tolerance]))
        assert found.refuted[0] != fine
        assert found.missed.any() != fine
        assert found.resolved[0]
    exact = fresh_errors(errors, nothing, np.inf, np.zeros(1))
    assert exact.refuted[0]
    assert exact.unexplained[0] == pytest.approx(0.5)


def test_rows_of_one_pose_count_as_one():
    rng = np.random.default_rng(1)
    poses = Poses(np.repeat(np.arange(20), 9), 20)
    errors = np.repeat(rng.normal(size=(20, 2)), 9, axis=0)
    noise = 0.3 * rng.normal(size=(180, 2))
    known = scatter_within_poses(errors + noise, poses)
    assert known is not None
    assert known.freedom == 160
    found = errors_by_pose(errors + noise, poses, known, np.ones(2))
    assert found.poses == 20
    np.testing.assert_allclose(found.noise, 0.1, rtol=0.2)
    assert scatter_within_poses(errors[:20], Poses(np.arange(20), 20)) is None
    silent = errors_by_pose(errors, poses, unknown_noise(errors), np.ones(2))
    assert not silent.noise.any()


def test_poses_of_fewer_rows_count_as_noisier():
    rng, refuted = np.random.default_rng(5), 0
    label = np.repeat(np.arange(12), [1] * 6 + [30] * 6)
    poses = Poses(label, 12)
    for _ in range(TRIALS):
        errors = rng.normal(size=(len(label), 1))
        known = scatter_within_poses(errors, poses)
        assert known is not None
        found = errors_by_pose(errors, poses, known, np.full(1, 1e-6), chance=0.1)
        refuted += bool(found.refuted[0])
    assert refuted <= TRIALS * 0.05 + 4.0 * np.sqrt(TRIALS * 0.05)


@pytest.mark.parametrize("freedom", [3.0, 10.0, 60.0])
def test_what_counts_as_noticeable_is_so_though_noise_was_estimated_too_large(freedom):
    poses = 10
    found = fresh_errors(np.zeros((poses, 1)), np.full((poses, 1), 0.5), freedom, np.ones(1))
    least = 0.25 * freedom / stats.chi2.isf(0.005, freedom)  # variance, but once in 200
    missed = stats.ncx2.cdf(
        poses * found.allowed[0] ** 2 / least, poses, poses * found.noticeable[0] ** 2 / least
    )
    assert missed == pytest.approx(0.005, rel=1e-3)
