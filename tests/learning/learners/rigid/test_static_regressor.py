"""Tests of parametric identification against Pinocchio's gravity and other inertias."""

import json

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def gravity_of(model, q):
    data = model.createData()
    return np.array([pin.computeGeneralizedGravity(model, data, x) for x in q])


@settings(max_examples=20)
@given(robot=st.sampled_from(("2r", "3r", "ur5", "panda")), seed=st.integers(0, 2**32 - 1))
def test_finds_inertias_that_are_not_those_of_the_file(robot, seed):
    """Random masses and centres on the same kinematics, from five samples."""
    rng = np.random.default_rng(seed)
    known = load_robot(robot)
    model = known.model.copy()
    for body in model.inertias:
        body.mass = rng.uniform(0.1, 5.0)
        body.lever = rng.uniform(-0.3, 0.3, 3)
    q = rng.uniform(-np.pi, np.pi, (5, known.n))
    dense = rng.uniform(-np.pi, np.pi, (50, known.n))
    learner = StaticRegressor(known).fit(q, gravity_of(model, q))
    scale = np.abs(gravity_of(model, dense)).max()
    assert np.abs(learner.predict(dense) - gravity_of(model, dense)).max() < 1e-7 * scale


@pytest.mark.parametrize("robot", ["2r", "3r", "ur5", "panda"])
def test_two_samples_do_for_the_arms_of_the_toolkit(robot):
    gravity = GravityModel(load_robot(robot))
    rng = np.random.default_rng(0)
    q, dense = rng.uniform(-np.pi, np.pi, (2, gravity.n)), rng.uniform(-3, 3, (500, gravity.n))
    learner = StaticRegressor(robot).fit(q, gravity.torque(q))
    assert np.abs(learner.predict(dense) - gravity.torque(dense)).max() < 1e-9


def test_symmetric_copies_settle_what_one_sample_leaves_open():
    gravity = GravityModel(load_robot("2r"))
    group = primary_symmetries(gravity.potential)
    q = np.array([[0.4, -1.1]])
    dense = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, 2))
    errors = [
        np.abs(
            StaticRegressor("2r", group=g).fit(q, gravity.torque(q)).predict(dense)
            - gravity.torque(dense)
        ).max()
        for g in (None, group)
    ]
    assert errors[1] < 1e-9 < errors[0]


def test_weights_ridge_and_saving():
    gravity = GravityModel(load_robot("3r"))
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (8, 3))
    torque = gravity.torque(q)
    spoilt = torque.copy()
    spoilt[0] += 100.0
    weights = np.append(0.0, np.ones(7))
    learner = StaticRegressor("3r").fit(q, spoilt, weights)
    assert np.abs(learner.predict(q) - torque).max() < 1e-9
    saved = json.loads(json.dumps(learner.parameters()))
    again = StaticRegressor.from_arrays(learner.to_arrays(), saved)
    assert np.array_equal(again.predict(q), learner.predict(q))
    shrunk = StaticRegressor("3r", ridge=1.0).fit(q, torque)
    plain = StaticRegressor("3r").fit(q, torque)
    assert np.linalg.norm(shrunk.parameters_) < np.linalg.norm(plain.parameters_)
    with pytest.raises(InputError, match="name or file"):
        StaticRegressor(load_robot("3r")).fit(q, torque).to_arrays()


def test_refuses_what_does_not_fit():
    with pytest.raises(InputError, match="robot"):
        StaticRegressor().fit([[0.0, 0.0]], [[1.0, 2.0]])
    with pytest.raises(InputError, match="number of columns is 3; accepted: 2"):
        StaticRegressor("2r").fit([[0.0, 0.0, 0.0]], [[1.0, 2.0, 3.0]])
    with pytest.raises(InputError, match="ridge"):
        StaticRegressor("2r", ridge=np.inf).fit([[0.0, 0.0]], [[1.0, 2.0]])
    with pytest.raises(InputError, match="NaN"):
        StaticRegressor("2r").fit([[0.0, np.nan]], [[1.0, 2.0]])
