"""The equations of motion of both engines against Pinocchio, and against physics."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.simulator.compiled.chain import CompiledEquations
from isotorque.learning.simulator.dynamics.chain import Chain
from isotorque.learning.simulator.reference.equations import PinocchioEquations
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.random_arms import arm_models, build_arm

SEEDS = st.integers(0, 2**32 - 1)


def close(ours, theirs):
    """Tell whether two terms agree to 1e-10 of their size (of 1 where they are smaller)."""
    return np.abs(ours - theirs).max() <= 1e-10 * max(1.0, np.abs(theirs).max())


def draw_state(model, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-np.pi, np.pi, model.nq), rng.normal(size=model.nv) * 2.0


@given(arm_models(prismatic=True), SEEDS)
def test_terms_equal_pinocchios(model, seed):
    q, v = draw_state(model, seed)
    data = model.createData()
    ours = CompiledEquations(model)
    assert close(ours.mass_matrix(q), pin.crba(model, data, q))
    assert close(ours.bias(q, v), pin.nonLinearEffects(model, data, q, v))
    assert close(ours.gravity_torque(q), pin.computeGeneralizedGravity(model, data, q))
    gravity_derivatives = pin.computeGeneralizedGravityDerivatives(model, data, q)
    assert close(ours.stiffness(q), gravity_derivatives)


@given(arm_models(), SEEDS)
def test_acceleration_equals_pinocchios(model, seed):
    q, v = draw_state(model, seed)
    torque = np.random.default_rng(seed + 1).normal(size=model.nv)
    ours = CompiledEquations(model)
    acceleration = np.linalg.solve(ours.mass_matrix(q), torque - ours.bias(q, v))
    assert close(acceleration, pin.aba(model, model.createData(), q, v, torque))


@given(arm_models(3, 6, branched=True, depth_first=False), SEEDS)
def test_any_joint_order_will_do(model, seed):
    """Pinocchio's CRBA and gravity derivatives are wrong in other than depth-first order."""
    q, v = draw_state(model, seed)
    data = model.createData()
    ours, reference = CompiledEquations(model), PinocchioEquations(model)
    columns = [pin.rnea(model, data, q, 0 * v, e) for e in np.eye(model.nv)]
    mass = np.array(columns) - pin.computeGeneralizedGravity(model, data, q)
    assert close(ours.mass_matrix(q), mass)
    for name, arguments in (
        ("mass_matrix", (q,)),
        ("bias", (q, v)),
        ("stiffness", (q,)),
        ("gravity_torque", (q,)),
    ):
        assert close(getattr(ours, name)(*arguments), getattr(reference, name)(*arguments))


@given(arm_models(prismatic=True), SEEDS)
def test_stiffness_is_the_symmetric_derivative_of_the_gravity_torque(model, seed):
    q, _ = draw_state(model, seed)
    ours = CompiledEquations(model)
    step = 1e-6
    columns = [
        (ours.gravity_torque(q + step * e) - ours.gravity_torque(q - step * e)) / (2 * step)
        for e in np.eye(model.nv)
    ]
    stiffness = ours.stiffness(q)
    assert np.abs(stiffness - np.array(columns).T).max() < 1e-6 * max(1, np.abs(stiffness).max())
    assert np.array_equal(stiffness, stiffness.T)


@given(arm_models(armature=False), SEEDS)
def test_mass_matrix_is_positive_definite_and_gives_the_kinetic_energy(model, seed):
    q, v = draw_state(model, seed)
    mass = CompiledEquations(model).mass_matrix(q)
    assert np.linalg.eigvalsh(mass)[0] > 0
    energy = pin.computeKineticEnergy(model, model.createData(), q, v)
    assert close(0.5 * v @ mass @ v, energy)


@pytest.mark.parametrize("name", ["2r", "3r", "pendulum", "4r-planar", "ur5", "panda"])
def test_builtin_arms(name):
    model = load_robot(name).model
    q, v = draw_state(model, 7)
    ours, reference = CompiledEquations(model), PinocchioEquations(model)
    assert close(ours.mass_matrix(q), reference.mass_matrix(q))
    assert close(ours.bias(q, v), reference.bias(q, v))
    assert close(ours.stiffness(q), reference.stiffness(q))


def test_2r_terms_by_hand():
    """Two uniform rods of 5 kg and 0.25 m stretched out: figures of the paper's arm."""
    ours = CompiledEquations(load_robot("2r").model)
    m, l, g = 5.0, 0.25, 9.81
    straight = np.zeros(2)
    torque = [m * g * (l / 2 + 3 * l / 2), m * g * l / 2]
    assert np.allclose(ours.gravity_torque(straight), torque, atol=1e-12)
    assert np.isclose(ours.mass_matrix(straight)[1, 1], m * l * l / 3, atol=1e-12)
    assert np.allclose(ours.stiffness(straight), 0.0, atol=1e-12)


def test_terms_do_not_depend_on_what_was_asked_before():
    model = build_arm([0, 1, 1], ["revolute"] * 3, np.random.default_rng(0))
    ours = CompiledEquations(model)
    q, v = draw_state(model, 3)
    before = ours.mass_matrix(q), ours.bias(q, v)
    ours.bias(q + 1.0, v - 1.0)
    assert np.array_equal(before[0], ours.mass_matrix(q))
    assert np.array_equal(before[1], ours.bias(q, v))
    assert before[0][1, 2] == 0.0  # joints on different branches


def test_joints_with_two_coordinates_are_refused():
    model = pin.Model()
    model.name = "wheel"
    model.addJoint(0, pin.JointModelRUBX(), pin.SE3.Identity(), "hub")
    with pytest.raises(InputError, match=r"wheel: type of joint 'hub' is RUBX"):
        Chain.from_model(model)
