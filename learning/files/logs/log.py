"""A recording of an arm over time, in SI units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Vector


@dataclass(frozen=True, eq=False)
class Log:
    """Rows of a recording in the order in which they were taken, at rest or not.

    Attributes
    ----------
    joint_names : tuple of str
        The n joints, in the order of columns.
    q : (m, n) array
        Joint angles [rad] (positions [m] of prismatic joints).
    tau : (m, n) array
        Torques [N m] (forces [N]); motor currents [A] where `LogOptions` say so.
    time : (m,) array or None
        Seconds, never decreasing; None where the log has none: rows are poses then.
    velocity : (m, n) array or None
        Joint velocities [rad/s], where the log has them.
    lines : (m,) int array
        Line (first 1) or message that a row was read from.
    remarks : tuple of str
        What was understood without being told, and what was left out.
    """

    joint_names: tuple[str, ...]
    q: Vector
    tau: Vector
    time: Vector | None
    velocity: Vector | None
    lines: NDArray[np.int64]
    remarks: tuple[str, ...] = ()
