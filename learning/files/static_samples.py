"""Configurations of an arm at rest and the torques that hold it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Vector


@dataclass(frozen=True, eq=False)
class StaticSamples:
    """Configurations of an arm and the torques that hold them.

    Attributes
    ----------
    q : (m, n) array
        Joint angles [rad] (positions [m] of prismatic joints), one row per sample.
    tau : (m, n) array
        Torques [N m] (forces [N] of prismatic joints) that hold the arm there at rest.
    torque_error : (m, n) array or None
        Standard errors of the torques [N m], where samples are means of many rows.
    directions : (m, n) array or None
        Sign of the last motion of every joint before the arm came to rest; 0 where not known.
    rows : (m,) int array or None
        Rows of the log that each sample is the mean of.
    """

    q: Vector
    tau: Vector
    torque_error: Vector | None = None
    directions: Vector | None = None
    rows: NDArray[np.int64] | None = None

    def part(self, chosen: NDArray[np.intp] | NDArray[np.bool_]) -> StaticSamples:
        """Some of the samples, by number or mask.

        Examples
        --------
        >>> samples = StaticSamples(np.zeros((3, 1)), np.array([[1.0], [2.0], [3.0]]))
        >>> samples.part(np.array([0, 2])).tau.ravel().tolist()
        [1.0, 3.0]
        """
        error, directions, rows = self.torque_error, self.directions, self.rows
        return StaticSamples(
            self.q[chosen],
            self.tau[chosen],
            None if error is None else error[chosen],
            None if directions is None else directions[chosen],
            None if rows is None else rows[chosen],
        )
