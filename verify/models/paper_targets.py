"""The paper's test targets, as far as it specifies them."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.target_sets import TargetSet, grid_targets, scattered_targets

QUARTER, HALF = np.pi / 2, np.pi


def paper_targets(robot: Robot) -> tuple[TargetSet, ...]:
    """Return the target sets of section 7 for the paper's two arms, none for others.

    Notes
    -----
    The paper gives numbers of targets, not targets: 66 on a grid in the BCTS is read as 6 x 11,
    64 on a grid as 4 x 4 x 4 inside the configuration space; the 90 and the 84 scattered ones are
    drawn.
    """
    if robot.name == "2r":
        parallelogram = [[QUARTER, -QUARTER], [0.0, HALF]]
        return (
            grid_targets([0.0, 0.0], parallelogram, (6, 11)),
            scattered_targets(robot.limits, 90, seed=90),
            scattered_targets(robot.limits, 84, seed=84),
        )
    if robot.name == "3r":
        cell = 2 * np.pi / 4
        corner = np.full(3, -np.pi + cell / 2)
        return (grid_targets(corner, np.eye(3) * (2 * np.pi - cell), (4, 4, 4)),)
    return ()
