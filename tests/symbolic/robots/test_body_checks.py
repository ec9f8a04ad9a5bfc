"""Bodies with numbers that no arm has are refused in one line that says where."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.body_checks import check_body
from tests.symbolic.robots.test_arm_body import two_joints


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("masses", np.nan, "masses of joint 'first' is nan"),
        ("masses", -1.0, "mass of joint 'first' is -1.0"),
        ("levers", np.inf, "levers of joint 'first'"),
        ("inertias", np.nan, "inertias of joint 'first'"),
        ("translations", -np.inf, "translations of joint 'first'"),
        ("translations", 1e200, "translations of joint 'first'"),
        ("rotations", 0.5, "placement of joint 'first'"),
        ("damping", -1.0, "damping of joint 'first'"),
        ("gravity", np.nan, "gravity is"),
    ],
)
def test_numbers_that_no_arm_has_are_refused(field, value, message):
    body = ArmBody.from_model(two_joints(), "arm")
    changed = getattr(body, field).copy()
    changed[0] = value
    with pytest.raises(InputError) as caught:
        check_body(replace(body, **{field: changed}), "arm")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mirror_is_no_rotation():
    body = ArmBody.from_model(two_joints(), "arm")
    mirrored = np.array([np.diag([1.0, 1.0, -1.0]), np.eye(3)])
    with pytest.raises(InputError, match="placement of joint 'first'"):
        check_body(replace(body, rotations=mirrored), "arm")


@pytest.mark.parametrize("weight", [1e-300, 7e-300, 1e-20, 9e-13])
def test_arms_too_light_for_floats_are_refused_by_their_mass_in_one_line(weight):
    body = ArmBody.from_model(two_joints(), "arm")
    light = replace(body, masses=body.masses * weight / body.masses.sum())
    with pytest.raises(InputError) as caught:
        check_body(light, "new\nline.urdf")
    said = str(caught.value)
    assert said == (
        f"new\\nline.urdf: mass of all moving links is {weight:.3g} kg; accepted: 0, or at least "
        "1e-12 kg"
    )
    assert said.isprintable()
    check_body(replace(body, masses=body.masses * 2e-12 / body.masses.sum()), "arm")
