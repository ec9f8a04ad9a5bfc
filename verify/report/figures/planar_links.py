"""Positions of the joints of a planar arm, for stick figures."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def planar_links(model: pin.Model, q: ArrayLike) -> Array | None:
    """Return the positions of joints and tip in the plane the arm moves in.

    Parameters
    ----------
    model
        A serial arm of revolute joints.
    q
        Configurations (m, n) [rad].

    Returns
    -------
    (m, n + 1, 2) array or None
        Horizontal and vertical position [m]; None unless all axes are parallel and horizontal.
        The tip is as far beyond the last centre of mass as that is from the last joint: the end
        of a uniform rod.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> planar_links(load_robot("2r").model, [[0.0, np.pi / 2]]).round(3).tolist()
    [[[0.0, 0.0], [0.25, 0.0], [0.25, 0.25]]]
    """
    points = np.atleast_2d(np.asarray(q, dtype=float))
    if list(model.parents[1:]) != list(range(model.njoints - 1)):
        return None
    up = -np.array(model.gravity.linear)
    if not np.linalg.norm(up) > 0:
        return None
    up /= np.linalg.norm(up)
    data = model.createData()
    jacobians = pin.computeJointJacobians(model, data, points[0])  # flat for a single joint
    axes = jacobians.reshape(6, -1)[3:].T
    axis = axes[0]
    if np.any(np.abs(axes @ axis) < 1 - 1e-9) or abs(axis @ up) > 1e-9:
        return None
    # seen against the first axis, turning positively goes from right to up
    right = np.cross(up, axis)
    chains = []
    for configuration in points:
        pin.forwardKinematics(model, data, configuration)
        joints = [np.array(placement.translation) for placement in list(data.oMi)[1:]]
        joints.append(data.oMi[model.njoints - 1].act(2 * model.inertias[model.njoints - 1].lever))
        chains.append([[p @ right, p @ up] for p in joints])
    return np.array(chains)
