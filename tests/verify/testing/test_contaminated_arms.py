"""Contaminations do what they say, and their least standard errors are those of estimates."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.contaminated_arms import (
    OF_ALL_JOINTS,
    PAYLOAD_CENTRE,
    Contaminant,
    Contamination,
    TrueArm,
)

NOISE = 0.05
NAMES = ("2r", "3r", "ur5", "panda")
OF_ONE_JOINT = [kind for kind in Contaminant if kind not in OF_ALL_JOINTS]
FEW = settings(
    max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


@cache
def true_arm(name: str) -> TrueArm:
    return TrueArm.of(load_robot(name))


@st.composite
def drawn(draw, kinds=tuple(Contaminant), names=NAMES, poses=20):
    """A contamination and a size below its largest, of either sign."""
    arm = true_arm(draw(st.sampled_from(names)))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    q = rng.uniform(-np.pi, np.pi, (poses, arm.n))
    kind, joint = draw(st.sampled_from(kinds)), draw(st.integers(0, arm.n - 1))
    found = Contamination.drawn(arm, kind, q, rng, joint=joint, recorded_directions=True)
    return found, draw(st.floats(-1.0, 1.0)) * found.largest


def added(found: Contamination, size: float) -> np.ndarray:
    """What is measured beside gravity at the measured angles."""
    return found.torque(size) - found.arm.gravity.torque(found.q)


@FEW
@given(drawn(kinds=OF_ONE_JOINT))
def test_one_joint_alone_measures_something_else(case):
    found, size = case
    others = np.delete(np.arange(found.arm.n), found.joint)
    if found.kind in (
        Contaminant.COMPLIANCE,
        Contaminant.SCALE,
    ):  # angles of one joint change all torques
        inside = found.q.copy()
        inside[:, found.joint] = 0.0
        if found.kind is Contaminant.SCALE:
            same = replace(found, q=inside).torque(size)
            np.testing.assert_allclose(same, found.arm.gravity.torque(inside))
    else:
        np.testing.assert_array_equal(added(found, size)[:, others], 0.0)


@FEW
@given(
    drawn(
        kinds=[
            Contaminant.OFFSET,
            Contaminant.GAIN,
            Contaminant.SPRING,
            Contaminant.CABLE,
            Contaminant.ONE_SIDED,
        ]
    )
)
def test_torque_that_is_added_has_the_formula_of_its_kind(case):
    found, x = case
    j, angle = found.joint, found.q[:, found.joint]
    torque = found.arm.gravity.torque(found.q)[:, j]
    expected = {
        Contaminant.OFFSET: np.full(len(angle), x),
        Contaminant.ONE_SIDED: np.full(len(angle), x),
        Contaminant.GAIN: x * torque,
        Contaminant.SPRING: x * (angle - found.shape[j]),
        Contaminant.CABLE: x * np.sin(2 * angle + found.shape[j]),
    }[found.kind]
    np.testing.assert_allclose(added(found, x)[:, j], expected, atol=1e-11)


@FEW
@given(drawn(kinds=[Contaminant.SIGN]))
def test_a_sign_is_a_gain_of_minus_two(case):
    found, _ = case
    torque = found.arm.gravity.torque(found.q)
    torque[:, found.joint] *= -1.0
    np.testing.assert_allclose(found.torque(-found.largest), torque, atol=1e-12)


@FEW
@given(drawn(kinds=[Contaminant.COMPLIANCE, Contaminant.SCALE]))
def test_angles_are_measured_before_the_gear(case):
    """From where the links are to what is measured: the other way round than the package goes."""
    found, x = case
    link = found.q
    torque = found.arm.gravity.torque(link)
    measured = link.copy()
    if found.kind is Contaminant.SCALE:
        measured[:, found.joint] /= 1.0 + x
    else:
        x *= 0.3  # a spring so soft that the arm has one place to rest for every motor angle
        measured[:, found.joint] += x * torque[:, found.joint]
    np.testing.assert_allclose(found.truth(x)(measured), torque, atol=1e-9)


@FEW
@given(drawn(kinds=[Contaminant.FRICTION, Contaminant.HIDDEN]))
def test_friction_has_the_sign_of_the_last_motion(case):
    found, x = case
    directions = found.directions[:, found.joint]
    assert set(directions) == {-1.0, 1.0}
    np.testing.assert_allclose(added(found, x)[:, found.joint], x * directions, atol=1e-11)
    recorded = found.measured(x, 0.0, np.random.default_rng(0)).directions
    if found.kind is Contaminant.FRICTION:
        np.testing.assert_array_equal(recorded, found.directions)
    else:
        assert recorded is None
    at_rest = found.truth(x)(found.q)  # in the middle of both sides
    np.testing.assert_array_equal(at_rest, found.arm.gravity.torque(found.q))


@FEW
@given(drawn(kinds=[Contaminant.ONE_SIDED]))
def test_friction_from_one_side_belongs_to_the_arm_as_measured(case):
    found, x = case
    recorded = found.measured(x, 0.0, np.random.default_rng(0))
    assert recorded.directions is None
    assert np.all(found.directions == 1.0)
    np.testing.assert_array_equal(recorded.truth[0](found.q), recorded.tau)


@FEW
@given(drawn(kinds=[Contaminant.AMPERES]))
def test_amperes_are_a_gain_for_every_joint(case):
    found, x = case
    torque = found.arm.gravity.torque(found.q)
    loaded = found.arm.peak > 1e-9
    ratios = found.torque(x)[:, loaded] / torque[:, loaded]
    np.testing.assert_allclose(ratios, np.tile(np.exp(x * found.shape[loaded]), (20, 1)))
    assert len(set(found.shape)) == found.arm.n


def test_a_payload_comes_in_the_middle():
    """Pinocchio's torque with another body at the last link."""
    robot, arm, rng = load_robot("ur5"), true_arm("ur5"), np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (9, arm.n))
    body = pin.Inertia(0.7, np.array(PAYLOAD_CENTRE), np.zeros((3, 3)))
    model = robot.model.copy()
    model.appendBodyToJoint(model.njoints - 1, body, pin.SE3.Identity())
    data = model.createData()
    heavy = np.array([pin.computeGeneralizedGravity(model, data, x).copy() for x in q])
    found = Contamination.drawn(arm, Contaminant.PAYLOAD, q, rng)
    recorded = found.measured(0.7, 0.0, rng)
    expected = np.concatenate([arm.gravity.torque(q[:4]), heavy[4:]])
    np.testing.assert_allclose(recorded.tau, expected, atol=1e-9)
    before, after = recorded.truth
    np.testing.assert_allclose(before(q), arm.gravity.torque(q), atol=1e-9)
    np.testing.assert_allclose(after(q), heavy, atol=1e-9)


