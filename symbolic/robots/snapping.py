"""Snapping: angles that were rounded in a file are set back to multiples of pi/2.

``rpy="1.5708 0 0"`` means a right angle; taken literally it makes tiny spurious coefficients in
the gravity potential, and symmetries of the arm are lost. Angles within ``SNAP_ANGLE`` of a
multiple of pi/2, and axes within it of a coordinate axis, are snapped; others never move.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from isotorque.symbolic.robots.rotations import (
    _RIGHT,
    Array,
    Triple,
    _cos_sin,
    _quarter_turns,
    rotation_from_rpy,
    unit_axis,
)

SNAP_ANGLE = 1e-5
"""Largest change of an angle by snapping [rad]."""

ROUNDING = 1e-12
"""Changes below this [rad, or relative to the arm's size] are rounding: made, but not listed."""


@dataclass(frozen=True, eq=False)
class Snap:
    """An orientation or axis that was snapped when a robot was loaded.

    Attributes
    ----------
    joint : str
        Name of the joint (link, for the orientation of an inertia; ``gravity`` for its direction).
    what : str
        What was snapped: ``origin rpy``, ``axis``, ``inertial rpy``, ``placement rpy`` (that of a
        joint relative to the joint before it), ``locked angle`` or ``direction`` (of gravity).
    before, after : tuple of floats
        Roll, pitch, yaw [rad], the unit axis, the angle [rad], or gravity [m/s^2].
    effect : (n,) array
        Largest change of each joint's gravity torque by this snap, over all configurations [N m].
    """

    joint: str
    what: str
    before: tuple[float, ...]
    after: tuple[float, ...]
    effect: Array


def snap_angle(angle: float) -> float:
    """Return the multiple of pi/2 within 1e-5 of an angle [rad], or the angle itself.

    Examples
    --------
    >>> snap_angle(1.5708), snap_angle(-3.1416), snap_angle(1.57)
    (1.5707963267948966, -3.141592653589793, 1.57)
    """
    nearest = _quarter_turns(angle) * _RIGHT
    return nearest if abs(angle - nearest) <= SNAP_ANGLE else angle


def snap_angles(angles: Triple) -> Triple:
    """Snap three angles [rad]."""
    a, b, c = map(snap_angle, angles)
    return a, b, c


def snap_axis(axis: Triple) -> Triple:
    """Return the coordinate axis within 1e-5 rad of a direction, or the unit axis itself.

    Examples
    --------
    >>> snap_axis((0.0, -2.0, 1e-5))
    (0.0, -1.0, 0.0)
    """
    unit = unit_axis(axis)
    main = max(range(3), key=lambda i: abs(unit[i]))
    off = math.hypot(*(unit[i] for i in range(3) if i != main))
    if math.atan2(off, abs(unit[main])) > SNAP_ANGLE:
        x, y, z = (0.0 if abs(value) < ROUNDING else value for value in unit)
    else:
        x, y, z = (math.copysign(1.0, unit[i]) if i == main else 0.0 for i in range(3))
    return x, y, z


def snap_direction(vector: Triple) -> Triple:
    """Return a vector along the coordinate axis within 1e-5 rad of it, or the vector itself.

    Examples
    --------
    >>> snap_direction((0.0, 1e-9, -9.81)), snap_direction((0.0, 1.0, -9.81))
    ((0.0, 0.0, -9.81), (0.0, 1.0, -9.81))
    """
    if not any(vector):
        return vector
    axis = snap_axis(vector)
    if axis.count(0.0) < 2:
        return vector
    length = math.hypot(*vector) if differs(unit_axis(vector), axis) else max(map(abs, vector))
    x, y, z = (value * length + 0.0 for value in axis)
    return x, y, z


def rotation_about(axis: Triple, angle: float) -> Array:
    """Return the rotation by an angle about a unit axis, exact for right angles and frame axes.

    Parameters
    ----------
    axis
        Unit vector.
    angle
        Angle [rad].

    Returns
    -------
    (3, 3) array

    Examples
    --------
    >>> print(rotation_about((0.0, 0.0, -1.0), snap_angle(1.5708)))
    [[ 0.  1.  0.]
     [-1.  0.  0.]
     [ 0.  0.  1.]]
    """
    cos, sin = _cos_sin(angle)
    x, y, z = axis
    u = np.array(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # about a frame axis 1 - u u^T has entries 0 and 1 only
    return np.outer(u, u) + cos * (np.eye(3) - np.outer(u, u)) + sin * cross + 0.0


def rpy_from_rotation(rotation: Array) -> Triple:
    """Return roll, pitch, yaw [rad] of a rotation matrix.

    Notes
    -----
    Where the pitch is within 1e-5 of +-pi/2 only yaw -+ roll matters: roll is given as 0.
    """
    level = math.hypot(rotation[0, 0], rotation[1, 0])  # cos(pitch)
    pitch = math.atan2(-rotation[2, 0], level)
    if level <= SNAP_ANGLE:
        return 0.0, pitch, math.atan2(-rotation[0, 1], rotation[1, 1])
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    return roll, pitch, math.atan2(rotation[1, 0], rotation[0, 0])


def snap_rotation(rotation: Array) -> tuple[Array, Triple, Triple]:
    """Snap roll, pitch and yaw of a rotation matrix.

    Parameters
    ----------
    rotation
        (3, 3) rotation matrix.

    Returns
    -------
    tuple
        The snapped rotation, with its angles before and after. Where no angle is snapped, not
        even by rounding noise, the rotation is the very same.
    """
    before = rpy_from_rotation(rotation)
    after = snap_angles(before)
    if before == after:
        return rotation, before, after
    return rotation_from_rpy(after), before, after


def differs(before: tuple[float, ...], after: tuple[float, ...]) -> bool:
    """Say whether something was snapped, other than rounding."""
    return max(abs(a - b) for a, b in zip(before, after, strict=True)) > ROUNDING


def clean_lengths(lengths: Array, scale: float) -> Array:
    """Set lengths that are rounding noise beside ``scale`` [m] to exactly zero."""
    return np.where(np.abs(lengths) < ROUNDING * scale, 0.0, lengths)
