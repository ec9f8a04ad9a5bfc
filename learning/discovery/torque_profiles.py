"""Torque profiles: smooth torque curves that leave a torque and come back to its size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


SAME_SIZE = 1e-9
"""Sizes that differ by less, relative to the largest of the torques, count as equal."""


@dataclass(frozen=True)
class ProfileShape:
    """From which distributions torque profiles are drawn (p_n and p_tau of Algorithm 1).

    Attributes
    ----------
    step_seconds : float
        Time between two torque commands [s].
    seconds : (float, float)
        Shortest and longest duration of a profile [s]; uniformly drawn (p_n, times the step).
    knots : (int, int)
        Fewest and most intermediate torques a spline passes through.
    reach : float
        Intermediate torques are uniform within ``reach`` times the torque scale of each joint
        (p_tau). Above 1 a profile may throw the arm over the top into another static equilibrium.
    """

    step_seconds: float = 0.02
    seconds: tuple[float, float] = (2.0, 6.0)
    knots: tuple[int, int] = (1, 4)
    reach: float = 1.5

    def __post_init__(self) -> None:
        if not self.step_seconds > 0:
            raise InputError("torque profiles", "step_seconds", self.step_seconds, "> 0 [s]")
        if not 0 < self.seconds[0] <= self.seconds[1]:
            raise InputError("torque profiles", "seconds", self.seconds, "0 < shortest <= longest")
        if not 1 <= self.knots[0] <= self.knots[1]:
            raise InputError("torque profiles", "knots", self.knots, "1 <= fewest <= most")


def draw_profile(
    start: ArrayLike,
    end: ArrayLike,
    scale: ArrayLike,
    rng: np.random.Generator,
    shape: ProfileShape | None = None,
    centre: ArrayLike = 0.0,
) -> Array:
    """Draw a torque profile between two torques of equal absolute value.

    Parameters
    ----------
    start, end : (n,) arrays
        First and last torque, |start| = |end| component by component [N m].
    scale : (n,) array
        Torque scale of each joint [N m].
    rng
        Source of randomness.
    shape
        Distributions; sensible ones by default.
    centre
        Middle of the intermediate torques (n,) [N m].

    Returns
    -------
    (T, n) array
        Torques [N m], one every ``shape.step_seconds``; a cubic spline with zero derivatives at
        both ends.

    Raises
    ------
    InputError
        If the absolute values of start and end differ.

    References
    ----------
    Section 4.1, Fig. 3 and Algorithm 1, line 6 of the paper.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> profile = draw_profile([5.0, 1.0], [5.0, -1.0], [24.0, 6.0], rng)
    >>> profile[0].tolist(), profile[-1].tolist()
    ([5.0, 1.0], [5.0, -1.0])
    """
    first, last = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    close = SAME_SIZE * float(np.abs(first).max(initial=0.0))
    if first.shape != last.shape or not (np.abs(np.abs(first) - np.abs(last)) <= close).all():
        raise InputError("torque profile", "end", last.tolist(), f"+-{np.abs(first).tolist()}")
    if shape is None:
        shape = ProfileShape()
    steps = max(2, round(rng.uniform(*shape.seconds) / shape.step_seconds))
    count = int(rng.integers(shape.knots[0], shape.knots[1], endpoint=True))
    size = shape.reach * np.asarray(scale, dtype=float)
    middle = np.asarray(centre, dtype=float) + rng.uniform(-size, size, (count, len(first)))
    times = np.concatenate([[0.0], np.sort(rng.uniform(0.15, 0.85, count)), [1.0]])
    # knots that nearly coincide would make the spline overshoot without bound
    times[1:-1] = 0.5 * times[1:-1] + 0.5 * np.linspace(0.15, 0.85, count + 2)[1:-1]
    spline = CubicSpline(times, np.vstack([first, middle, last]), bc_type="clamped")
    profile = np.asarray(spline(np.linspace(0.0, 1.0, steps)), dtype=float)
    profile[0], profile[-1] = first, last
    return profile
