"""URDF files: parsed safely and checked to be a tree."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
import xml.sax
from dataclasses import dataclass
from typing import Any

import defusedxml
import defusedxml.sax

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import UNLIMITED
from isotorque.symbolic.robots.urdf.urdf_elements import PRODUCTS, UrdfJoint, UrdfLink, UrdfReader


@dataclass(frozen=True)
class Urdf:
    """A robot description: a tree of links.

    Attributes
    ----------
    name : str
        Name of the robot, empty where the file gives none.
    root : str
        Name of the base link.
    links, joints : tuples
        In the order of the file.
    gravity : tuple of 3 floats
        Gravitational acceleration in the frame of the base link [m/s^2]; URDF has no field for it.
    """

    name: str
    root: str
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)  # Pinocchio's


def parse_urdf(data: bytes, where: str) -> Urdf:
    """Parse and check a URDF file.

    Parameters
    ----------
    data
        Contents of the file.
    where
        What to call the file in an error.

    Returns
    -------
    Urdf
        The kinematics and inertias; what is seen, touched or driven is left out.

    Raises
    ------
    InputError
        For anything but a URDF of joints that form one tree with finite numbers, masses >= 0 and
        at least one moving joint.

    Examples
    --------
    >>> parse_urdf(b"<robot><link name='a'/></robot>", "a.urdf")
    Traceback (most recent call last):
    isotorque.InputError: a.urdf: number of moving joints is 0; accepted: at least one ...
    """
    robot = _parse_xml(data, where)
    if robot.tag == "mujoco":
        raise InputError(where, "format", "MJCF", "URDF (MJCF is not supported yet)")
    if robot.tag != "robot":
        raise InputError(where, "root element", f"<{robot.tag}>", "<robot>, that of a URDF file")
    reader = UrdfReader(where)
    for element in robot.iter():
        if element.tag.startswith("xacro:"):
            raise InputError(where, "element", element.tag, "a URDF file expanded by xacro")
    links = tuple(reader.link(e) for e in robot.findall("link"))
    joints = tuple(reader.joint(e) for e in robot.findall("joint"))
    root = _root(links, joints, where)
    if not any(joint.moves for joint in joints):
        raise InputError(where, "number of moving joints", 0, "at least one revolute joint")
    return Urdf(robot.get("name", ""), root, links, joints)


def urdf_text(urdf: Urdf) -> str:
    """Return the URDF as text, for another program to parse; numbers are exact.

    Joints are written as they are in the file, whether they are locked or not; who follows whom
    is left out, and so is gravity.

    Examples
    --------
    >>> arm = parse_urdf(b'''<robot name="r"><link name="a"/><link name="b"/><joint name="j"
    ...     type="continuous"><parent link="a"/><child link="b"/></joint></robot>''', "r.urdf")
    >>> parse_urdf(urdf_text(arm).encode(), "again") == arm
    True
    """
    robot = ElementTree.Element("robot", name=urdf.name or "robot")
    for link in urdf.links:
        element = ElementTree.SubElement(robot, "link", name=link.name)
        inertial = ElementTree.SubElement(element, "inertial")
        _add(inertial, "origin", xyz=link.xyz, rpy=link.rpy)
        _add(inertial, "mass", value=(link.mass,))
        _add(
            inertial,
            "inertia",
            **{key: (value,) for key, value in zip(PRODUCTS, link.products, strict=True)},
        )
    for joint in urdf.joints:
        element = ElementTree.SubElement(robot, "joint", name=joint.name, type=joint.kind)
        ElementTree.SubElement(element, "parent", link=joint.parent)
        ElementTree.SubElement(element, "child", link=joint.child)
        _add(element, "origin", xyz=joint.xyz, rpy=joint.rpy)
        if joint.kind == "fixed":
            continue
        _add(element, "axis", xyz=joint.axis)
        _add(element, "dynamics", damping=(joint.damping,), friction=(joint.friction,))
        limit = {"effort": (max(joint.effort, 0.0),), "velocity": (max(joint.velocity, 0.0),)}
        if joint.lower is not None and joint.upper is not None:
            limit |= {"lower": (joint.lower,), "upper": (joint.upper,)}
        elif joint.kind in ("revolute", "prismatic"):  # left out they would read as zero
            limit |= {"lower": (-UNLIMITED,), "upper": (UNLIMITED,)}
        _add(element, "limit", **limit)
    return ElementTree.tostring(robot, encoding="unicode")


def _add(parent: ElementTree.Element, tag: str, **numbers: tuple[float, ...]) -> None:
    text = {key: " ".join(map(repr, values)) for key, values in numbers.items()}
    ElementTree.SubElement(parent, tag, text)


class _Elements(xml.sax.ContentHandler):
    """Builds elements named as they are written: prefixes need not be declared, as in URDF."""

    def __init__(self) -> None:
        super().__init__()
        self.builder = ElementTree.TreeBuilder()

    def startElement(self, name: str, attrs: Any) -> None:
        self.builder.start(name, dict(attrs))

    def endElement(self, name: str) -> None:
        self.builder.end(name)

    def characters(self, content: str) -> None:
        self.builder.data(content)


def _parse_xml(data: bytes, where: str) -> ElementTree.Element:
    elements = _Elements()
    try:
        defusedxml.sax.parseString(data, elements, forbid_dtd=True)
        return elements.builder.close()
    except defusedxml.DefusedXmlException as error:
        raise InputError(
            where, "XML", type(error).__name__, "a file without DTD, entities and references"
        ) from None
    except xml.sax.SAXParseException as error:
        place = f"line {error.getLineNumber()}, column {error.getColumnNumber()}"
        found = f"not XML ({error.getMessage()}: {place})"
        raise InputError(where, "content", found, "a URDF file") from None
    except (xml.sax.SAXException, ValueError, LookupError, AssertionError) as error:
        raise InputError(where, "content", f"not XML ({error})", "a URDF file") from None


def _root(links: tuple[UrdfLink, ...], joints: tuple[UrdfJoint, ...], where: str) -> str:
    """Return the name of the base link, having checked that the joints form a tree."""
    for field, names in (
        ("link", [link.name for link in links]),
        ("joint", [joint.name for joint in joints]),
    ):
        seen: set[str] = set()
        for name in names:
            if name in seen:
                raise InputError(where, f"name of {field}", f"'{name}' (twice)", "names used once")
            seen.add(name)
    known = {link.name for link in links}
    above: dict[str, UrdfJoint] = {}
    below: dict[str, list[str]] = {}
    for joint in joints:
        for field, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in known:
                raise InputError(
                    where, f"{field} of joint '{joint.name}'", f"'{name}'", "a link of this file"
                )
        if joint.child in above:
            raise InputError(
                where,
                f"child of joint '{joint.name}'",
                f"'{joint.child}', child of joint '{above[joint.child].name}' too",
                "a tree: one joint above each link",
            )
        above[joint.child] = joint
        below.setdefault(joint.parent, []).append(joint.child)
    roots = [link.name for link in links if link.name not in above]
    if len(roots) > 1:
        shown = " and ".join(f"'{name}'" for name in roots[:2])
        raise InputError(where, "base link", f"not unique ({shown} have no parent)", "one tree")
    reached, waiting = set(roots), list(roots)
    while waiting:
        for child in below.get(waiting.pop(), []):
            reached.add(child)
            waiting.append(child)
    for link in links:
        if link.name not in reached:
            raise InputError(where, f"parents of link '{link.name}'", "a loop", "a tree of links")
    if not roots:
        raise InputError(where, "number of links", 0, "at least two, joined by a joint")
    return roots[0]
