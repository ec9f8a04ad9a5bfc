"""Causes of torque as an arm would have them, written without the code under test."""

import numpy as np

from isotorque.learning.statistics.causes.extension import Shape


def torque_beside(shape, angle, direction):
    """Torque (m,) of one unit of a cause that adds to the torque of its joint."""
    return {
        Shape.CONSTANT: np.ones_like(angle),
        Shape.ANGLE: angle,
        Shape.COSINE: np.cos(2.0 * angle),
        Shape.SINE: np.sin(2.0 * angle),
        Shape.DIRECTION: direction,
    }[shape]
