"""Arms snapped: each orientation and axis in turn, with the effect that it has on gravity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.rotations import Triple, unit_axis
from isotorque.symbolic.robots.snap_effect import torque_difference_bound
from isotorque.symbolic.robots.snapping import (
    Snap,
    clean_lengths,
    differs,
    snap_angle,
    snap_angles,
    snap_axis,
    snap_direction,
    snap_rotation,
)
from isotorque.symbolic.robots.urdf.urdf_body import body_from_urdf
from isotorque.symbolic.robots.urdf.urdf_elements import REVOLUTE, UrdfJoint
from isotorque.symbolic.robots.urdf.urdf_file import Urdf

Array = NDArray[np.float64]


def snap_urdf(urdf: Urdf, joint_names: Sequence[str]) -> tuple[ArmBody, tuple[Snap, ...]]:
    """Return the arm that a URDF describes with its rounded angles snapped.

    Parameters
    ----------
    urdf
        The description.
    joint_names
        The moving joints in Pinocchio's order.

    Returns
    -------
    tuple
        The arm, and what was snapped in the order of the file.

    Notes
    -----
    Angles are snapped where they are written (fixed joints and inertial frames too), then links
    are merged, then the placements of the joints that result are snapped: two fixed joints
    turned by 0.785398 each make a right angle. Effects are those of one snap after the other,
    so that their sum is no less than the whole.
    """
    snaps: list[Snap] = []
    body = body_from_urdf(urdf, joint_names)
    for i, joint in enumerate(urdf.joints):
        if joint.locked is not None and joint.kind in REVOLUTE:
            angle, right = joint.locked, snap_angle(joint.locked)
            joint = replace(joint, locked=right)
            urdf = _with_joint(urdf, i, joint)
            if differs((angle,), (right,)):
                new = body_from_urdf(urdf, joint_names)
                _list(snaps, joint.name, "locked angle", (angle,), (right,), body, new)
                body = new
        turned = replace(joint, rpy=snap_angles(joint.rpy))
        urdf = _with_joint(urdf, i, turned)
        if differs(joint.rpy, turned.rpy):
            new = body_from_urdf(urdf, joint_names)
            _list(snaps, joint.name, "origin rpy", joint.rpy, turned.rpy, body, new)
            body = new
        axis = snap_axis(joint.axis)
        urdf = _with_joint(urdf, i, replace(turned, axis=axis))
        if differs(unit_axis(joint.axis), axis):
            new = body_from_urdf(urdf, joint_names)
            _list(snaps, joint.name, "axis", unit_axis(joint.axis), axis, body, new)
            body = new
    for i, link in enumerate(urdf.links):
        rpy = snap_angles(link.rpy)
        if differs(link.rpy, rpy):  # turns an inertia, which gravity does not see
            nothing = np.zeros(body.n)
            snaps.append(Snap(link.name, "inertial rpy", link.rpy, rpy, nothing))
        link = replace(link, rpy=rpy)
        urdf = replace(urdf, links=(*urdf.links[:i], link, *urdf.links[i + 1 :]))
    body, more = snap_body(body_from_urdf(urdf, joint_names))
    return body, (*snaps, *more)


def snap_body(body: ArmBody) -> tuple[ArmBody, tuple[Snap, ...]]:
    """Return an arm with placements and axes of joints, and gravity snapped, without noise.

    Parameters
    ----------
    body
        Any arm.

    Returns
    -------
    tuple
        The arm, and what was snapped; noise of relative size 1e-12 is removed without mention.
    """
    snaps: list[Snap] = []
    for i, name in enumerate(body.joint_names):
        rotation, before, after = snap_rotation(body.rotations[i])
        turned = replace(body, rotations=_with(body.rotations, i, rotation))
        if differs(before, after):
            _list(snaps, name, "placement rpy", before, after, body, turned)
        old = unit_axis(_triple(body.axes[i]))
        new = snap_axis(old)
        body = replace(turned, axes=_with(body.axes, i, np.array(new)))
        if differs(old, new):
            _list(snaps, name, "axis", old, new, turned, body)
    given = _triple(body.gravity)
    down = snap_direction(given)
    level = replace(body, gravity=np.array(down))
    if differs(given, down):
        _list(snaps, "gravity", "direction", given, down, body, level)
    body = level
    size = float(max(np.abs(body.translations).max(), np.abs(body.levers).max()))
    body = replace(
        body,
        translations=clean_lengths(body.translations, size),
        levers=clean_lengths(body.levers, size),
    )
    return body, tuple(snaps)


def _list(
    snaps: list[Snap],
    name: str,
    what: str,
    before: tuple[float, ...],
    after: tuple[float, ...],
    old: ArmBody,
    new: ArmBody,
) -> None:
    """Add a snap with its effect to the list."""
    effect = torque_difference_bound(old.tree(), new.tree())
    snaps.append(Snap(name, what, before, after, effect))


def _with_joint(urdf: Urdf, i: int, joint: UrdfJoint) -> Urdf:
    return replace(urdf, joints=(*urdf.joints[:i], joint, *urdf.joints[i + 1 :]))


def _with(rows: Array, i: int, row: Array) -> Array:
    changed = rows.copy()
    changed[i] = row
    return changed


def _triple(values: Array) -> Triple:
    x, y, z = map(float, values)
    return x, y, z
