"""Equations of motion by Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from isotorque.learning.simulator.dynamics.equations import Array


class PinocchioEquations:
    """`Equations` of an arm, by calls of Pinocchio alone: the reference.

    Parameters
    ----------
    model
        Pinocchio model with one coordinate per joint.

    Notes
    -----
    Pinocchio's mass matrix and gravity derivatives are right only where every joint's descendants
    follow it without a gap, as they do in models read from files. A model built by hand in another
    order is put in that order first; joint order in and out is the given model's.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> equations = PinocchioEquations(load_robot("2r").model)
    >>> equations.gravity_torque(np.array([0.0, 0.0])).round(2)
    array([24.52,  6.13])
    """

    def __init__(self, model: pin.Model) -> None:
        order = _depth_first(model)
        self._model = model if order == sorted(order) else _reordered(model, order)
        self._data = self._model.createData()
        self._in = None if self._model is model else np.array(order) - 1
        self._out = None if self._in is None else np.argsort(self._in)

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self._model.nv)

    def mass_matrix(self, q: Array) -> Array:
        """Return M (n, n) [kg m^2] at joint angles q (n,) [rad]."""
        return self.terms(q, np.zeros(self.n))[0]

    def bias(self, q: Array, v: Array) -> Array:
        """Return h (n,) [N m]: Coriolis, centrifugal and gravity torque at velocities v [rad/s]."""
        return self.terms(q, v)[1]

    def gravity_torque(self, q: Array) -> Array:
        """Return g (n,) [N m]: the torque that holds the arm at rest."""
        if self._in is None:
            return np.array(pin.computeGeneralizedGravity(self._model, self._data, q))
        return pin.computeGeneralizedGravity(self._model, self._data, q[self._in])[self._out]

    def stiffness(self, q: Array) -> Array:
        """Return ``K = dg/dq`` (n, n) [N m/rad], symmetric."""
        return self.terms(q, np.zeros(self.n))[2]

    def terms(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return M, h and K at once."""
        model, data = self._model, self._data
        if self._in is not None:
            q, v = q[self._in], v[self._in]
        mass = pin.crba(model, data, q)
        bias = pin.nonLinearEffects(model, data, q, v)
        stiffness = pin.computeGeneralizedGravityDerivatives(model, data, q)
        if self._out is None:
            return mass, bias, stiffness
        grid = np.ix_(self._out, self._out)
        return mass[grid], bias[self._out], stiffness[grid]


def _depth_first(model: pin.Model) -> list[int]:
    """Return the joints of a model such that all descendants of a joint follow it at once."""
    children: list[list[int]] = [[] for _ in range(model.njoints)]
    for joint in range(1, model.njoints):
        children[model.parents[joint]].append(joint)
    order: list[int] = []
    waiting = children[0][::-1]
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting += children[joint][::-1]
    return order


def _reordered(model: pin.Model, order: list[int]) -> pin.Model:
    """Return a model with the same joints in another order, parents still first."""
    copy = pin.Model()
    copy.gravity = model.gravity
    place = {0: 0}
    for joint in order:
        parent = place[model.parents[joint]]
        placement = model.jointPlacements[joint]
        place[joint] = copy.addJoint(parent, model.joints[joint], placement, model.names[joint])
        copy.appendBodyToJoint(place[joint], model.inertias[joint], pin.SE3.Identity())
    copy.armature = np.array(model.armature)[np.array(order) - 1]
    return copy
