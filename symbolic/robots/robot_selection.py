"""Selection of what options choose of a robot: joints locked, payload added, gravity turned."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.locked_joints import JointOfRobot, locked_positions
from isotorque.symbolic.robots.urdf.urdf_elements import UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf

_KINDS = {
    **dict.fromkeys(("RX", "RY", "RZ", "RevoluteUnaligned"), "revolute"),
    **dict.fromkeys(("RUBX", "RUBY", "RUBZ", "RevoluteUnboundedUnaligned"), "continuous"),
    **dict.fromkeys(("PX", "PY", "PZ", "PrismaticUnaligned"), "prismatic"),
    "FreeFlyer": "floating",
    "Planar": "planar",
}  # of Pinocchio's joints


def chosen_part(urdf: Urdf, options: RobotOptions, where: str) -> Urdf:
    """Return a description with what the options say of it.

    Parameters
    ----------
    urdf
        As in the file.
    options
        ``lock``, ``joints``, ``tip``, ``gravity`` and ``payload``.
    where
        What to call the file in an error.

    Returns
    -------
    Urdf
        Locked joints know where they stand, payloads are links, gravity is what was wanted.

    Raises
    ------
    InputError
        For options that fit no joint or link of the file, and moving joints of kinds that cannot
        be handled.
    """
    joints = joints_of_urdf(urdf)
    above = {joint.child: joint for joint in urdf.joints}
    names = [link.name for link in urdf.links]

    def carriers(link: str) -> Collection[str]:
        _check_link(link, names, "--tip", where)
        return _path(above, link)

    positions = locked_positions(joints, options, carriers, where)
    urdf = replace(
        urdf,
        joints=tuple(replace(j, locked=positions.get(j.name)) for j in urdf.joints),
        gravity=urdf.gravity if options.gravity is None else options.gravity,
    )
    for number, payload in enumerate(options.payload, 1):
        link = payload.link
        if link is None:
            link = _last_moving_link(urdf, where)
        else:
            _check_link(link, names, "link of --payload", where)
        if not any(joint.moves for joint in urdf.joints if joint.name in _path(above, link)):
            accepted = f"a link that moves, such as '{_moving_links(urdf)[-1]}'"
            raise InputError(where, "link of --payload", f"'{link}'", accepted)
        name = f"payload {number} at {link}"
        urdf = replace(
            urdf,
            links=(*urdf.links, UrdfLink(name, payload.mass, payload.center)),
            joints=(*urdf.joints, UrdfJoint(name, "fixed", link, name)),
        )
    return urdf


def joints_of_urdf(urdf: Urdf) -> list[JointOfRobot]:
    """Return all joints of a description that are not fixed."""
    above = {joint.child: joint for joint in urdf.joints}
    return [
        JointOfRobot(
            joint.name,
            joint.kind,
            frozenset(_path(above, joint.parent)),
            joint.lower,
            joint.upper,
            joint.mimic,
        )
        for joint in urdf.joints
        if joint.kind != "fixed"
    ]


def part_as_pinocchio_reads(model: pin.Model, urdf: Urdf, where: str) -> pin.Model:
    """Let Pinocchio lock the joints of the whole robot, which it has read.

    Parameters
    ----------
    model
        The whole robot.
    urdf
        From `chosen_part`.
    where
        What to call it in an error.
    """
    positions = {j.name: j.locked for j in urdf.joints if j.locked is not None}
    return _reduced(model, positions, urdf.gravity, where)


def chosen_part_of_model(model: pin.Model, options: RobotOptions, where: str) -> pin.Model:
    """Return a Pinocchio model with what the options say of it; see `chosen_part`."""
    joints = joints_of_model(model)
    frames = [frame.name for frame in model.frames]

    def carriers(link: str) -> Collection[str]:
        _check_link(link, frames, "--tip", where)
        return _supports(model, model.frames[model.getFrameId(link)].parentJoint)

    positions = locked_positions(joints, options, carriers, where)
    if not (positions or options.payload or options.gravity):
        return model
    model = model.copy()
    for payload in options.payload:
        if payload.link is None:
            moving = [joint for joint in joints if joint.name not in positions]
            index, place = _only_last(model, moving, where), pin.SE3.Identity()
        else:
            _check_link(payload.link, frames, "link of --payload", where)
            frame = model.frames[model.getFrameId(payload.link)]
            index, place = frame.parentJoint, frame.placement
        if not set(_supports(model, index)) - positions.keys():
            raise InputError(
                where, "link of --payload", f"'{payload.link}'", "a frame of a link that moves"
            )
        point = pin.Inertia(payload.mass, np.array(payload.center), np.zeros((3, 3)))
        model.appendBodyToJoint(index, point, place)
    gravity = model.gravity.linear if options.gravity is None else options.gravity
    return _reduced(model, positions, gravity, where)


def joints_of_model(model: pin.Model) -> list[JointOfRobot]:
    """Return all joints of a Pinocchio model."""
    out = []
    for index in range(1, model.njoints):
        joint = model.joints[index]
        kind = joint.shortname().removeprefix("JointModel")
        kind = _KINDS.get(kind, kind)
        bounded = kind in ("revolute", "prismatic")
        out.append(
            JointOfRobot(
                model.names[index],
                kind,
                frozenset(_supports(model, index)) - {model.names[index]},
                float(model.lowerPositionLimit[joint.idx_q]) if bounded else None,
                float(model.upperPositionLimit[joint.idx_q]) if bounded else None,
            )
        )
    return out


def _reduced(
    model: pin.Model, positions: dict[str, float], gravity: Sequence[float], where: str
) -> pin.Model:
    """Return the model with joints locked by Pinocchio's own hand."""
    if positions:
        q = pin.neutral(model)
        for name, position in positions.items():
            joint = model.joints[model.getJointId(name)]
            if joint.nv == 1 and joint.nq == 2:
                q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
            elif joint.nq == 1:
                q[joint.idx_q] = position
        try:
            model = pin.buildReducedModel(model, [model.getJointId(name) for name in positions], q)
        except Exception as error:  # Boost.Python maps C++ exceptions to several types
            found = f"refused by Pinocchio ({error})"
            raise InputError(where, "locking of joints", found, "joints that it locks") from None
    model.gravity.linear = np.array(gravity, dtype=float)
    return model


