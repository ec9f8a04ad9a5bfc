"""Pinocchio models of kinematic trees."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from isotorque.symbolic.robots.kinematic_tree import KinematicTree

GYRATION_RADII = (0.05, 0.06, 0.07)
"""Radii of gyration given to links, of which a tree knows only mass and centre [m]."""

EFFORT, SPEED = 1e3, 10.0
"""Largest torque [N m] and speed [rad/s] written into the model."""


def pinocchio_model(tree: KinematicTree, *, continuous: bool = False) -> pin.Model:
    """Build the Pinocchio model of a tree of numbers.

    Parameters
    ----------
    tree
        Joints and links; entries are floats.
    continuous
        Whether the joints are Pinocchio's unbounded ones (nq = 2 each) instead of ones limited
        to one turn.

    Returns
    -------
    pin.Model
        Rotational inertias, of which a tree knows nothing, are those of small ellipsoids.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> model = pinocchio_model(load_robot("2r").tree)
    >>> torque = pin.computeGeneralizedGravity(model, model.createData(), np.zeros(2))
    >>> print(np.round(torque, 3))
    [24.525  6.131]
    """
    model = pin.Model()
    model.name = "tree"
    model.gravity.linear = np.asarray(tree.gravity, dtype=float)
    radii = np.diag(np.square(GYRATION_RADII))
    frames: list[NDArray[np.float64]] = []  # columns: axes of Pinocchio's link frame in the tree's
    for i, name in enumerate(tree.joint_names):
        axis = np.asarray(tree.axes[i], dtype=float)
        frames.append(_frame_about(axis) if continuous else np.eye(3))
        parent = tree.parents[i]
        back = np.eye(3) if parent < 0 else frames[parent].T
        placement = pin.SE3(
            back @ np.asarray(tree.rotations[i], dtype=float) @ frames[i],
            back @ np.asarray(tree.translations[i], dtype=float),
        )
        if continuous:  # Pinocchio's Python has no unbounded joint about a given axis
            index = model.addJoint(parent + 1, pin.JointModelRUBZ(), placement, name)
        else:
            ranges = (np.array([x]) for x in (EFFORT, SPEED, -np.pi, np.pi))
            joint = pin.JointModelRevoluteUnaligned(axis)
            index = model.addJoint(parent + 1, joint, placement, name, *ranges)
        mass, lever = float(tree.masses[i]), np.asarray(tree.levers[i], dtype=float)
        inertia = pin.Inertia(mass, frames[i].T @ lever, mass * radii)
        model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
    return model


def _frame_about(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a rotation whose third column is ``axis``; of entries 0, +-1 where axis is."""
    helper = np.eye(3)[(int(np.argmax(np.abs(axis))) + 1) % 3]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])
