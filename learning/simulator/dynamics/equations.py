"""Equations of motion: the interface of all of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Equations(Protocol):
    """Equations of motion ``M(q) a + h(q, v) = torque`` of an arm with n joints."""

    @property
    def n(self) -> int:
        """Number of joints."""
        ...

    def mass_matrix(self, q: Array) -> Array:
        """Return M (n, n) [kg m^2] at joint angles q (n,) [rad]."""
        ...

    def bias(self, q: Array, v: Array) -> Array:
        """Return h (n,) [N m]: Coriolis, centrifugal and gravity torque at velocities v [rad/s]."""
        ...

    def gravity_torque(self, q: Array) -> Array:
        """Return g (n,) [N m]: the torque that holds the arm at rest."""
        ...

    def stiffness(self, q: Array) -> Array:
        """Return ``K = dg/dq`` (n, n) [N m/rad], symmetric."""
        ...
