"""Relations are judged by torques that were measured; what could not be looked at does not pass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.models.fresh_measurements import FreshMeasurements
from isotorque.verify.relations.measured_relations import verify_relations_on_measurements
from isotorque.verify.relations.relation_files import RelationsFile
from isotorque.verify.verdict import Status

NAMES = ("shoulder", "elbow")
IDENTITY = SymmetryRelation(np.eye(2), [0, 0], [1, 1], exact=True)
FLIP = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
TURN = SymmetryRelation([[1, 0], [0, 1]], [np.pi, 0], [-1, -1])
SMALL = MeasurementNoise(0.0, 1e-3)
WRONG = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])


def torque(q):
    lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    return np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)


def bent(q):
    """No rigid gravity; all its symmetries hold."""
    return 6.0 * np.tanh(torque(q) / 6.0)


def claims(*relations, **more):
    return RelationsFile("relations.json", relations, **more)


def fresh(q, tau, noise=0.0, seed=0):
    tau = tau + noise * np.random.default_rng(seed).normal(size=tau.shape)
    return FreshMeasurements.of(Path("fresh.csv"), StaticSamples(q, tau), NAMES)


def recording(seed, poses=25, repeated=1, noise=0.02, constant=0.0):
    q = np.random.default_rng(seed).uniform(-2.5, 2.5, (poses, 2)).repeat(repeated, axis=0)
    return fresh(q, torque(q) + constant, noise, seed + 1)


def paired(relation, seed=0, count=8, noise=0.0, function=bent):
    q = np.random.default_rng(seed).uniform(-1.5, 1.5, (count, 2))
    q = np.concatenate([q, relation.configuration(q)])
    return fresh(q, function(q), noise)


@settings(max_examples=6)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.02, 0.05]), st.integers(1, 3))
def test_right_relations_are_tested_by_a_fit(seed, noise, repeated):
    data = recording(seed, 25, repeated, noise)
    judged = verify_relations_on_measurements(claims(IDENTITY, FLIP, TURN), data)
    first, *others = judged.verdicts
    assert first.status is Status.PROVED
    for verdict in others:
        if noise == 0.05 and repeated == 1:  # nearly the tolerance of the elbow
            assert verdict.status is not Status.REFUTED
            continue
        assert verdict.status is Status.TESTED
        assert verdict.claim.startswith("the torque that was measured: relation ")
        assert "fitted to 25 poses: wrong by at most" in verdict.reason


@settings(max_examples=15)
@given(
    st.integers(0, 10_000), st.floats(0.0, 3.0), st.integers(5, 40), st.floats(0.1, 3.0), st.data()
)
def test_a_wrong_relation_never_passes(seed, noise, poses, offset, draw):
    near = WRONG
    if draw.draw(st.booleans()):
        near = SymmetryRelation(FLIP.A, [0.0, offset], FLIP.Y)
    data = recording(seed, poses, 1, noise)
    (verdict,) = verify_relations_on_measurements(claims(near), data).verdicts
    # off by 0.1 rad: 0.6 N m at the elbow, ten times the tolerance
    assert not verdict.passed
    if poses > 20 and noise < 0.05:
        assert verdict.status is Status.REFUTED
        assert verdict.counterexample is not None


def test_the_bound_of_the_file_counts_and_the_tolerance_adds():
    off = [0.0, 0.05]  # 0.3 N m at both joints
    data = recording(4, 30, noise=0.01)
    for bound, tolerance, status in (
        (None, 0.1, Status.REFUTED),
        ([0.35, 0.35], 0.1, Status.TESTED),
        ([0.35, 0.05], 0.1, Status.REFUTED),
        (None, 0.4, Status.TESTED),
        ([0.26, 0.26], 0.02, Status.UNTESTED),  # a cable might make up for it
        ([0.2, 0.2], 0.2, Status.TESTED),
    ):
        relation = SymmetryRelation(FLIP.A, off, FLIP.Y, bound=bound)
        judged = verify_relations_on_measurements(claims(relation), data, tolerance=tolerance)
        assert judged.verdicts[0].status is status, (bound, tolerance)


def test_pairs_of_poses_judge_where_no_form_explains_the_torque():
    for relation in (FLIP, TURN):
        data = paired(relation)
        (verdict,) = verify_relations_on_measurements(claims(relation), data, noise=SMALL).verdicts
        assert verdict.status is Status.TESTED
        assert "pairs of poses, compared directly; nowhere else" in verdict.reason
    data = paired(WRONG)
    (verdict,) = verify_relations_on_measurements(claims(WRONG), data).verdicts
    assert verdict.status is Status.REFUTED
    assert "compared directly; worst: row " in verdict.reason
    pose = np.flatnonzero((data.q == verdict.counterexample).all(axis=1))
    there = bent(WRONG.configuration(data.q[pose]))
    assert np.abs(there - bent(data.q[pose])).max() > 0.1


def test_fewer_than_five_pairs_are_no_pass():
    data = paired(FLIP, count=4)
    (verdict,) = verify_relations_on_measurements(claims(FLIP), data, noise=SMALL).verdicts
    assert verdict.status is Status.UNTESTED
    assert verdict.reason.startswith("4 pairs of poses can be compared directly, and no form")
    one_wrong = paired(WRONG, count=4)
    (verdict,) = verify_relations_on_measurements(claims(WRONG), one_wrong, noise=SMALL).verdicts
    assert verdict.status is Status.REFUTED


def test_noise_of_pairs_is_allowed_for_and_may_hide_too_much():
    data = paired(FLIP, count=12, noise=0.05)
    stated = MeasurementNoise(0.0, 0.05)
    (verdict,) = verify_relations_on_measurements(
        claims(FLIP), data, tolerance=0.1, noise=stated
    ).verdicts
    assert verdict.status is Status.TESTED
    data = paired(FLIP, count=12, noise=1.0)
    (verdict,) = verify_relations_on_measurements(
        claims(FLIP), data, tolerance=0.1, noise=MeasurementNoise(0.0, 1.0)
    ).verdicts
    assert verdict.status is Status.UNTESTED


def test_without_power_nothing_passes():
    few = recording(0, poses=5, noise=0.1)
    judged = verify_relations_on_measurements(claims(FLIP, TURN), few)
    assert [v.status for v in judged.verdicts] == [Status.UNTESTED] * 2
    assert "missing: " in judged.verdicts[0].reason
    noisy = recording(0, poses=40, noise=3.0)
    judged = verify_relations_on_measurements(claims(FLIP, TURN), noisy)
    assert [v.status for v in judged.verdicts] == [Status.UNTESTED] * 2
    assert "unless the torques were measured that badly" in judged.verdicts[0].reason
    noisy = recording(0, poses=40, noise=0.3)
    (verdict,) = verify_relations_on_measurements(claims(TURN), noisy).verdicts
    assert verdict.status is Status.UNTESTED
    assert "more than 3 times what is allowed" in verdict.reason


def test_constants_contradict_flips_unless_the_file_corrects_them():
    data = recording(1, 40, noise=0.01, constant=[0.0, 1.0])
    flip, turn = verify_relations_on_measurements(claims(FLIP, TURN), data).verdicts
    assert flip.status is Status.TESTED
    assert not turn.passed
    correction = Correction([0.0, 1.0])
    file = claims(FLIP, corrected=(TURN.of_measured(correction), FLIP.of_measured(correction)))
    judged = verify_relations_on_measurements(file, data)
    assert [v.status for v in judged.verdicts] == [Status.TESTED] * 3
    opposite = claims(TURN.of_measured(Correction([0.0, -1.0])))
    assert not verify_relations_on_measurements(opposite, data).verdicts[0].passed


def test_springs_are_taken_off_where_the_file_says_so():
    """Angles count as they are: a turn of a joint with a spring makes a difference."""
    rate = np.array([0.0, 0.4])
    q = np.random.default_rng(5).uniform(-2.5, 2.5, (40, 2))
    data = fresh(q, torque(q) + rate * q, 0.01)
    assert not verify_relations_on_measurements(claims(FLIP), data).verdicts[0].passed
    true = claims(FLIP.of_measured(Correction([0.0, 0.0], rate)))
    assert verify_relations_on_measurements(true, data).verdicts[0].status is Status.TESTED
    half = claims(FLIP.of_measured(Correction([0.0, 0.0], 0.5 * rate)))
    assert not verify_relations_on_measurements(half, data).verdicts[0].passed


def test_pairs_are_compared_less_their_corrections():
    data = paired(FLIP, function=lambda q: bent(q) + [0.0, 0.5] * q)
    plain = verify_relations_on_measurements(claims(FLIP), data, noise=SMALL).verdicts[0]
    assert plain.status is Status.REFUTED
    corrected = claims(FLIP.of_measured(Correction([0.0, 0.0], [0.0, 0.5])))
    judged = verify_relations_on_measurements(corrected, data, noise=SMALL).verdicts[0]
    assert judged.status is Status.TESTED
    assert "pairs of poses" in judged.reason


def test_what_measurements_cannot_tell_is_said_and_a_group_is_judged():
    exact = SymmetryRelation(FLIP.A, FLIP.d, FLIP.Y, exact=True)
    file = claims(IDENTITY, exact, order=2, complete=True)
    judged = verify_relations_on_measurements(file, recording(2))
    assert judged.verdicts[-1].claim == "the 2 relations listed form a group"
    assert any(
        "measurements cannot tell: that relations are exact and that none is missing" in said
        for said in judged.remarks
    )
    broken = verify_relations_on_measurements(claims(FLIP, TURN, order=2), recording(2))
    assert broken.verdicts[-1].status is Status.REFUTED


@pytest.mark.parametrize(
    ("file", "words"),
    [
        (claims(SymmetryRelation(np.eye(3), np.zeros(3), np.ones(3))), "number of joints"),
        (claims(FLIP, joint_names=("elbow", "shoulder")), "joints"),
    ],
)
def test_claims_about_other_arms_are_refused(file, words):
    with pytest.raises(InputError, match=words):
        verify_relations_on_measurements(file, recording(0))
