"""Constants beside a model are seen where they are, by pose, and never where they are not."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
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
