"""Arms to measure on: the built-in ones and, where installed, some of example-robot-data."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from xml.etree.ElementTree import SubElement, tostring

from defusedxml import ElementTree

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import Robot, load_robot

EXAMPLE_ROBOTS = {
    "z1": "z1_description/urdf/z1.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "talos_left_arm": "talos_data/robots/talos_left_arm.urdf",
}


@dataclass(frozen=True)
class Subject:
    """An arm to derive: the robot, and its URDF file with the origins that adam insists on."""

    name: str
    robot: Robot
    urdf: Path


def subjects(names: list[str], folder: Path) -> list[Subject]:
    """Return the arms asked for, all by default; writes URDF files to ``folder``.

    Raises
    ------
    InputError
        For a name that no arm has here.
    """
    built_in = Path(str(files("isotorque.symbolic"))) / "robot_files"
    places = {arm.name: built_in / f"{arm.name}.urdf" for arm in builtin_robots()}
    installed = example_robots()
    if installed is not None:
        places |= {name: installed / path for name, path in EXAMPLE_ROBOTS.items()}
    places = {name: path for name, path in places.items() if path.is_file()}
    for name in names:
        if name not in places:
            raise InputError("command line", "robots", name, ", ".join(places))
    found = []
    for name, path in places.items():
        if not names or name in names:
            explicit = folder / f"{name}.urdf"
            explicit.write_text(with_origins(path.read_text()))
            found.append(Subject(name, load_robot(path), explicit))
    return found


def with_origins(urdf: str) -> str:
    """Write out the origins that URDF lets one leave out; leave out all but links and joints."""
    root = ElementTree.fromstring(urdf)
    for element in list(root):
        if element.tag not in ("link", "joint"):
            root.remove(element)
    for element in (*root.iter("joint"), *root.iter("inertial")):
        if element.tag == "inertial" or element.find("parent") is not None:
            origin = element.find("origin")
            if origin is None:
                origin = SubElement(element, "origin")
            for field in ("xyz", "rpy"):
                origin.set(field, origin.get(field, "0 0 0"))
    return tostring(root, encoding="unicode")


def example_robots() -> Path | None:
    for entry in sys.path:
        folder = Path(entry) / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    return None
