"""Equations of motion by Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from learning.dynamics.equations import Array


class PinocchioEquations:
    """`Equations` of an arm, by calls of Pinocchio alone: the reference.

    Parameters
    ----------
    model
        Pinocchio model with one coordinate per joint.

    Examples
    --------
    >>> from symbolic.robots import load_robot
    >>> equations = PinocchioEquations(load_robot("2r").model)
    >>> equations.gravity_torque(np.array([0.0, 0.0])).round(2)
    array([24.52,  6.13])
    """

    def __init__(self, model: pin.Model) -> None:
        self.model = model
        self._data = model.createData()

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.model.nv)

    def mass_matrix(self, q: Array) -> Array:
        """Return M (n, n) [kg m^2] at joint angles q (n,) [rad]."""
        return np.array(pin.crba(self.model, self._data, q))

    def bias(self, q: Array, v: Array) -> Array:
        """Return h (n,) [N m]: Coriolis, centrifugal and gravity torque at velocities v [rad/s]."""
        return np.array(pin.nonLinearEffects(self.model, self._data, q, v))

    def gravity_torque(self, q: Array) -> Array:
        """Return g (n,) [N m]: the torque that holds the arm at rest."""
        return np.array(pin.computeGeneralizedGravity(self.model, self._data, q))

    def stiffness(self, q: Array) -> Array:
        """Return ``K = dg/dq`` (n, n) [N m/rad], symmetric."""
        return np.array(pin.computeGeneralizedGravityDerivatives(self.model, self._data, q))

    def terms(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return M, h and K at once."""
        model, data = self.model, self._data
        return (
            pin.crba(model, data, q),
            pin.nonLinearEffects(model, data, q, v),
            pin.computeGeneralizedGravityDerivatives(model, data, q),
        )
