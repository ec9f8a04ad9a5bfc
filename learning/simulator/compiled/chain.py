"""Equations of motion by the compiled sweep over a chain."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from isotorque.learning.simulator.compiled.equations import evaluate
from isotorque.learning.simulator.compiled.links import new_rows
from isotorque.learning.simulator.dynamics.chain import Chain

Array = NDArray[np.float64]


class CompiledEquations:
    """`Equations` of an arm, compiled.

    Parameters
    ----------
    model
        Pinocchio model with one coordinate per joint.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> equations = CompiledEquations(load_robot("2r").model)
    >>> equations.gravity_torque(np.array([0.0, 0.0])).round(2)
    array([24.52,  6.13])
    """

    def __init__(self, model: pin.Model) -> None:
        self.chain = Chain.from_model(model)
        n = self.chain.n
        self._at_rest = np.zeros(n)
        self._rows = new_rows(self.chain)
        self._mass = np.zeros((n, n))
        self._stiffness = np.zeros((n, n))
        self._bias = np.zeros(n)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.chain.n

    def mass_matrix(self, q: Array) -> Array:
        """Return M (n, n) [kg m^2] at joint angles q (n,) [rad]."""
        self._evaluate(q, self._at_rest)
        return _symmetric(self._mass)

    def bias(self, q: Array, v: Array) -> Array:
        """Return h (n,) [N m]: Coriolis, centrifugal and gravity torque at velocities v [rad/s]."""
        self._evaluate(q, v)
        return self._bias.copy()

    def gravity_torque(self, q: Array) -> Array:
        """Return g (n,) [N m]: the torque that holds the arm at rest."""
        return self.bias(q, self._at_rest)

    def stiffness(self, q: Array) -> Array:
        """Return ``K = dg/dq`` (n, n) [N m/rad], symmetric."""
        self._evaluate(q, self._at_rest)
        return _symmetric(self._stiffness)

    def _evaluate(self, q: Array, v: Array) -> None:
        evaluate(
            *self.chain.arrays,
            np.array(q, dtype=float),
            np.array(v, dtype=float),
            self._rows,
            self._mass,
            self._bias,
            self._stiffness,
        )


def _symmetric(lower: Array) -> Array:
    """Return the symmetric matrix with the given lower triangle, zero above it."""
    whole = lower + lower.T
    np.fill_diagonal(whole, lower.diagonal())
    return whole
