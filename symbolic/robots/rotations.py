"""Rotations from roll, pitch, yaw and from unit axes, exact at right angles."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Triple = tuple[float, float, float]

_RIGHT = math.pi / 2


def unit_axis(axis: Triple) -> Triple:
    """Return the unit vector along a direction; one that is a unit vector already stays as it is.

    Examples
    --------
    >>> unit_axis((0.0, 0.0, -2.0)), unit_axis((0.6, 0.8, 0.0)), unit_axis((1e200, 0.0, 0.0))
    ((0.0, 0.0, -1.0), (0.6, 0.8, 0.0), (1.0, 0.0, 0.0))
    """
    largest = max(map(abs, axis))  # first to size one: no overflow
    length = math.hypot(*(value / largest for value in axis)) * largest
    if abs(length - 1.0) < 4e-16:
        length = 1.0
    x, y, z = (value / length + 0.0 for value in axis)
    return x, y, z


def rotation_from_rpy(rpy: Triple) -> Array:
    """Return the rotation Rz(yaw) Ry(pitch) Rx(roll), exact for multiples of pi/2.

    Parameters
    ----------
    rpy
        Roll, pitch and yaw [rad], as in URDF.

    Returns
    -------
    (3, 3) array

    Examples
    --------
    >>> print(rotation_from_rpy((0.0, 0.0, math.pi / 2)))
    [[ 0. -1.  0.]
     [ 1.  0.  0.]
     [ 0.  0.  1.]]
    """
    (cr, sr), (cp, sp), (cy, sy) = map(_cos_sin, rpy)
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]], dtype=float)
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]], dtype=float)
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]], dtype=float)
    return multiply(yaw, pitch, roll)


def multiply(*matrices: Array) -> Array:
    """Return a product of small matrices, summed in a fixed order.

    Notes
    -----
    A BLAS may sum differently from one machine to the next; here equal input gives equal bits.
    """
    product = matrices[0]
    for m in matrices[1:]:
        product = sum(np.multiply.outer(product[:, k], m[k]) for k in range(len(m)))
    return product + 0.0  # -0 becomes 0


def _quarter_turns(angle: float) -> int:
    return round(angle / _RIGHT)


def _is_right(angle: float) -> bool:
    return angle == _quarter_turns(angle) * _RIGHT


def _cos_sin(angle: float) -> tuple[float, float]:
    if _is_right(angle):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[_quarter_turns(angle) % 4]
    return math.cos(angle), math.sin(angle)
