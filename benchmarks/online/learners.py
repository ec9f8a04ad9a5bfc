"""The learners of the table and the settings they explore with."""

from __future__ import annotations

from typing import Any

from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares

LITERAL = ExplorationSettings(noise=0.01, step_width=0.15)
QUICK = ExplorationSettings(noise=0.01, step_width=0.3)
WIDE = ExplorationSettings(noise=0.02, step_width=0.5)
GUIDED = ExplorationSettings(step_width=0.6)


def literal(group: Any, _: Any = None) -> LocalLinearMap:
    """Eq. 17-22 as printed."""
    return LocalLinearMap(0.15, learning_rate=0.7, group=group)


def replayed(group: Any, _: Any = None) -> LocalLinearMap:
    """The same with a wide kernel, full inner iterations and replay."""
    return LocalLinearMap(
        0.3, kernel_width=2.5, inner_iterations=None, relaxation=0.6, replay=60, group=group
    )


def replayed_3r(group: Any, _: Any = None) -> LocalLinearMap:
    """The same for the 3R arm, with prototypes farther apart."""
    return LocalLinearMap(
        0.5, kernel_width=2.0, inner_iterations=None, relaxation=0.6, replay=60, group=group
    )


def joint(group: Any, _: Any = None) -> RecursiveLeastSquares:
    """Recursive least squares on the tied basis."""
    return RecursiveLeastSquares(group=group)


def joint_for_noise(group: Any, _: Any = None) -> RecursiveLeastSquares:
    """The same with a ridge for noisy labels."""
    return RecursiveLeastSquares(ridge=1e-5, group=group)
