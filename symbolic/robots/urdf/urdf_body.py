"""The arm that a URDF describes: links that are fixed to each other become one body."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.joint_limits import read_limits
from isotorque.symbolic.robots.arm_body import ArmBody, positive_or_none
from isotorque.symbolic.robots.rotations import multiply, rotation_from_rpy, unit_axis
from isotorque.symbolic.robots.snapping import rotation_about
from isotorque.symbolic.robots.urdf.urdf_elements import UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf

Array = NDArray[np.float64]


def body_from_urdf(urdf: Urdf, joint_names: Sequence[str]) -> ArmBody:
    """Merge links joined by fixed or locked joints and return the arm.

    Parameters
    ----------
    urdf
        The description.
    joint_names
        The moving joints in the order wanted (Pinocchio's), parents first.

    Returns
    -------
    ArmBody
        Rotations by multiples of pi/2 are exact, and so is what follows from them: Pinocchio
        goes through quaternions, which leaves noise of 1e-16 in entries that should be 0 or 1.
    """
    joints = {joint.name: joint for joint in urdf.joints}
    moving = [joints[name] for name in joint_names]
    place = _places(urdf, joint_names)
    parts: list[list[tuple[float, Array, Array]]] = [[] for _ in moving]
    for link in urdf.links:
        index, rotation, translation = place[link.name]
        if index >= 0:  # what is fixed to the base bears on no joint
            parts[index].append(_part(link, rotation, translation))
    bodies = [_merged(part) for part in parts]
    parents, rotations, translations = [], [], []
    for joint in moving:
        index, rotation, translation = _behind(place[joint.parent], joint)
        parents.append(index)
        rotations.append(rotation)
        translations.append(translation)
    return ArmBody(
        joint_names=tuple(joint_names),
        parents=tuple(parents),
        rotations=np.array(rotations),
        translations=np.array(translations),
        axes=np.array([unit_axis(joint.axis) for joint in moving]),
        masses=np.array([mass for mass, _, _ in bodies]),
        levers=np.array([lever for _, lever, _ in bodies]),
        inertias=np.array([inertia for _, _, inertia in bodies]),
        limits=np.array([read_limits(joint.lower, joint.upper) for joint in moving]),
        efforts=np.array([positive_or_none(joint.effort) for joint in moving]),
        velocities=np.array([positive_or_none(joint.velocity) for joint in moving]),
        damping=np.array([joint.damping for joint in moving]),
        friction=np.array([joint.friction for joint in moving]),
        armature=np.zeros(len(moving)),
        gravity=np.array(urdf.gravity),
    )


_Place = tuple[int, Array, Array]  # moving joint (-1: base), rotation and translation behind it


def _places(urdf: Urdf, joint_names: Sequence[str]) -> dict[str, _Place]:
    """Return for every link the moving joint that carries it and its placement there."""
    index = {name: i for i, name in enumerate(joint_names)}
    below: dict[str, list[UrdfJoint]] = {}
    for joint in urdf.joints:
        below.setdefault(joint.parent, []).append(joint)
    place: dict[str, _Place] = {urdf.root: (-1, np.eye(3), np.zeros(3))}
    waiting = [urdf.root]
    while waiting:
        link = waiting.pop()
        for joint in below.get(link, []):
            if joint.name in index:
                place[joint.child] = (index[joint.name], np.eye(3), np.zeros(3))
            else:
                place[joint.child] = _moved(_behind(place[link], joint), joint)
            waiting.append(joint.child)
    return place


def _behind(place: _Place, joint: UrdfJoint) -> _Place:
    """Return the place of a joint's frame (at angle 0) on a link with the given place."""
    index, rotation, translation = place
    return (
        index,
        multiply(rotation, rotation_from_rpy(joint.rpy)),
        translation + multiply(rotation, np.array(joint.xyz)),
    )


def _moved(place: _Place, joint: UrdfJoint) -> _Place:
    """Return the place of the link behind a joint that stands still where it is locked."""
    if not joint.locked:
        return place
    index, rotation, translation = place
    axis = unit_axis(joint.axis)
    if joint.kind == "prismatic":
        return index, rotation, translation + multiply(rotation, joint.locked * np.array(axis))
    return index, multiply(rotation, rotation_about(axis, joint.locked)), translation


def _part(link: UrdfLink, rotation: Array, translation: Array) -> tuple[float, Array, Array]:
    """Return mass, centre of mass and inertia about it of a link, seen from its moving joint."""
    xx, xy, xz, yy, yz, zz = link.products
    turn = multiply(rotation, rotation_from_rpy(link.rpy))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    lever = translation + multiply(rotation, np.array(link.xyz))
    turned = multiply(turn, tensor, turn.T.copy())
    return link.mass, lever, (turned + turned.T) / 2  # symmetric to the last bit


def _merged(parts: list[tuple[float, Array, Array]]) -> tuple[float, Array, Array]:
    """Return mass, centre of mass and inertia about it of several parts."""
    tensor = sum((inertia for _, _, inertia in parts), np.zeros((3, 3)))
    heavy = [(mass, lever) for mass, lever, _ in parts if mass > 0]
    if not heavy:
        return 0.0, np.zeros(3), tensor
    if len(heavy) == 1:  # as it stands: dividing by the mass would round
        return heavy[0][0], heavy[0][1], tensor
    mass = sum(m for m, _ in heavy)
    centre = sum((m * lever for m, lever in heavy), np.zeros(3)) / mass
    for m, lever in heavy:
        x = lever - centre
        tensor = tensor + m * (np.dot(x, x) * np.eye(3) - np.outer(x, x))
    return mass, centre, tensor
