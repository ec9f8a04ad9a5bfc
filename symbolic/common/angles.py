"""Angles modulo a full turn: wrapping and circular distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.arrays import Floats

Array = NDArray[np.float64]

MANY_TURNS = 100.0
"""Beyond, subtracting rounded turns loses digits [rad]: sine and cosine reduce exactly."""


def wrap(angle: ArrayLike) -> Array:
    """Return angles modulo 2 pi in (-pi, pi]; values within rounding of -pi are written pi.

    Examples
    --------
    >>> wrap([-np.pi, 3 * np.pi, 0.5, 6283185307179586.0])
    array([ 3.14159265,  3.14159265,  0.5       , -0.47692529])
    """
    x = np.asarray(angle, dtype=float)
    far = np.abs(x) > MANY_TURNS
    if far.any():
        x = np.where(far, np.arctan2(np.sin(x), np.cos(x)), x)
    wrapped = x - 2 * np.pi * np.ceil((x - np.pi) / (2 * np.pi) - 1e-12)
    return np.where(wrapped > np.pi, np.pi, wrapped) + 0.0


TURN = 2 * np.pi


def circular_distance(a: Floats, b: Floats) -> NDArray[np.float64]:
    """Return the largest difference modulo 2 pi along the last axis."""
    return np.asarray(np.abs(np.remainder(a - b + np.pi, TURN) - np.pi).max(axis=-1, initial=0.0))
