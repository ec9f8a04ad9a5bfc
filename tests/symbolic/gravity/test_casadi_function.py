import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.casadi_function import gravity_casadi
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import expanded_program, recursion_program
from isotorque.symbolic.robots.kinematic_tree import planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees


@given(kinematic_trees(max_joints=5), st.data())
@settings(max_examples=40)
def test_function_equals_the_model_in_both_forms(tree, data):
    q = data.draw(configurations(tree.n))
    gravity = GravityModel(tree)
    scale = max(gravity.potential.gradient_bound().max(initial=0.0), 1e-3)
    expanded = expanded_program(gravity.significant_potential)
    for program in (None, expanded, recursion_program(gravity.chain)):
        torque = np.array(gravity_casadi(gravity, program)(q)).ravel()
        np.testing.assert_allclose(torque, gravity.torque(q), rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("name", ["2r", "ur5", "panda"])
def test_jacobian_is_the_stiffness(name):
    gravity = GravityModel(load_robot(name))
    function = gravity_casadi(gravity, name="g")
    assert (function.name(), function.name_in(), function.name_out()) == ("g", ["q"], ["tau"])
    q = np.random.default_rng(0).normal(size=gravity.n)
    stiffness = np.array(function.jacobian()(q, casadi.DM(gravity.n, 1)))
    np.testing.assert_allclose(stiffness, gravity.stiffness(q), atol=1e-11)


def test_function_survives_saving(tmp_path):
    gravity = GravityModel(load_robot("3r"))
    path = tmp_path / "gravity.casadi"
    gravity_casadi(gravity).save(str(path))
    q = [0.1, 0.2, 0.3]
    loaded = np.array(casadi.Function.load(str(path))(q)).ravel()
    np.testing.assert_allclose(loaded, gravity.torque(q), atol=1e-13)


def test_symbols_are_refused():
    with pytest.raises(InputError, match="substitute the symbols"):
        gravity_casadi(GravityModel(planar_arm(2)))