@pytest.mark.parametrize("poses", [3, 2000])
def test_outliers_are_one_pose_in_twenty_and_at_least_one(poses):
    arm, rng = true_arm("2r"), np.random.default_rng(4)
    q = rng.uniform(-np.pi, np.pi, (poses, 2))
    found = Contamination.drawn(arm, Contaminant.OUTLIERS, q, rng)
    errors = added(found, 3.0)
    wrong = np.any(errors != 0.0, axis=1)
    assert 1 <= wrong.sum() <= max(1, 0.08 * poses)
    if poses > 100:
        assert wrong.mean() > 0.03
        assert errors[wrong].std() == pytest.approx(3.0, rel=0.2)
    np.testing.assert_array_equal(found.truth(3.0)(q), arm.gravity.torque(q))


def test_a_clean_arm_measures_gravity_and_noise():
    arm, rng = true_arm("3r"), np.random.default_rng(5)
    q = rng.uniform(-np.pi, np.pi, (4000, 3))
    clean = Contamination.drawn(arm, None, q, rng, recorded_directions=True)
    recorded = clean.measured(7.0, np.array([0.01, 0.1, 1.0]), rng, angle_noise=0.02)
    errors = recorded.tau - arm.gravity.torque(q)
    np.testing.assert_allclose(errors.std(axis=0), [0.01, 0.1, 1.0], rtol=0.05)
    assert (recorded.q - q).std() == pytest.approx(0.02, rel=0.05)
    assert recorded.directions is not None
    np.testing.assert_array_equal(recorded.truth[0](q), arm.gravity.torque(q))
    unrecorded = Contamination.drawn(arm, None, q, rng).measured(0.0, 0.0, rng)
    assert unrecorded.directions is None


