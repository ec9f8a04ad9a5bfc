"""Models are judged by torques that were measured: what they do, not what a file says."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.files.saved_models import SavedModel
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.statistics.fresh_errors import LEAST_POSES, RESOLVED
from isotorque.symbolic.common.errors import InputError
from isotorque.verify.models.fresh_measurements import (
    ALIKE,
    FreshMeasurements,
    verify_on_measurements,
)
from isotorque.verify.verdict import Status

NAMES = ("shoulder", "elbow")
FILE = Path("fresh.csv")


def torque(q):
    lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    return np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)


def model(error=lambda q: 0.0, **notes):
    """A model that errs by a known function of the configuration."""
    learner = SimpleNamespace(predict=lambda q: torque(q) + error(q))
    return SavedModel(learner, "arm", "", NAMES, notes)


def recording(seed, poses=20, repeated=5, noise=0.05, constant=0.0, width=2.5):
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-width, width, (poses, 2)), repeated, axis=0)
    tau = torque(q) + noise * rng.normal(size=q.shape) + constant
    return FreshMeasurements.of(FILE, StaticSamples(q, tau), NAMES)


def wave(seed, size):
    """An error of a model whose RMS over all poses is about this, at both joints [N m]."""
    k = np.random.default_rng(seed).integers(1, 4, 2)
    return lambda q: np.sqrt(2.0) * size * np.sin(q * k + seed)


def statuses(judged):
    return [verdict.status for verdict in judged.verdicts]


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.floats(0.001, 0.15), st.integers(10, 40), st.integers(2, 6))
def test_a_right_model_passes_or_noise_hides_it(seed, noise, poses, repeated):
    judged = verify_on_measurements(model(), recording(seed, poses, repeated, noise), tolerance=0.1)
    rmse, largest = judged.verdicts
    assert rmse.status in (Status.TESTED, Status.UNTESTED)
    assert largest.status is Status.TESTED
    if noise / np.sqrt(repeated) < 0.04:  # RMS, beside a tolerance of 0.1
        assert rmse.status is Status.TESTED
    assert rmse.claim.startswith("the torque that was measured")


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.floats(0.001, 2.0), st.integers(5, 40), st.integers(1, 6))
def test_a_model_wrong_by_more_than_tolerance_and_noise_never_passes(seed, noise, poses, repeated):
    fresh = recording(seed, poses, repeated, noise)
    error = wave(seed, 1.0)
    size = np.sqrt(np.mean(error(fresh.q) ** 2, axis=0))
    tolerance = float(size.max()) / (1.05 * RESOLVED)
    judged = verify_on_measurements(model(error), fresh, tolerance=tolerance)
    assert statuses(judged)[0] is not Status.TESTED
    assert not all(verdict.passed for verdict in judged.verdicts)


@settings(max_examples=20)
@given(st.integers(0, 10_000), st.integers(1, 6))
def test_a_model_wrong_by_far_is_refuted_at_a_pose(seed, repeated):
    fresh = recording(seed, 20, repeated, 0.02)
    judged = verify_on_measurements(model(wave(seed, 3.0)), fresh, tolerance=0.05)
    assert statuses(judged) == [Status.REFUTED] * 2
    worst = judged.verdicts[1]
    at = np.flatnonzero((fresh.q == worst.counterexample).all(axis=1))
    assert len(at) == 1
    missed = fresh.tau[at[0]] - torque(fresh.q[at]) - wave(seed, 3.0)(fresh.q[at])
    assert np.abs(missed).max() == pytest.approx(worst.worst_error, rel=0.05)


def test_a_single_wrong_pose_is_found_though_the_rmse_is_small():
    fresh = recording(0, poses=40, noise=0.01)
    fresh.samples.tau[fresh.poses.label == 7] += [0.0, 0.6]
    judged = verify_on_measurements(model(), fresh, tolerance=0.2)
    assert statuses(judged) == [Status.TESTED, Status.REFUTED]
    assert "row 36, elbow, measured less predicted +0." in judged.verdicts[1].reason


def test_noise_that_hides_errors_is_no_pass():
    judged = verify_on_measurements(model(), recording(1, noise=2.0), tolerance=0.05)
    verdict = judged.verdicts[0]
    assert verdict.status is Status.UNTESTED
    assert not verdict.passed
    assert "could pass for noise" in verdict.reason


def test_poses_all_alike_are_no_pass():
    q = np.random.default_rng(0).uniform(0.0, 0.9 * ALIKE, (8, 2))
    fresh = FreshMeasurements.of(FILE, StaticSamples(q, torque(q)), NAMES)
    verdict = verify_on_measurements(model(), fresh).verdicts[0]
    assert verdict.status is Status.UNTESTED
    assert "nothing is known of other poses" in verdict.reason
    q[:, 1] *= 20.0
    fresh = FreshMeasurements.of(FILE, StaticSamples(q, torque(q)), NAMES)
    judged = verify_on_measurements(model(), fresh)
    assert judged.verdicts[0].status is Status.TESTED
    assert any("nothing is said of other angles: shoulder" in said for said in judged.remarks)


def test_noise_that_nobody_knows_counts_as_error_until_it_is_stated():
    fresh = recording(3, poses=30, repeated=1, noise=0.1)
    alone = verify_on_measurements(model(), fresh, tolerance=0.08)
    assert statuses(alone)[0] is Status.REFUTED
    assert "noise is not known" in alone.verdicts[0].reason
    assert alone.document["noise_known_by"] is None
    stated = verify_on_measurements(
        model(), fresh, tolerance=0.08, noise=MeasurementNoise(0.0, 0.1)
    )
    assert statuses(stated) == [Status.TESTED] * 2


def test_noise_of_angles_acts_through_the_slopes():
    rng = np.random.default_rng(4)
    q = rng.uniform(-2.5, 2.5, (30, 2))
    seen = q + 0.01 * rng.normal(size=q.shape)
    fresh = FreshMeasurements.of(FILE, StaticSamples(seen, torque(q)), NAMES)
    stated = verify_on_measurements(
        model(), fresh, tolerance=0.15, noise=MeasurementNoise(0.01, 0.0)
    )
    assert statuses(stated) == [Status.TESTED] * 2
    joints = stated.document["joints"]
    slopes = [20.0, 6.1]  # about: RMS of the slopes times 0.01 is the noise
    for joint, slope in zip(joints, slopes, strict=True):
        assert 0.002 * slope < joint["noise"] < 0.02 * slope


@pytest.mark.parametrize("repeated", [1, 4])
def test_a_chain_states_its_noise_and_its_range(repeated):
    learned = recording(5, poses=25, repeated=1, noise=0.05, width=1.0)
    chain = RigidChain().fit(learned.q, learned.tau)
    saved = SavedModel(chain, "arm", "", NAMES, {})
    fresh = recording(6, poses=30, repeated=repeated, noise=0.05, width=2.0)
    judged = verify_on_measurements(saved, fresh, tolerance=0.2)
    assert statuses(judged) == [Status.TESTED] * 2
    known = judged.document["noise_known_by"]
    assert ("stated by the model" in known) == (repeated == 1)
    outside = (np.abs(fresh.q) > 1.1).any(axis=1).sum()
    assert abs(judged.document["poses_outside_the_data"] - outside) <= 3
    assert any("outside the range of the model's own data" in said for said in judged.remarks)
    assert any("standard error" in said or "noise alone" in said for said in judged.remarks)


def test_the_range_that_a_saved_model_notes_counts():
    notes = {"extrapolation": {"seen_from": [-1.0, -1.0], "seen_to": [1.0, 1.0]}}
    fresh = recording(7)
    judged = verify_on_measurements(model(**notes), fresh)
    outside = int((np.abs(fresh.q) > 1.1).any(axis=1).sum())
    assert judged.document["poses_outside_the_data"] == outside
    assert verify_on_measurements(model(), fresh).document["poses_outside_the_data"] is None


def test_constants_degrees_and_signs_are_named():
    constant = verify_on_measurements(model(), recording(8, constant=[0.0, 0.7]), tolerance=0.1)
    assert statuses(constant)[0] is Status.REFUTED
    assert any("a constant torque of +0.69" in said for said in constant.remarks)
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (20, 2))
    turned = FreshMeasurements.of(FILE, StaticSamples(np.rad2deg(q), torque(q)), NAMES)
    opposite = FreshMeasurements.of(FILE, StaticSamples(q, -torque(q)), NAMES)
    for fresh, words in ((turned, "q is in radians"), (opposite, "the opposite sign")):
        judged = verify_on_measurements(model(), fresh)
        assert statuses(judged)[0] is Status.REFUTED
        assert any(words in said for said in judged.remarks)


@given(st.floats(1e-6, 1e6))
@settings(max_examples=20)
def test_the_default_tolerance_is_a_share_of_what_was_measured(scale):
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (30, 2))
    tau = scale * torque(q) * [1.0, 1e-6]
    fresh = FreshMeasurements.of(FILE, StaticSamples(q, tau), NAMES)
    largest = np.abs(tau[:, 0]).max()
    np.testing.assert_allclose(fresh.default_tolerance(), [0.01 * largest, 1e-3 * largest])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda q, tau: (q, 0.0 * tau), "zero in every row"),
        (lambda q, tau: (q, 0.0 * tau + 1.0), "the same in all"),
        (lambda q, tau: (q[:4], tau[:4]), "4 (4 rows; rows of one pose count as one)"),
        (lambda q, tau: (q[[0, 1] * 20], tau[[0, 1] * 20]), "2 (40 rows"),
    ],
)
def test_measurements_that_say_nothing_are_refused(change, words):
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (40, 2))
    with pytest.raises(InputError) as refused:
        FreshMeasurements.of(FILE, StaticSamples(*change(q, torque(q))), NAMES)
    assert words in str(refused.value)
    assert str(refused.value).startswith("fresh.csv")
    assert LEAST_POSES > 4
