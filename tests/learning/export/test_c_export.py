import numpy as np
import pytest

from isotorque.learning.export.c_export import c_source
from isotorque.learning.export.forms.waves import Waves
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.export.compiled_source import build, call, needs_cc, needs_nm, symbols
from tests.learning.export.fitted_models import MAKERS, QUICK, far_queries, fitted_learner, samples


def largest_error(form, learner, folder):
    """Of compiled C against ``predict``, relative to the largest torque."""
    q = far_queries(learner.n_features_in_)
    expected = learner.predict(q)
    _, library = build(c_source(form), folder)
    return np.abs(call(library, q) - expected).max() / np.abs(expected).max()


@needs_cc
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("name", MAKERS)
def test_compiled_c_equals_predict(name, symmetric, tmp_path):
    learner = fitted_learner(name, "2r", symmetric)
    assert largest_error(torque_form(learner), learner, tmp_path) < 1e-12


@needs_cc
@pytest.mark.parametrize("name", ["recursive-least-squares", "averaged", "canonical", "parametric"])
def test_compiled_c_equals_predict_on_three_joints(name, tmp_path):
    learner = fitted_learner(name, "3r")
    assert largest_error(torque_form(learner), learner, tmp_path) < 1e-12


@needs_cc
@pytest.mark.parametrize("robot", ["ur5", "panda"])
def test_large_arms(robot, tmp_path):
    """The processes have joints whose mean is waves, and others."""
    q, torque = samples(robot, 150)
    few = slice(8 if robot == "ur5" else 60)
    group = primary_symmetries(GravityModel(load_robot(robot)).potential)
    for i, learner in enumerate(
        [
            StaticRegressor(robot).fit(q, torque),
            FeedForwardNetwork(6, group=group, **QUICK).fit(q, torque),
            EquivariantTrigonometric(group=group).fit(q, torque),
            SymmetricGaussianProcess(group=group).fit(q[few], torque[few]),
            SymmetricGaussianProcess(None, group=group).fit(q[few], torque[few]),
        ]
    ):
        folder = tmp_path / str(i)
        folder.mkdir()
        assert largest_error(torque_form(learner), learner, folder) < 1e-12


@needs_cc
@pytest.mark.parametrize("name", ["local-linear-map", "recursive-least-squares"])
def test_out_of_reach_of_all_prototypes(name, tmp_path):
    learner = MAKERS[name]("2r", None)
    learner.set_params(radius=0.02)
    learner.fit(np.array([[0.1, 0.2], [0.15, 0.25], [3.0, 2.9]]), np.eye(3)[:, :2] + 1.0)
    assert largest_error(torque_form(learner), learner, tmp_path) < 1e-12


@needs_cc
@pytest.mark.parametrize("name", ["local-linear-map-it", "averaged", "canonical", "trigonometric"])
def test_torques_may_overwrite_the_configuration(name, tmp_path):
    learner = fitted_learner(name)
    _, library = build(c_source(torque_form(learner)), tmp_path)
    q = far_queries(2)
    np.testing.assert_array_equal(call(library, q, in_place=True), call(library, q))


@needs_cc
@needs_nm
@pytest.mark.parametrize("name", MAKERS)
def test_one_symbol_is_visible_and_only_functions_of_math_h_are_wanted(name, tmp_path):
    thing, _ = build(c_source(torque_form(fitted_learner(name))), tmp_path)
    defined, undefined = symbols(thing)
    assert defined == {"isotorque_gravity"}
    assert undefined <= {"cos", "sin", "sincos", "exp", "tanh", "floor"}


@needs_cc
def test_no_waves_are_no_torque(tmp_path):
    nothing = Waves(np.zeros((0, 2), dtype=int), np.zeros((0, 2)), np.zeros((0, 2)))
    _, library = build(c_source(nothing), tmp_path)
    np.testing.assert_array_equal(call(library, np.ones((1, 2))), np.zeros((1, 2)))


@needs_cc
def test_names_cannot_break_the_comment(tmp_path):
    form = torque_form(fitted_learner("trigonometric"))
    build(c_source(form, ["*/ int leak; /*", "a\\"], ["*/", "j\nk"]), tmp_path)


def test_as_many_torques_as_joints_are_wanted():
    q = np.random.default_rng(0).uniform(-3, 3, (20, 2))
    learner = FeedForwardNetwork(3, **QUICK).fit(q, np.cos(q[:, :1]))
    with pytest.raises(InputError, match="torques per sample"):
        c_source(torque_form(learner))