def test_a_kind_of_one_joint_needs_one():
    with pytest.raises(InputError, match="joint is None"):
        Contamination.drawn(
            true_arm("2r"), Contaminant.GAIN, np.zeros((3, 2)), np.random.default_rng(0)
        )


# -- standard errors ----------------------------------------------------------------------------


def planar(x, q):
    """Torques of a planar 2R arm by four numbers: a formulation without any rotation."""
    whole = q.sum(axis=1)
    elbow = x[0] * np.cos(whole) + x[1] * np.sin(whole)
    return np.stack([elbow + x[2] * np.cos(q[:, 0]) + x[3] * np.sin(q[:, 0]), elbow], axis=1)


@pytest.mark.parametrize("kind", [Contaminant.OFFSET, Contaminant.GAIN])
def test_least_standard_errors_are_those_of_estimates(kind):
    """Monte Carlo: fits of arm and size together to many noisy recordings."""
    arm, rng, runs = true_arm("2r"), np.random.default_rng(6), 400
    q = rng.uniform(-np.pi, np.pi, (15, 2))
    found = Contamination.drawn(arm, kind, q, rng, joint=0)
    true = np.linalg.lstsq(
        np.stack([planar(unit, q).ravel() for unit in np.eye(4)], axis=1),
        arm.gravity.torque(q).ravel(),
    )[0]
    error = found.standard_error(NOISE)

    def residual(x, tau):
        torque = planar(x, q)
        torque[:, 0] += x[4] if kind is Contaminant.OFFSET else x[4] * torque[:, 0]
        return (torque - tau).ravel()

    estimates = [
        least_squares(residual, [*true, 0.0], args=(found.measured(5 * error, NOISE, rng).tau,)).x[
            4
        ]
        for _ in range(runs)
    ]
    assert np.std(estimates) == pytest.approx(error, rel=4 / np.sqrt(2 * runs))
    assert np.mean(estimates) == pytest.approx(5 * error, abs=4 * error / np.sqrt(runs))


@FEW
@given(drawn(poses=12))
def test_a_standard_error_grows_with_noise(case):
    found, _ = case
    error = found.standard_error(0.02)
    assert found.standard_error(0.06) == pytest.approx(3 * error)
    assert found.standard_error(np.full(found.arm.n, 0.02)) == pytest.approx(error)
    uneven = np.linspace(0.01, 0.02, found.arm.n)
    assert found.standard_error(uneven) <= error * (1 + 1e-9)


@pytest.mark.parametrize(
    ("name", "kind", "joint"),
    [
        ("ur5", Contaminant.GAIN, 5),  # no torque
        ("ur5", Contaminant.COMPLIANCE, 0),
        ("ur5", Contaminant.SCALE, 0),  # a vertical axis
        ("panda", Contaminant.SIGN, 0),
    ],
)
def test_what_nothing_can_show_has_no_standard_error(name, kind, joint):
    arm, rng = true_arm(name), np.random.default_rng(7)
    q = rng.uniform(-np.pi, np.pi, (30, arm.n))
    assert Contamination.drawn(arm, kind, q, rng, joint=joint).standard_error(NOISE) == np.inf


def test_a_common_gain_is_a_heavier_arm():
    """Levers take it up, so that amperes of equal size on all joints are nothing."""
    arm, rng = true_arm("3r"), np.random.default_rng(8)
    q = rng.uniform(-np.pi, np.pi, (30, 3))
    found = Contamination.drawn(arm, Contaminant.AMPERES, q, rng)
    assert np.isfinite(found.standard_error(NOISE))
    assert replace(found, shape=np.ones(3)).standard_error(NOISE) == np.inf


def test_two_coupled_joints_have_one_ratio_of_gains():
    arm, rng = true_arm("2r"), np.random.default_rng(9)
    q = rng.uniform(-np.pi, np.pi, (30, 2))
    effects = [
        Contamination.drawn(arm, Contaminant.GAIN, q, rng, joint=j).effect(NOISE) for j in range(2)
    ]
    np.testing.assert_allclose(effects[0], -effects[1], rtol=1e-4, atol=1e-6)
    assert np.linalg.norm(effects[0]) > 1.0
