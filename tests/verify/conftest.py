"""Arms that the tests of this package judge things against; derived once."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import KnownArm

NAMES = ("pendulum", "2r", "3r", "4r-planar")


@pytest.fixture(scope="session")
def arms():
    """Built-in arms by name."""
    return {name: KnownArm.of(load_robot(name)) for name in NAMES}


@pytest.fixture(scope="session")
def two_link(arms):
    """The paper's 2R arm."""
    return arms["2r"]


@pytest.fixture(scope="session")
def upright():
    """An arm whose first joint is vertical and free."""
    return KinematicTree(
        joint_names=("joint1", "joint2"),
        parents=(-1, 0),
        rotations=np.array([np.eye(3)] * 2),
        translations=np.zeros((2, 3)),
        axes=np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
        masses=np.array([1.0, 2.0]),
        levers=np.array([[0.0, 0.0, 0.1], [0.25, 0.0, 0.0]]),
        gravity=np.array([0.0, 0.0, -9.81]),
    )
