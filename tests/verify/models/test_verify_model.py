"""Errors of learned models are measured as defined, and the worst one is found."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.largest_errors import default_tolerance
from isotorque.verify.models.stability import has_stable_image
from isotorque.verify.models.target_sets import dense_targets, grid_targets, scattered_targets
from isotorque.verify.models.verify_model import torque_rmse, verify_model
from isotorque.verify.testing.strategies import known_arms
from isotorque.verify.verdict import Status, all_passed


class Learned:
    """The truth plus a known error."""

    def __init__(self, gravity, error):
        self.gravity, self.error = gravity, error

    def predict(self, q):
        return self.gravity.torque(q) + self.error(q)


def test_the_truth_passes_everything(two_link):
    judgement = verify_model(
        two_link.gravity.torque,
        two_link.gravity,
        group=two_link.group,
        tolerance=1e-9,
        largest_tolerance=1e-9,
        equivariance_tolerance=1e-9,
    )
    assert judgement.rmse == 0.0
    assert judgement.equivariance_error < 1e-12
    assert len(judgement.verdicts) == 3
    assert all_passed(judgement.verdicts)


def test_the_rmse_is_that_of_its_definition(two_link):
    model = Learned(two_link.gravity, lambda q: np.stack([np.cos(q[:, 0]), 0 * q[:, 1]], axis=1))
    grid = grid_targets([0.0, 0.0], [[np.pi / 2, -np.pi / 2], [0, np.pi]], (6, 11))
    judgement = verify_model(model, two_link.gravity, targets=[grid], tolerance=0.01)
    found = judgement.targets[1]
    assert (found.name, found.count) == ("6 x 11 grid", 66)
    expected = np.mean(np.cos(np.linspace(0, np.pi / 2, 6)) ** 2)
    assert found.rmse == pytest.approx(np.sqrt(expected / 2))
    assert found.rmse_by_joint == pytest.approx([np.sqrt(expected), 0.0])
    assert judgement.rmse == pytest.approx(0.5, abs=0.02)  # mean of cos^2 / 2 over the torus
    assert judgement.verdicts[0].status is Status.REFUTED
    assert judgement.verdicts[0].counterexample is None


def test_a_narrow_error_is_found_by_climbing(two_link):
    peak = np.array([0.4, -1.1])

    def bump(q):
        distance = np.sum((q - peak) ** 2, axis=1)
        return np.stack([0 * distance, np.exp(-distance)], axis=1)

    judgement = verify_model(
        Learned(two_link.gravity, bump), two_link.gravity, largest_tolerance=0.5
    )
    assert np.allclose(judgement.worst_configuration, peak, atol=1e-3)
    assert judgement.largest_error[1] == pytest.approx(1.0, abs=1e-6)
    verdict = judgement.verdicts[0]
    assert verdict.status is Status.REFUTED
    assert np.array_equal(verdict.counterexample, judgement.worst_configuration)


@given(st.floats(0.05, 0.95))
@settings(max_examples=8)
def test_what_a_set_misses_and_a_search_finds_refutes(two_link, share):
    """The worst of the set is within what is allowed, the worst of the space is not."""
    peak = np.array([0.4, -1.1])

    def bump(q):
        distance = np.sum((q - peak) ** 2, axis=1) / 0.04**2
        return np.stack([0 * distance, np.exp(-distance)], axis=1)

    seen = bump(dense_targets([[-np.pi, np.pi]] * 2).q).max()
    assert seen < 0.95
    allowed = seen + share * (1.0 - seen)
    judgement = verify_model(
        Learned(two_link.gravity, bump), two_link.gravity, tolerance=1.0, largest_tolerance=allowed
    )
    if judgement.largest_error[1] > allowed:  # where the search found it
        assert [v.status for v in judgement.verdicts] == [Status.TESTED, Status.REFUTED]
    assert judgement.verdicts[-1].worst_error == pytest.approx(judgement.largest_error.max())
    assert judgement.largest_error.max() > seen


def test_limits_keep_the_search_inside(two_link):
    limits = np.array([[-1.0, 0.5], [0.2, 0.3]])
    model = Learned(two_link.gravity, lambda q: q)
    judgement = verify_model(model, two_link.gravity, limits=limits)
    assert judgement.worst_configuration[0] == pytest.approx(-1.0)
    assert judgement.largest_error[0] == pytest.approx(1.0)


def test_a_model_that_breaks_a_symmetry_is_caught(two_link):
    model = Learned(two_link.gravity, lambda q: 0.1 * np.sin(q))
    judgement = verify_model(
        model, two_link.gravity, group=two_link.group, equivariance_tolerance=0.01
    )
    assert judgement.equivariance_error > 0.1
    verdict = judgement.verdicts[-1]
    assert verdict.status is Status.REFUTED
    q = verdict.counterexample
    found = max(
        np.abs(model.predict(r.configuration(q)[None]) - r.torque(model.predict(q[None]))).max()
        for r in two_link.group
    )
    assert found == pytest.approx(judgement.equivariance_error)


def test_a_peak_that_random_starts_miss_is_climbed_from_the_dense_set(two_link):
    start = dense_targets([[-np.pi, np.pi]] * 2).q[1234]
    peak = start + 0.004

    def bump(q):
        distance = np.sum((q - peak) ** 2, axis=1) / 0.01**2
        return np.stack([np.exp(-distance), 0 * distance], axis=1)

    judgement = verify_model(Learned(two_link.gravity, bump), two_link.gravity)
    assert np.allclose(judgement.worst_configuration, peak, atol=1e-4)
    assert judgement.largest_error[0] == pytest.approx(1.0, abs=1e-4)


def test_a_model_that_counts_turns_is_caught(two_link):
    model = Learned(two_link.gravity, lambda q: 0.1 * (np.abs(q) > np.pi))
    judgement = verify_model(model, two_link.gravity, periodicity_tolerance=0.01)
    assert judgement.rmse == 0.0
    assert judgement.periodicity_error == pytest.approx(0.1)
    assert judgement.verdicts[-1].status is Status.REFUTED
    periodic = verify_model(two_link.gravity.torque, two_link.gravity, periodicity_tolerance=1e-9)
    assert periodic.periodicity_error < 1e-12
    assert all_passed(periodic.verdicts)


def test_errors_at_joint_limits_are_told_apart(two_link):
    limits = np.array([[-1.0, 0.5], [-np.pi, np.pi]])
    edge = Learned(two_link.gravity, lambda q: 1.0 * (np.abs(q + 0.25) > 0.75 - 1e-9) * [1.0, 0.0])
    judgement = verify_model(edge, two_link.gravity, limits=limits)
    assert judgement.rmse == 0.0
    assert judgement.at_limits.name == "at joint limits"
    assert judgement.at_limits.rmse_by_joint == pytest.approx([1.0, 0.0])
    assert judgement.at_limits.count == len(dense_targets(limits).q)
    assert verify_model(edge, two_link.gravity).at_limits is None


def test_joints_that_gravity_does_not_load_are_judged_too(upright):
    gravity = GravityModel(upright)
    assert gravity.free_joints == ("joint1",)
    model = Learned(gravity, lambda q: np.array([5.0, 0.1]) + 0 * q)
    judgement = verify_model(model, gravity, tolerance=0.11, largest_tolerance=0.11)
    assert judgement.rmse == pytest.approx(np.hypot(5.0, 0.1))
    assert judgement.rmse_by_joint == pytest.approx([5.0, 0.1])
    assert judgement.largest_error == pytest.approx([5.0, 0.1])
    assert [verdict.status for verdict in judgement.verdicts] == [Status.REFUTED] * 2
    # nor are departures from symmetry and period overlooked there
    turning = Learned(gravity, lambda q: 5.0 * q[:, ::-1] * [1.0, 0.0])
    group = primary_symmetries(gravity.potential)
    assert verify_model(turning, gravity, group=group).equivariance_error > 1.0
    assert verify_model(turning, gravity).periodicity_error == pytest.approx(10.0 * np.pi)
    # what is added at joints without gravity is not diluted by them
    alone = verify_model(Learned(gravity, lambda q: 0 * q + [0.0, 0.1]), gravity)
    assert alone.rmse == pytest.approx(0.1)


@settings(max_examples=12)
@given(data=st.data(), arm=known_arms(max_joints=4, planted=None))
def test_a_defect_at_any_joint_is_refuted_and_the_truth_passes(data, arm):
    gravity = arm.gravity
    limits = np.array([[-np.pi, np.pi]] * gravity.n)
    tolerance = default_tolerance(gravity, limits)
    accepted = {"tolerance": tolerance, "largest_tolerance": tolerance}
    assert all_passed(verify_model(gravity.torque, gravity, **accepted).verdicts)
    joint = data.draw(st.integers(0, gravity.n - 1), "joint")
    kind = data.draw(st.sampled_from(["offset", "wave", "dent"]), "kind")
    size = data.draw(st.floats(1.5, 10.0), "size") * tolerance[joint]

    def defect(q):
        error = np.zeros_like(q)
        shape = {
            "offset": np.ones(len(q)),
            "wave": np.sqrt(2.0) * np.sin(q[:, joint] + 0.3),
            "dent": np.exp(-0.5 * ((q - 0.4) ** 2).sum(axis=1)),
        }
        error[:, joint] = size * shape[kind]
        return error

    refuted = verify_model(Learned(gravity, defect), gravity, **accepted)
    assert not all_passed(refuted.verdicts)
    largest = refuted.verdicts[-1]
    assert largest.status is Status.REFUTED
    where = largest.counterexample[None]
    assert np.abs(defect(where)[0, joint]) > tolerance[joint]
    assert refuted.largest_error[joint] == pytest.approx(np.abs(defect(where)[0, joint]), rel=1e-3)
    if kind != "dent":
        assert refuted.verdicts[0].status is Status.REFUTED


def test_nothing_is_claimed_beside_a_torque_of_zero(upright):
    gravity = GravityModel(dataclasses.replace(upright, masses=np.zeros(2)))
    verify_model(lambda q: 0 * q, gravity)  # measured, not claimed
    for claim in (
        "tolerance",
        "largest_tolerance",
        "equivariance_tolerance",
        "periodicity_tolerance",
    ):
        with pytest.raises(InputError, match="gravity torque is zero at every joint"):
            verify_model(lambda q: 0 * q, gravity, **{claim: 0.1})


def test_the_part_that_an_arm_can_learn_is_judged_apart(arms):
    arm = arms["3r"]
    q = dense_targets([[-np.pi, np.pi]] * 3).q
    held = has_stable_image(q, arm.gravity, arm.group)
    assert 0 < held.sum() < len(q)
    # wrong only where no orbit has a stable member
    model = Learned(
        arm.gravity,
        lambda q: np.where(has_stable_image(q, arm.gravity, arm.group), 0.01, 2.0)[:, None] + 0 * q,
    )
    judged = verify_model(
        model, arm.gravity, orbits=arm.group, tolerance=0.05, largest_tolerance=0.05
    )
    assert [verdict.passed for verdict in judged.verdicts] == [True, True, False, False]
    stable, whole = judged.targets[1], judged.targets[0]
    assert stable.largest == pytest.approx(0.01)
    assert whole.largest == pytest.approx(2.0)
    assert "orbits with a stable member" in judged.verdicts[1].claim
    assert "on the whole space" in judged.verdicts[3].claim


def test_the_default_tolerance_is_a_share_of_each_joint_and_never_nothing(upright, two_link):
    limits = np.array([[-np.pi, np.pi]] * 2)
    upper = default_tolerance(GravityModel(upright), limits)
    assert upper[0] == pytest.approx(0.1 * upper[1])  # not loaded: a thousandth of the other
    narrow = np.array([[np.pi / 4 - 0.1, np.pi / 4]] * 2)  # not everywhere
    corner = np.abs(two_link.gravity.torque(narrow[:, 0]))  # the largest: cos(q1 + q2) falls
    allowed = default_tolerance(two_link.gravity, narrow)
    assert allowed[1] == pytest.approx(np.maximum(0.01 * corner[1], 0.001 * corner[0]))
    assert allowed[1] < 0.5 * default_tolerance(two_link.gravity, [[-np.inf, np.inf]] * 2)[1]


@pytest.mark.parametrize("bad", [-1.0, np.nan, [1.0, 1.0, 1.0], [[1.0, 1.0]]])
def test_tolerances_that_mean_nothing_are_refused(two_link, bad):
    for name in ("tolerance", "largest_tolerance"):
        with pytest.raises(InputError, match="tolerance is"):
            verify_model(two_link.gravity.torque, two_link.gravity, **{name: bad})


def test_orbits_with_and_without_a_stable_member_are_told_apart(arms):
    arm = arms["3r"]
    invariant = Learned(
        arm.gravity,
        lambda q: (np.sin(q[:, 1]) * np.sin(q[:, 1] + q[:, 2]) < 0)[:, None] * np.ones((1, 3)),
    )
    dense, good, bad = verify_model(invariant, arm.gravity, orbits=arm.group).targets
    # physics.md: only where sin q2 sin(q2 + q3) > 0 can a member be stable; 21 % of orbits have one
    assert good.rmse == 0.0
    assert good.count + bad.count == dense.count
    assert good.count / dense.count == pytest.approx(0.21, abs=0.02)
    assert bad.stable == 0
    assert good.stable == dense.stable
    assert dense.stable / dense.count == pytest.approx(0.11, abs=0.02)


def test_every_orbit_of_the_2r_arm_has_a_stable_member(two_link):
    judgement = verify_model(two_link.gravity.torque, two_link.gravity, orbits=two_link.group)
    (dense,) = judgement.targets
    assert dense.stable / dense.count == pytest.approx(0.25, abs=0.03)


def test_rmse_of_nothing_is_zero():
    assert torque_rmse(np.zeros((3, 2)), [False, False]) == 0.0


def test_dense_sets_are_the_same_every_time_and_within_limits():
    robot = load_robot("2r")
    first, second = dense_targets(robot.limits), dense_targets(robot.limits)
    assert np.array_equal(first.q, second.q)
    assert len(first.q) >= 1500
    narrow = dense_targets([[0.1, 0.2], [-50.0, 50.0]]).q
    assert np.all((narrow[:, 0] >= 0.1) & (narrow[:, 0] <= 0.2))
    assert np.all(np.abs(narrow[:, 1]) <= np.pi)
    assert scattered_targets(robot.limits, 84, seed=1).q.shape == (84, 2)
    with pytest.raises(InputError, match="limits"):
        dense_targets([[1.0, 0.0]])


@pytest.mark.parametrize(
    ("predict", "message"),
    [
        (lambda q: q[:, :1], "shape of predictions"),
        (lambda q: q * np.nan, "prediction at q = .* is not finite"),
    ],
)
def test_unusable_predictions_are_refused(two_link, predict, message):
    with pytest.raises(InputError, match=message):
        verify_model(predict, two_link.gravity)
