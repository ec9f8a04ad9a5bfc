import numpy as np
import pinocchio as pin
import pytest

from symbolic.gravity import GravityModel
from symbolic.robots import load_robot


@pytest.mark.parametrize("name", ["2r", "3r", "pendulum", "4r-planar"])
def test_built_in_robots_agree_with_pinocchio(name):
    robot = load_robot(name)
    gravity = GravityModel(robot)
    data = robot.model.createData()
    for q in np.random.default_rng(1).uniform(-4, 4, (20, robot.n)):
        expected = pin.computeGeneralizedGravity(robot.model, data, q)
        np.testing.assert_allclose(gravity.torque(q), expected, atol=1e-12)
        expected = pin.computeGeneralizedGravityDerivatives(robot.model, data, q)
        np.testing.assert_allclose(gravity.stiffness(q), expected, atol=1e-12)
