"""Reading URDF files: what is read, and what is refused in one clear line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.urdf.urdf_file import parse_urdf, urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import urdfs

LINK = """<link name="{name}"><inertial><origin xyz="0.1 0 0"/><mass value="{mass}"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>"""
JOINT = """<joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
    <dynamics damping="0.5" friction="0.1"/></joint>"""
ARM = f"""<robot name="arm">{LINK.format(name="base", mass=1)}{LINK.format(name="arm", mass=2)}
    {JOINT}</robot>"""


def edited(old: str, new: str) -> str:
    assert old in ARM, old
    return ARM.replace(old, new, 1)


@given(urdfs())
def test_a_description_written_and_read_again_is_the_same(urdf):
    again = parse_urdf(urdf_text(urdf).encode(), "again")
    assert again.links == urdf.links
    assert again.root == urdf.root
    assert [joint.name for joint in again.joints] == [joint.name for joint in urdf.joints]
    for mine, theirs in zip(again.joints, urdf.joints, strict=True):
        if theirs.kind == "revolute":
            assert mine == theirs


def test_pinocchio_reads_from_our_text_what_it_reads_from_the_file():
    path = Path(__file__).parents[4] / "symbolic" / "robot_files" / "panda.urdf"
    mine = pin.buildModelFromXML(urdf_text(parse_urdf(path.read_bytes(), "panda")))
    theirs = pin.buildModelFromUrdf(str(path))
    assert list(mine.names) == list(theirs.names)
    assert list(mine.inertias) == list(theirs.inertias)
    assert list(mine.jointPlacements) == list(theirs.jointPlacements)
    np.testing.assert_array_equal(mine.lowerPositionLimit, theirs.lowerPositionLimit)
    np.testing.assert_array_equal(mine.upperPositionLimit, theirs.upperPositionLimit)


def test_what_has_no_bearing_on_gravity_is_left_out():
    extra = """<gazebo reference="arm"/><transmission name="t"><joint name="elbow"/></transmission>
        <material name="grey"/></robot>"""
    assert parse_urdf(ARM.replace("</robot>", extra).encode(), "a") == parse_urdf(ARM.encode(), "a")


READ = {
    "default namespace": edited("<robot ", '<robot xmlns="http://www.ros.org" '),
    "undeclared prefix": edited("</robot>", "<gazebo><sensor:camera name='c'/></gazebo></robot>"),
    "undeclared prefix of an attribute": edited("<robot ", '<robot x:y="z" '),
    "effort and velocity -1": edited('effort="1" velocity="1"', 'effort="-1" velocity="-1"'),
    "numbers with spaces": edited('xyz="0 0 1" rpy="0 0 0"', 'xyz=" 0  0 1.0 " rpy="0 0\t0\n"'),
}


@pytest.mark.parametrize("case", READ)
def test_what_files_in_use_contain_is_read(case):
    urdf = parse_urdf(READ[case].encode(), "some.urdf")
    usual = parse_urdf(ARM.encode(), "some.urdf")
    assert urdf.links == usual.links
    assert pin.buildModelFromXML(urdf_text(urdf)).nq == 1
    (joint,) = urdf.joints
    assert joint.xyz == usual.joints[0].xyz


def test_a_mass_without_tensor_and_limits_without_room_are_read():
    tensor = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
    urdf = parse_urdf(ARM.replace(tensor, "").encode(), "a")
    assert [(link.mass, any(link.products)) for link in urdf.links] == [(1.0, False), (2.0, False)]
    joint = parse_urdf(ARM.replace('lower="-1"', 'lower="3"').encode(), "a").joints[0]
    assert (joint.lower, joint.upper) == (3.0, 1.0)


def test_a_fixed_joint_that_mimics_is_just_fixed():
    text = ARM.replace("</robot>", LINK.format(name="tip", mass=1)) + (
        '<joint name="tip_joint" type="fixed"><parent link="arm"/><child link="tip"/>'
        '<mimic joint="elbow"/></joint></robot>'
    )
    assert [joint.kind for joint in parse_urdf(text.encode(), "a").joints] == ["revolute", "fixed"]


REFUSED = {
    "not XML": ("hello", "not XML"),
    "empty": ("", "not XML"),
    "truncated": (ARM[:-20], "not XML"),
    "MJCF": ("<mujoco><worldbody/></mujoco>", "MJCF"),
    "another format": ("<sdf/>", "<sdf>"),
    "xacro": (
        ARM.replace('name="arm">', 'name="arm" xmlns:xacro="http://x/xacro"><xacro:arm/>', 1),
        "expanded by xacro",
    ),
    "entity": ('<!DOCTYPE r [<!ENTITY a "b">]>' + ARM, "without DTD"),
    "entity bomb": (
        '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]><robot>&b;</robot>',
        "without DTD",
    ),
    "external DTD": ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', "without DTD"),
    "negative mass": (edited('<mass value="2"/>', '<mass value="-2"/>'), "mass of link 'arm'"),
    "NaN mass": (edited('<mass value="2"/>', '<mass value="nan"/>'), "mass of link 'arm'"),
    "infinite mass": (edited('<mass value="2"/>', '<mass value="1e999"/>'), "mass of link 'arm'"),
    "mass without value": (edited('<mass value="2"/>', "<mass/>"), "mass of link 'arm' is missing"),
    "no mass": (edited('<mass value="2"/>', ""), "<mass> of inertial of link 'arm' is missing"),
    "infinite inertia": (edited('izz="0.1"', 'izz="inf"'), "izz of link 'base'"),
    "two inertials": (
        edited('<link name="arm">', '<link name="arm"><inertial/>'),
        "number of <inertial> in link 'arm' is 2",
    ),
    "words for numbers": (edited('xyz="0 0 1"', 'xyz="0 0 one"'), "xyz of joint 'elbow'"),
    "unexpanded expression": (edited('rpy="0 0 0"', 'rpy="${pi/2} 0 0"'), "rpy of joint 'elbow'"),
    "Python's numbers": (edited('xyz="0 0 1"', 'xyz="0 0 1_0"'), "xyz of joint 'elbow'"),
    "two numbers": (edited('xyz="0 0 1"', 'xyz="0 1"'), "3 finite numbers"),
    "NaN angle": (edited('rpy="0 0 0"', 'rpy="0 nan 0"'), "rpy of joint 'elbow'"),
    "unknown way to turn": (
        edited('rpy="0 0 0"', 'quat_xyzw="0 0 0 1"'),
        "origin of joint 'elbow' is attribute quat_xyzw",
    ),
    "zero axis": (edited('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>'), "axis of joint 'elbow'"),
    "unknown type": (edited('type="revolute"', 'type="ball"'), "type of joint 'elbow' is ball"),
    "no type": (edited('type="revolute"', ""), "type of joint 'elbow'"),
    "no joint name": (edited('name="elbow" ', ""), "name of a joint"),
    "mimic of nobody": (edited("</joint>", "<mimic/></joint>"), "joint of mimic of joint 'elbow'"),
    "mimic without end": (
        edited("</joint>", '<mimic joint="elbow" multiplier="inf"/></joint>'),
        "multiplier of mimic of joint 'elbow'",
    ),
    "nested xacro": (
        edited('<link name="arm">', '<link name="arm"><xacro:inertia mass="1"/>'),
        "element is xacro:inertia",
    ),
    "no child": (edited('<child link="arm"/>', ""), "<child> of joint 'elbow' is missing"),
    "unknown child": (
        edited('<child link="arm"/>', '<child link="leg"/>'),
        "child of joint 'elbow' is 'leg'",
    ),
    "no limit": (
        edited('<limit lower="-1" upper="1" effort="1" velocity="1"/>', ""),
        "limit of joint 'elbow' is missing",
    ),
    "NaN limit": (edited('lower="-1"', 'lower="nan"'), "lower limit of joint 'elbow'"),
    "negative damping": (edited('damping="0.5"', 'damping="-1"'), "damping of joint 'elbow'"),
    "no moving joint": (edited('type="revolute"', 'type="fixed"'), "number of moving joints is 0"),
    "no joint at all": ('<robot><link name="a"/></robot>', "number of moving joints is 0"),
    "nothing": ("<robot/>", "number of links is 0"),
    "two links of one name": (
        edited("</robot>", '<link name="arm"/></robot>'),
        "name of link is 'arm' (twice)",
    ),
    "two joints of one name": (edited("</robot>", JOINT + "</robot>"), "'elbow' (twice)"),
    "two parents": (
        edited("</robot>", JOINT.replace("elbow", "other") + "</robot>"),
        "child of joint 'other' is 'arm', child of joint 'elbow' too",
    ),
    "two trees": (edited("</robot>", '<link name="lone"/></robot>'), "'base' and 'lone'"),
    "a loop": (
        edited(
            "</robot>",
            JOINT.replace("elbow", "back")
            .replace('parent link="base"', 'parent link="arm"')
            .replace('child link="arm"', 'child link="base"')
            + "</robot>",
        ),
        "a loop",
    ),
    "its own child": (
        edited('<child link="arm"/>', '<child link="base"/>'),
        "parents of link 'base' is a loop",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_in_one_line_that_says_where(case):
    text, expected = REFUSED[case]
    with pytest.raises(InputError) as caught:
        parse_urdf(text.encode(), "some.urdf")
    message = str(caught.value)
    assert message.startswith("some.urdf: ")
    assert expected in message
    assert "accepted: " in message
    assert "\n" not in message


def test_a_loop_beside_a_tree_is_found():
    loop = "".join(
        f"""<link name="{a}"/><joint name="j{a}" type="fixed"><parent link="{b}"/>
        <child link="{a}"/></joint>"""
        for a, b in (("x", "y"), ("y", "z"), ("z", "x"))
    )
    with pytest.raises(InputError, match="parents of link 'x' is a loop"):
        parse_urdf(edited("</robot>", loop + "</robot>").encode(), "some.urdf")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "latin-1"])
def test_names_in_any_script_and_encoding(encoding):
    declared = f'<?xml version="1.0" encoding="{encoding}"?>'
    text = declared + ARM.replace("elbow", "épaule")
    joint = parse_urdf(text.encode(encoding), "a").joints[0]
    assert joint.name == "épaule"


@given(st.floats(-7.0, 7.0), st.floats(-7.0, 7.0))
@example(0.0, 1.5)
@example(-1.5, 0.0)
def test_limits_are_read_as_they_are_unless_both_are_zero(lower, upper):
    text = edited('lower="-1" upper="1"', f'lower="{lower!r}" upper="{upper!r}"')
    joint = parse_urdf(text.encode(), "a").joints[0]
    none = lower == upper == 0.0
    assert (joint.lower, joint.upper) == ((None, None) if none else (lower, upper))


@pytest.mark.parametrize(
    ("limits", "read"),
    [('upper="1.5"', (0.0, 1.5)), ('lower="-1.5"', (-1.5, 0.0)), ('lower="1" upper="0"', (1, 0))],
)
def test_a_limit_that_is_left_out_is_zero_beside_one_that_is_not(limits, read):
    text = edited('lower="-1" upper="1"', limits)
    joint = parse_urdf(text.encode(), "a").joints[0]
    assert (joint.lower, joint.upper) == read


@pytest.mark.parametrize("limits", ["", 'lower="0" upper="0"', 'upper="0.0"'])
def test_limits_that_are_left_out_or_both_zero_are_none(limits):
    text = edited('lower="-1" upper="1"', limits)
    joint = parse_urdf(text.encode(), "a").joints[0]
    assert (joint.lower, joint.upper) == (None, None)
