"""What is beside a linear model is seen where it is, by pose, and never where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


@pytest.fixture(scope="module")
def arm():
    return GravityModel(load_robot("2r"))


def learners(arm):
    group = primary_symmetries(arm.potential)
    return (
        StaticRegressor("2r"),
        StaticRegressor("2r", group=group),
        StaticRegressor("2r", ridge=1e-14),
        EquivariantTrigonometric(),
        EquivariantTrigonometric(group=group),
        EquivariantTrigonometric(ridge=1e-14),
    )


def recorded(arm, poses, seed, noise):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, 2))
    return q, arm.torque(q) + noise * rng.normal(size=q.shape)


FAR = np.random.default_rng(99).uniform(-3.0, 3.0, (200, 2))


@pytest.mark.parametrize("offset", [(0.0, 0.2), (1.2, 0.4)])
@pytest.mark.parametrize(("noise", "poses"), [(0.0, 8), (0.02, 40)])
def test_gravity_and_constants_are_told_apart(arm, offset, noise, poses):
    q, tau = recorded(arm, poses, 0, noise)
    allowed = 1e-9 if not noise else 0.03
    for learner in learners(arm):
        learner.fit(q, tau + offset)
        assert ((learner.offsets_ != 0.0) == (np.array(offset) != 0.0)).all()
        np.testing.assert_allclose(learner.offsets_, offset, atol=allowed)
        error = learner.predict(FAR) - arm.torque(FAR)
        assert np.abs(error - offset).max() < allowed  # what a sensor would show
        assert np.abs(error - learner.offsets_).max() < allowed  # gravity alone
        copy = type(learner).from_arrays(learner.to_arrays(), learner.parameters())
        np.testing.assert_array_equal(copy.predict(FAR), learner.predict(FAR))
        np.testing.assert_allclose(
            evaluate(torque_form(learner), FAR), learner.predict(FAR), atol=1e-9
        )


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_no_constant_is_seen_where_there_is_none(arm, noise):
    for seed in range(30):
        q, tau = recorded(arm, (4, 6, 9, 30)[seed % 4], seed, noise * np.array([1.0, 0.3]))
        for learner in (StaticRegressor("2r"), EquivariantTrigonometric()):
            assert not learner.fit(q, tau).offsets_.any()


def test_rows_of_one_pose_are_one_sample(arm):
    """What sticks for a whole pose is no constant, and does not average out within it."""
    rng = np.random.default_rng(3)
    q, tau = recorded(arm, 10, 3, 0.0)
    tau += 0.5 * rng.normal(size=tau.shape)
    rows = np.repeat(np.arange(10), 25)
    many = q[rows] + 1e-5 * rng.normal(size=(250, 2)), tau[rows]
    for learner in (StaticRegressor("2r"), EquivariantTrigonometric()):
        once = learner.fit(q, tau)
        answer, error = once.predict(FAR), once.standard_error(FAR)
        often = learner.fit(*many)
        assert not often.offsets_.any()
        np.testing.assert_allclose(often.predict(FAR), answer, atol=1e-2)
        np.testing.assert_allclose(often.standard_error(FAR), error, rtol=1e-2)


def test_weights_count_as_rows_do(arm):
    q, tau = recorded(arm, 12, 5, 0.3)
    cable = np.array([0.0, 3.0])
    weight = np.random.default_rng(0).integers(1, 4, 12)
    rows = np.repeat(np.arange(12), weight)
    for learner in learners(arm):
        weighed = learner.fit(q, tau + cable, sample_weight=weight).predict(FAR)
        repeated = learner.fit(q[rows], tau[rows] + cable).predict(FAR)
        np.testing.assert_allclose(weighed, repeated, atol=1e-9)


KINDS = ("offset", "gain", "sign", "spring", "cable", "friction")


def contaminated(arm, kind, joint, seed, poses=40, noise=0.02):
    """Rows with one thing wrong, what a sensor would show at other poses, and directions."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, arm.n))
    sides, one = rng.choice([-1.0, 1.0], q.shape), np.eye(arm.n)[joint]

    def measured(q, sides=0.0):
        tau = arm.torque(q)
        if kind in ("gain", "sign"):
            return tau * (1.0 + (0.2 if kind == "gain" else -2.0) * one)
        added = {
            "offset": 0.5,
            "spring": 0.4 * q + 0.1,
            "cable": 0.5 * np.sin(2.0 * q + 0.4),
            "friction": 0.3 * sides,
        }
        return tau + added[kind] * one

    return q, measured(q, sides) + noise * rng.normal(size=q.shape), sides, measured


@pytest.mark.parametrize("robot", ["2r", "ur5", "panda"])
@pytest.mark.parametrize("kind", KINDS)
def test_causes_are_named_and_predicted_but_friction(robot, kind):
    arm = GravityModel(load_robot(robot))
    q, tau, sides, measured = contaminated(arm, kind, 1, 4)
    learner = StaticRegressor(robot).fit(q, tau, directions=sides)
    (cause,) = learner.causes_
    assert str(cause.kind) == kind
    assert (cause.kind, 1) in cause.rivals  # of coupled joints ratios of gains are known
    far = np.random.default_rng(5).uniform(-2.0, 2.0, (300, arm.n))
    assert np.sqrt(np.mean((learner.predict(far) - measured(far)) ** 2)) < 0.02
    copy = StaticRegressor.from_arrays(learner.to_arrays(), learner.parameters())
    np.testing.assert_array_equal(copy.predict(far), learner.predict(far))
    assert [c.as_json() for c in copy.causes_] == [c.as_json() for c in learner.causes_]


def test_the_model_is_of_the_arm_before_its_payload_changed(arm):
    q, tau = recorded(arm, 40, 6, 0.02)
    heavier = tau.copy()
    heavier[23:] += 0.3 * 9.81 * np.cos(q[23:].sum(axis=1))[:, None] * [1.0, 1.0]
    learner = StaticRegressor("2r").fit(q, heavier)
    assert [(str(c.kind), c.since) for c in learner.causes_] == [("payload", 23)]
    assert np.sqrt(np.mean((learner.predict(FAR) - arm.torque(FAR)) ** 2)) < 0.02


@pytest.mark.parametrize("robot", ["2r", "ur5"])
def test_errors_of_angles_are_no_constants(robot):
    """Steep torques spread: without the slopes a constant was named in one of six of these."""
    arm = GravityModel(load_robot(robot))
    named = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-2.0, 2.0, (25, arm.n))
        tau = arm.torque(q) + 0.005 * rng.normal(size=q.shape)
        noisy = q + np.deg2rad(0.3) * rng.normal(size=q.shape)
        named += bool(StaticRegressor(robot).fit(noisy, tau).causes_)
    assert named <= 2


def test_standard_errors_cover_with_causes():
    arm = GravityModel(load_robot("2r"))
    inside = []
    for seed in range(30):
        q, tau, sides, measured = contaminated(arm, "spring", 1, seed)
        learner = StaticRegressor("2r").fit(q, tau, directions=sides)
        far = np.random.default_rng(seed).uniform(-2.0, 2.0, (100, 2))
        error = np.abs(learner.predict(far) - measured(far))
        inside.append(np.mean(error <= 1.645 * learner.standard_error(far)))
    assert 0.82 < np.mean(inside) < 0.97


def test_directions_that_do_not_fit_are_refused(arm):
    q, tau = recorded(arm, 10, 0, 0.0)
    with pytest.raises(InputError, match="a sign for every angle"):
        StaticRegressor("2r").fit(q, tau, directions=np.ones((9, 2)))
