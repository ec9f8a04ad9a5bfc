"""Masses that are missing or cannot be meant are named; a robot that weighs nothing is refused."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.robots.mass_plausibility import feels_gravity
from isotorque.symbolic.robots.urdf.urdf_elements import UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf, parse_urdf, urdf_text
from tests.symbolic.robots.test_robot_selection import arm, finger, text
from tests.symbolic.robots.urdf.urdf_strategies import urdfs


def without(urdf: Urdf, *names: str, **changes) -> Urdf:
    """Links that weigh nothing, or are changed in another way."""
    return replace(
        urdf,
        links=tuple(
            (replace(link, **changes) if changes else UrdfLink(link.name))
            if link.name in names
            else link
            for link in urdf.links
        ),
    )


def loaded(tmp_path, urdf: Urdf, **options):
    path = tmp_path / "arm.urdf"
    path.write_text(urdf_text(urdf))
    return load_robot(path, **options)


@given(urdfs(), st.integers(0, 2**32))
def test_gravity_is_felt_where_any_torque_is_not_zero(urdf, seed):
    body = ArmBody.from_model(pin.buildModelFromXML(urdf_text(urdf)), "arm")
    model = body.to_model("arm")
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (3, body.n))
    data = model.createData()
    largest = max(np.abs(pin.computeGeneralizedGravity(model, data, x)).max() for x in q)
    if largest > 1e-9:
        assert feels_gravity(body)
    if not feels_gravity(body):
        assert largest < 1e-9


def test_a_robot_without_masses_is_refused_and_its_links_are_named(tmp_path):
    urdf = without(arm(), "upper", "hand")
    with pytest.raises(InputError) as caught:
        loaded(tmp_path, urdf)
    message = str(caught.value)
    assert "mass of moving links 'upper', 'hand' is 0, and no joint feels gravity" in message
    assert "--allow-massless" in message
    assert "\n" not in message
    robot = loaded(tmp_path, urdf, allow_massless=True)
    (warning,) = robot.warnings
    assert "no joint feels gravity: no mass in 'upper', 'hand' (--allow-massless)" in warning
    assert loaded(tmp_path, urdf, payload="1@hand").n == 2


def test_a_model_without_masses_is_refused(tmp_path):
    model = pin.buildModelFromXML(urdf_text(without(arm(), "upper", "hand")))
    with pytest.raises(InputError, match=r"links 'body of j1', 'body of j2' is 0"):
        load_robot(model)


def test_one_link_without_mass_is_named_and_no_more(tmp_path):
    (warning,) = loaded(tmp_path, without(arm(), "hand")).warnings
    assert warning.endswith("no mass in 'hand', which move")
    assert loaded(tmp_path, arm()).warnings == ()


def test_masses_that_would_change_nothing_are_not_asked_for(tmp_path):
    """Joints about the vertical feel no gravity, whatever they carry."""
    upright = replace(
        without(arm(), "hand"),
        joints=tuple(replace(j, axis=(0.0, 0.0, 1.0)) for j in arm().joints),
    )
    assert "no mass in 'hand'" in loaded(tmp_path, upright).warnings[0]
    assert "no joint feels gravity" in loaded(tmp_path, arm(), gravity=(0, 0, 0)).warnings[0]


def test_a_frame_is_no_link_without_mass_but_a_thing_is(tmp_path):
    frame = urdf_text(arm(replace(finger("mount", kind="fixed"))))
    frame = re.sub(r'(<link name="mount_link">).*?(</link>)', r"\1\2", frame)
    path = tmp_path / "arm.urdf"
    path.write_text(frame)
    assert load_robot(path).warnings == ()
    path.write_text(frame.replace('<link name="mount_link">', '<link name="mount_link"><visual/>'))
    assert load_robot(path).warnings[0].endswith("no mass in 'mount_link', which move")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"xyz": (198e3, 0.0, 0.0)}, "centre of mass (origin xyz) of link 'hand' is 1.98e+05 m"),
        ({"xyz": (50.0, 0.0, 0.0)}, "centre of mass (origin xyz) of link 'hand' is 50 m"),
        ({"mass": 2001.0}, "mass of link 'hand' is 2e+03 kg, of all others 2 kg"),
        ({"mass": 500.0}, "mass of all moving links is 502 kg, of 'hand' 500 kg"),
        ({"products": (-1.0, 0, 0, 1.0, 0, 1.0)}, "inertia of link 'hand' is negative"),
        ({"products": (0.01, 0.5, 0, 0.01, 0, 0.01)}, "inertia of link 'hand' is negative"),
    ],
)
def test_what_cannot_be_meant_is_said_with_link_and_attribute(tmp_path, changes, said):
    warnings = loaded(tmp_path, without(arm(), "hand", **changes)).warnings
    assert any(said in warning for warning in warnings), warnings


def test_all_masses_too_small_are_said(tmp_path):
    light = replace(arm(), links=tuple(replace(x, mass=x.mass * 1e-6) for x in arm().links))
    assert any("tonnes?" in warning for warning in loaded(tmp_path, light).warnings)


def test_built_in_robots_are_meant_as_they_are():
    for robot in builtin_robots():
        assert load_robot(robot.name).warnings == ()


def test_the_payload_of_a_file_with_locked_joints_weighs(tmp_path):
    urdf = without(arm(finger("grip")), "upper", "hand", "grip_link")
    path = tmp_path / "arm.urdf"
    path.write_text(text(urdf))
    with pytest.raises(InputError, match="'upper', 'hand'"):
        load_robot(path, lock=["grip"])
    assert parse_urdf(path.read_bytes(), "a").joints[-1].kind == "prismatic"
