"""What the sensors of a simulated arm show."""

import numpy as np

from isotorque.learning.arm import Settled
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.two_link_arm import GRAVITY, ROBOT


def test_noise_has_the_size_that_was_asked_for():
    noise = SensorNoise(angle=0.01, torque=0.1)
    arm = SimulatedArm(ROBOT, noise=noise, rng=np.random.default_rng(1))
    target = np.array([-1.3, -0.2])
    outcomes = [arm.apply(GRAVITY(target)) for _ in range(400)]
    angles = np.array([outcome.q - target for outcome in outcomes])
    torques = np.array([outcome.torque - GRAVITY(target) for outcome in outcomes])
    assert np.allclose(angles.std(axis=0), 0.01, rtol=0.15)
    assert np.allclose(torques.std(axis=0), 0.1, rtol=0.15)
    assert np.array_equal(arm.q, outcomes[-1].q)
    assert np.array_equal(arm.q, arm.q)  # reading twice is not measuring twice


def test_encoders_count_steps():
    step = 2 * np.pi / 4096
    arm = SimulatedArm(ROBOT, noise=SensorNoise(encoder_step=step))
    q = arm.apply(GRAVITY(np.array([-1.3, -0.2]))).q
    assert np.allclose(q / step, np.round(q / step), atol=1e-9)
    assert np.abs(q - [-1.3, -0.2]).max() <= step / 2 + 1e-9


def test_free_joints_get_neither_torque_nor_noise():
    robot = load_robot("ur5")
    noise = SensorNoise(torque=0.1, holding_torque=0.1)
    arm = SimulatedArm(robot, "guided", noise=noise, rng=np.random.default_rng(2))
    free = np.abs(arm.equations.stiffness(arm.home)).max(axis=0) < 1e-9
    assert free.tolist() == [True, False, False, False, True, True]
    torque = arm.equations.gravity_torque(arm.home)
    outcome = arm.apply(torque + np.where(free, 5.0, 0.0))
    assert isinstance(outcome, Settled)
    assert not outcome.torque[free].any()
    assert outcome.torque[~free].all()
    assert np.abs(outcome.q - arm.home)[free].max() < 1e-6
    assert not arm.hold().torque[free].any()
    assert arm.release_test(arm.home, torque + np.where(free, 5.0, 0.0), 1e-6).balanced
