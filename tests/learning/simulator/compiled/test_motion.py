"""Motion against outside references: SciPy's integrators, energy, free fall, MuJoCo."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.assembly import assemble
from isotorque.learning.simulator.compiled.chain import CompiledEquations
from isotorque.learning.simulator.compiled.engine import CompiledEngine
from isotorque.learning.simulator.dynamics.engine import Body
from isotorque.learning.simulator.reference.engine import PinocchioEngine
from isotorque.learning.simulator.settings import PhysicsMode, SettleRule
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.random_arms import arm_models

ENGINES = (CompiledEngine, PinocchioEngine)


def free_body(n, damping=0.0, coulomb=0.0):
    """Return a body without limits."""
    return Body(
        damping=np.full(n, damping),
        coulomb=np.full(n, coulomb),
        limits=np.tile([-np.inf, np.inf], (n, 1)),
        anchor=np.zeros((n, n)),
        nudge=np.zeros(n),
        residual=1e-9,
    )


def integrate(model, damping, q, v, torque, seconds):
    """Return the state after some seconds, by SciPy and pin.aba."""
    data, n = model.createData(), model.nv

    def rate(_, state):
        velocity = state[n:]
        forces = torque - damping * velocity
        return np.concatenate([velocity, pin.aba(model, data, state[:n], velocity, forces)])

    end = solve_ivp(rate, (0.0, seconds), np.concatenate([q, v]), "DOP853", rtol=1e-10, atol=1e-10)
    return end.y[:n, -1], end.y[n:, -1]


@pytest.mark.parametrize("engine", ENGINES)
@given(model=arm_models(1, 4), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10)
def test_motion_equals_scipys(engine, model, seed):
    rng = np.random.default_rng(seed)
    n = model.nv
    q, v = rng.uniform(-3, 3, n), rng.normal(size=n)
    torque, damping = rng.normal(size=n), 0.5
    rule = SettleRule(tolerance=1e-5, time_tolerance=1.0)
    motion = engine(model, free_body(n, damping), rule).wait(q, v, torque, 0.5)
    expected_q, expected_v = integrate(model, damping, q, v, torque, 0.5)
    assert motion.seconds == 0.5
    assert np.abs(motion.q - expected_q).max() < 2e-3 * max(1.0, np.abs(expected_q - q).max())
    assert np.abs(motion.v - expected_v).max() < 2e-2 * max(1.0, np.abs(expected_v).max())


@pytest.mark.parametrize("engine", ENGINES)
def test_error_falls_with_the_tolerance(engine):
    """The method is of second order with first-order error control: error ~ tolerance."""
    model = load_robot("2r").model
    q, v, torque = np.array([0.5, 0.3]), np.zeros(2), np.array([1.0, -1.0])
    expected, _ = integrate(model, 2.0, q, v, torque, 1.0)
    errors = []
    for tolerance in (1e-3, 1e-4, 1e-5):
        rule = SettleRule(tolerance=tolerance, time_tolerance=1.0)
        end = engine(model, free_body(2, 2.0), rule).wait(q, v, torque, 1.0)
        errors.append(np.abs(end.q - expected).max())
    assert errors[0] > 4 * errors[1] > 16 * errors[2]
    assert errors[2] < 1e-4


@pytest.mark.parametrize("engine", ENGINES)
@given(model=arm_models(1, 3, armature=False), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10)
def test_energy_is_kept_without_friction_and_lost_with_it(engine, model, seed):
    rng = np.random.default_rng(seed)
    n = model.nv
    q, v, still = rng.uniform(-3, 3, n), rng.normal(size=n), np.zeros(n)
    data = model.createData()

    def energy(q, v):
        kinetic = pin.computeKineticEnergy(model, data, q, v)
        return kinetic + pin.computePotentialEnergy(model, data, q)

    rule = SettleRule(tolerance=1e-6, time_tolerance=1.0)
    kept = engine(model, free_body(n), rule).wait(q, v, still, 0.2)
    size = max(1.0, pin.computeKineticEnergy(model, data, kept.q, kept.v))
    assert abs(energy(kept.q, kept.v) - energy(q, v)) < 1e-2 * size
    damped = engine(model, free_body(n, 0.5), rule)
    before = energy(q, v)
    for _ in range(4):
        motion = damped.wait(q, v, still, 0.05)
        q, v = motion.q, motion.v
        assert energy(q, v) < before
        before = energy(q, v)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_released_rod_falls_with_its_known_acceleration(engine):
    """A uniform rod held level: 3 g / (2 l), whatever its mass."""
    robot = load_robot("2r")
    model = pin.Model()
    rod = robot.model.inertias[2]
    model.gravity = robot.model.gravity
    joint = model.addJoint(0, robot.model.joints[1], pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(joint, rod, pin.SE3.Identity())
    arm = engine(model, free_body(1), SettleRule(tolerance=1e-8))
    zero = np.zeros(1)
    assert np.isclose(arm.acceleration(zero, zero, zero)[0], -3 * 9.81 / (2 * 0.25), rtol=1e-9)
    motion = arm.wait(zero, zero, zero, 0.01)
    assert np.isclose(motion.q[0], -0.5 * 3 * 9.81 / 0.5 * 1e-4, rtol=1e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_arm_without_gravity_coasts(engine):
    model = pin.Model()
    model.gravity.linear = np.zeros(3)
    joint = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "spin")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
    motion = engine(model, free_body(1), SettleRule()).wait(
        np.zeros(1), np.ones(1), np.zeros(1), 2.0
    )
    assert np.isclose(motion.q[0], 2.0)
    assert np.isclose(motion.v[0], 1.0)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sliding_joint_stops_and_sticks(engine):
    """A wheel with Coulomb friction alone: v0^2 I / (2 F), then v = 0 exactly."""
    model = pin.Model()
    model.gravity.linear = np.zeros(3)
    joint = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "wheel")
    model.appendBodyToJoint(
        joint, pin.Inertia(1.0, np.zeros(3), 0.5 * np.eye(3)), pin.SE3.Identity()
    )
    rule = SettleRule(tolerance=1e-6)
    arm = engine(model, free_body(1, coulomb=2.0), rule)
    stopped = arm.wait(np.zeros(1), np.full(1, 3.0), np.zeros(1), 5.0)
    assert stopped.v[0] == 0.0
    assert np.isclose(stopped.q[0], 0.5 * 3.0**2 / (2 * 2.0), rtol=5e-3)
    for torque, sticks in ((1.99, True), (-1.99, True), (2.01, False), (-2.01, False)):
        moved = arm.wait(stopped.q, stopped.v, np.full(1, torque), 1.0)
        assert (moved.q[0] == stopped.q[0]) == sticks
        acceleration = arm.acceleration(stopped.q, stopped.v, np.full(1, torque))[0]
        expected = 0.0 if sticks else np.sign(torque) * 0.01 / 0.5
        assert np.isclose(acceleration, expected, atol=1e-9)


def test_motion_along_a_free_direction_runs_out_as_it_should():
    """With D v alone, momentum M v takes a joint M v / D further: the finish includes that."""
    robot = load_robot("ur5")
    equations = CompiledEquations(robot.model)
    rule = SettleRule(velocity=0.2, acceleration=2.0, dwell=0.0)
    assembly = assemble(robot, equations, PhysicsMode.OPEN_LOOP, None, None, "none", None)
    engine = CompiledEngine(robot.model, assembly.body, rule)
    torque = equations.gravity_torque(assembly.home)
    v = np.array([0.1, 0, 0, 0, 0, 0.0])
    finished = engine.settle(assembly.home, v, torque)
    awaited = engine.wait(assembly.home, v, torque, 60.0)
    assert finished.kind is OutcomeKind.SETTLED
    assert finished.seconds < 0.5
    assert np.abs(finished.q - assembly.home).max() > 1e-3
    assert np.abs(finished.q - awaited.q).max() < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", ["2r", "3r", "ur5"])
def test_outcomes_equal_mujocos(name):
    mujoco = pytest.importorskip("mujoco")
    from benchmarks.peers.mujoco_arm import mujoco_arm

    robot = load_robot(name)
    arm = SimulatedArm(robot)
    rng = np.random.default_rng(2)
    low, high = arm.limits.T
    starts = rng.uniform(low, high, (30, arm.n))
    torques = np.array(
        [arm.equations.gravity_torque(q) for q in rng.uniform(low, high, starts.shape)]
    )
    ends = arm.settle_each(starts, torques)
    model = mujoco_arm(robot.model, arm.damping, timestep=5e-4)
    data = mujoco.MjData(model)
    wrong = 0
    for start, torque, kind, end, seconds in zip(
        starts, torques, ends.kinds, ends.q, ends.seconds, strict=True
    ):
        if kind is OutcomeKind.TIMEOUT:
            continue
        mujoco.mj_resetData(model, data)
        data.qpos[:] = start
        data.qfrc_applied[:] = torque
        hit = False
        while data.time < 1.05 * seconds + 0.2 and not hit:
            mujoco.mj_step(model, data)
            hit = bool(((data.qpos < low) | (data.qpos > high)).any())
        wrong += hit != (kind is OutcomeKind.LIMIT) or np.abs(data.qpos - end).max() > 0.05
    assert wrong == 0


@pytest.mark.slow
def test_sticking_equals_mujocos():
    mujoco = pytest.importorskip("mujoco")
    from benchmarks.peers.mujoco_arm import mujoco_arm

    robot = load_robot("2r")
    arm = SimulatedArm(robot, "geared", coulomb=0.3, limits="none")
    rng = np.random.default_rng(3)
    starts = arm.home + rng.uniform(-0.8, 0.8, (10, 2))
    torques = np.array([arm.equations.gravity_torque(q) for q in arm.home + 0 * starts])
    ends = arm.settle_each(starts, torques)
    coulomb = np.full(2, 0.3)
    model = mujoco_arm(robot.model, arm.damping, coulomb=coulomb, timestep=5e-4)
    model.dof_solimp[:, :2] = 0.9999  # as hard as it gets: MuJoCo's friction creeps
    data = mujoco.MjData(model)
    for start, torque, end in zip(starts, torques, ends.q, strict=True):
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qfrc_applied[:] = start, torque
        while data.time < 4.0:
            mujoco.mj_step(model, data)
        assert np.abs(data.qpos - end).max() < 2e-3
