"""The 2R arm, and configurations that it can hold."""

import numpy as np

from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.robots.load_robot import load_robot

ROBOT = load_robot("2r")
ARM = SimulatedArm(ROBOT)
GRAVITY = ARM.equations.gravity_torque


def stable_targets(count, seed=0, margin=0.2):
    """Draw configurations of the stable region of the 2R arm: both links below the horizontal."""
    rng = np.random.default_rng(seed)
    first = rng.uniform(-np.pi + margin, -margin, count)
    both = rng.uniform(-np.pi + margin, -margin, count)
    return np.column_stack([first, both - first])
