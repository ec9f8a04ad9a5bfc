"""Arms whose masses, and with them all torques, are multiplied by one factor."""

import numpy as np
import pinocchio as pin

from isotorque.symbolic.robots.load_robot import load_robot


def scaled(robot, factor):
    """The robot with masses, tensors of inertia, damping, friction and effort limits times factor.

    Its angles, times and symmetries are those of the robot, its torques ``factor`` times as large.
    """
    model = robot.model.copy()
    for i in range(model.njoints):
        inertia = model.inertias[i]
        model.inertias[i] = pin.Inertia(
            factor * inertia.mass, inertia.lever, factor * inertia.inertia
        )
    model.armature = factor * model.armature
    for name in ("Effort", "DryFriction"):
        for side in ("upper", "lower"):
            limit = np.array(getattr(model, f"{side}{name}Limit"))
            limit[np.abs(limit) < 1e300] *= factor
            setattr(model, f"{side}{name}Limit", limit)
    model.damping = factor * model.damping
    return load_robot(model)
