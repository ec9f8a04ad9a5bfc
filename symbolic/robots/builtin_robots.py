"""The robots that are known by name."""

from __future__ import annotations

from importlib.resources import files
from typing import NamedTuple

from isotorque.symbolic.robots.urdf.urdf_file import parse_urdf

BUILT_IN = {
    "2r": "the paper's planar arm: two uniform rods of 5 kg, 0.25 m, gravity in the plane",
    "3r": "the paper's simplified human arm: 5 kg in the hand, 0.25 m links",
    "pendulum": "one uniform rod of 5 kg, 0.25 m on a horizontal axis",
    "4r-planar": "four uniform rods of 2 kg, 0.25 m with parallel horizontal axes",
    "ur5": "Universal Robots UR5, idealised inertias of ROS's ur_description",
    "panda": "Franka Emika Panda without hand, inertias identified by Gaz et al. 2019",
}
"""Name and description of each built-in robot."""


class BuiltinRobot(NamedTuple):
    """A robot that `load_robot` knows by name: name, number of joints, description."""

    name: str
    joints: int
    description: str


def builtin_robots() -> tuple[BuiltinRobot, ...]:
    """Return name, number of joints and description of each built-in robot.

    Examples
    --------
    >>> for robot in builtin_robots():
    ...     print(robot.name, robot.joints)
    2r 2
    3r 3
    pendulum 1
    4r-planar 4
    ur5 6
    panda 7
    """
    return tuple(
        BuiltinRobot(name, _moving_joints(name), description)
        for name, description in BUILT_IN.items()
    )


def builtin_file(name: str) -> bytes:
    """Return the contents of the URDF file of a built-in robot.

    Examples
    --------
    >>> builtin_file("2r")[:5]
    b'<?xml'
    """
    return files("isotorque.symbolic").joinpath("robot_files", f"{name}.urdf").read_bytes()


def _moving_joints(name: str) -> int:
    return sum(joint.moves for joint in parse_urdf(builtin_file(name), name).joints)