def _supports(model: pin.Model, index: int) -> list[str]:
    return [model.names[i] for i in model.supports[index] if i > 0]


def _only_last(model: pin.Model, moving: Sequence[JointOfRobot], where: str) -> int:
    ends = [j for j in moving if not any(j.name in other.above for other in moving)]
    if len(ends) > 1:
        _several_ends([joint.name for joint in ends], where)
    return int(model.getJointId(ends[0].name))


def _last_moving_link(urdf: Urdf, where: str) -> str:
    """Return the link behind the last moving joint of a chain."""
    above = {joint.child: joint for joint in urdf.joints}
    links = _moving_links(urdf)
    carriers = {x for link in links for x in _links_above(above, link) if x != link}
    ends = [link for link in links if link not in carriers]
    if len(ends) > 1:
        _several_ends(ends, where)
    return ends[0]


def _several_ends(ends: Sequence[str], where: str) -> None:
    found = f"not given, and {len(ends)} chains end ({', '.join(ends)})"
    raise InputError(where, "link of --payload", found, "--payload MASS@LINK")


def _moving_links(urdf: Urdf) -> list[str]:
    return [joint.child for joint in urdf.joints if joint.moves]


def _links_above(above: dict[str, UrdfJoint], link: str) -> list[str]:
    """Return a link and those between it and the root, the root left out."""
    out = []
    while link in above:
        out.append(link)
        link = above[link].parent
    return out


def _path(above: dict[str, UrdfJoint], link: str) -> list[str]:
    """Return the joints between the root and a link that are not fixed."""
    joints = [above[name] for name in _links_above(above, link)]
    return [joint.name for joint in joints if joint.kind != "fixed"]


def _check_link(link: str, known: Sequence[str], option: str, where: str) -> None:
    if link not in known:
        raise InputError(where, option, f"'{link}'", f"one of the links {', '.join(known)}")
