"""Experiment of the paper, and its measurements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import Robot

Number = float | int | None
"""A measured number; None stands for one that was not reached."""


@dataclass(frozen=True)
class Effort:
    """Share of the paper's number of samples that is spent.

    Attributes
    ----------
    share : float
        1 is the paper's; less is for a first look, and then few rows hold.
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.share <= 1.0:
            raise InputError("paper", "effort", self.share, "above 0, at most 1")

    def of(self, count: int, least: int = 1) -> int:
        """Return that share of a number of samples, at least so many.

        Examples
        --------
        >>> Effort(0.01).of(54_000, 100), Effort(0.01).of(66, 20)
        (540, 20)
        """
        return min(count, max(least, round(self.share * count)))


@dataclass(frozen=True, eq=False)
class Measured:
    """Result of an experiment on one seed.

    Attributes
    ----------
    numbers : dict
        Measured numbers by name (a number, None where something was not reached, or nested lists
        of numbers).
    pictures : dict
        Arrays that figures are drawn from, by name; nested dicts and lists allowed.
    """

    numbers: dict[str, Any]
    pictures: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Experiment:
    """One experiment: a function of robot, seed and effort.

    Attributes
    ----------
    name : str
        Unique; also the name of its files.
    part : str
        ``2r``, ``3r`` or ``batch``: the argument of ``isotorque paper`` that asks for it.
    robot : str
        Built-in name of the paper's arm.
    measure : callable
        ``measure(robot, seed, effort)``; must be importable, other processes call it.
    minutes : float
        Rough cost, so that long ones are begun first.
    """

    name: str
    part: str
    robot: str
    measure: Callable[[Robot, int, Effort], Measured]
    minutes: float = 0.1


def rmse(errors: Any) -> float:
    """Return the root of the mean of squared torque errors [N m]."""
    return float(np.sqrt(np.mean(np.square(errors))))
