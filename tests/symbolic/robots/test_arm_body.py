"""Bodies out of and into Pinocchio models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.urdf.urdf_file import urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import urdfs

ARRAYS = (
    "rotations",
    "translations",
    "axes",
    "masses",
    "levers",
    "inertias",
    "limits",
    "efforts",
    "velocities",
    "damping",
    "friction",
    "armature",
    "gravity",
)


def two_joints(second=None) -> pin.Model:
    model = pin.Model()
    placement = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5]))
    first = model.addJoint(0, pin.JointModelRY(), placement, "first")
    model.appendBodyToJoint(first, pin.Inertia.FromSphere(2.0, 0.1), placement)
    joint = model.addJoint(first, second or pin.JointModelRZ(), placement, "second")
    model.appendBodyToJoint(joint, pin.Inertia.FromSphere(1.0, 0.1), placement)
    return model


@given(urdfs(), st.floats(0.0, 0.1))
def test_a_body_survives_the_way_through_a_model_bit_for_bit(urdf, armature):
    body = ArmBody.from_model(pin.buildModelFromXML(urdf_text(urdf)), "arm")
    body = replace(body, armature=np.full(body.n, armature), gravity=np.array([1.0, 2.0, 3.0]))
    model = body.to_model("arm")
    assert (model.nq, model.nv) == (body.n, body.n)
    again = ArmBody.from_model(model, "again")
    assert (again.joint_names, again.parents) == (body.joint_names, body.parents)
    for field in ARRAYS:
        np.testing.assert_array_equal(getattr(again, field), getattr(body, field), err_msg=field)
    assert again.digest() == body.digest()


@given(urdfs(), st.integers(0, 2**32))
def test_the_rebuilt_model_moves_and_weighs_the_same(urdf, seed):
    source = pin.buildModelFromXML(urdf_text(urdf))
    model = ArmBody.from_model(source, "arm").to_model("arm")
    rng = np.random.default_rng(seed)
    q, v, a = rng.uniform(-np.pi, np.pi, (3, model.nv))
    source_q = pin.integrate(source, pin.neutral(source), q)
    theirs = pin.rnea(source, source.createData(), source_q, v, a)
    np.testing.assert_allclose(pin.rnea(model, model.createData(), q, v, a), theirs, atol=1e-10)


@pytest.mark.parametrize(
    ("joint", "name"),
    [
        (pin.JointModelFreeFlyer(), "FreeFlyer"),
        (pin.JointModelPX(), "PX"),
        (pin.JointModelPrismaticUnaligned(np.array([0.0, 0.6, 0.8])), "PrismaticUnaligned"),
        (pin.JointModelPlanar(), "Planar"),
        (pin.JointModelSpherical(), "Spherical"),
        (pin.JointModelSphericalZYX(), "SphericalZYX"),
        (pin.JointModelTranslation(), "Translation"),
        (pin.JointModelHX(0.1), "HX"),
    ],
)
def test_joints_that_are_not_revolute_are_refused_by_name(joint, name):
    with pytest.raises(InputError, match=f"arm: type of joint 'second' is {name}"):
        ArmBody.from_model(two_joints(joint), "arm")


def test_mimic_and_composite_joints_are_refused_by_name():
    mimic = pin.transformJointIntoMimic(two_joints(), 1, 2, 1.0, 0.0)
    with pytest.raises(InputError, match="type of joint 'second' is Mimic"):
        ArmBody.from_model(mimic, "arm")
    composite = pin.JointModelComposite()
    composite.addJoint(pin.JointModelRX(), pin.SE3.Identity())
    with pytest.raises(InputError, match="type of joint 'second' is Composite"):
        ArmBody.from_model(two_joints(composite), "arm")


def test_a_model_without_joints_is_refused():
    with pytest.raises(InputError, match="number of moving joints is 0"):
        ArmBody.from_model(pin.Model(), "arm")


def test_joints_without_limits_have_infinite_ones():
    body = ArmBody.from_model(two_joints(pin.JointModelRUBZ()), "arm")
    np.testing.assert_array_equal(body.limits, [[-np.inf, np.inf]] * 2)


@given(urdfs(), st.integers(0, 2**32))
def test_the_digest_sees_every_number_but_not_the_last_digits(urdf, seed):
    body = ArmBody.from_model(pin.buildModelFromXML(urdf_text(urdf)), "arm")
    rng = np.random.default_rng(seed)
    unseen = ("efforts", "velocities", "friction", "armature")
    field = rng.choice([name for name in ARRAYS if name not in unseen])
    changed = getattr(body, str(field)).copy()
    entry = rng.integers(changed.size)
    changed.flat[entry] = np.nan_to_num(changed.flat[entry], posinf=9.0, neginf=-9.0) + 1e-6
    assert replace(body, **{str(field): changed}).digest() != body.digest()
    assert replace(body, joint_names=(*body.joint_names[:-1], "other")).digest() != body.digest()


def test_the_digest_does_not_see_rounding():
    body = ArmBody.from_model(two_joints(), "arm")
    nudged = replace(body, translations=body.translations * (1 + 2e-16), levers=-0.0 + body.levers)
    assert nudged.digest() == body.digest()
