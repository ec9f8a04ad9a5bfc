"""Curves of cost: measured in turns, and how fast they grow."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

LONGEST = 10.0
"""A curve ends with the first point that takes longer [s]."""
PATIENCE = 1.5
"""A point is measured in further turns until so much time was spent on it [s]."""
SHORTEST = 1e-2
"""What takes less is repeated within a turn [s]."""


@dataclass(frozen=True)
class Work:
    """Timed work; one call does it ``count`` times."""

    run: Callable[[], Any]
    count: float = 1.0


@dataclass(frozen=True)
class Curve:
    """A cost that depends on one quantity.

    Attributes
    ----------
    what : str
        What is done.
    x : tuple of int
        Values of the quantity, ascending.
    prepare : callable
        Makes the work for one value; preparing is not timed. The work can be repeated.
    panel : str
        Where it belongs among the curves over the same quantity.
    per : str
        Where it is expected to grow by a factor rather than as a power: per what.
    """

    what: str
    x: tuple[int, ...]
    prepare: Callable[[int], Work]
    panel: str = ""
    per: str = ""


@dataclass(frozen=True, eq=False)
class Measured:
    """The times of a curve; ``stopped`` if further points would have taken too long.

    Attributes
    ----------
    curve : Curve
    x, seconds : (c,) arrays
        Values measured, processor time of each [s].
    stopped : bool
    """

    curve: Curve
    x: Array
    seconds: Array
    stopped: bool = False


@dataclass(frozen=True)
class Growth:
    """Growth of a curve over the upper half of its range.

    Attributes
    ----------
    exponent, exponent_error : float
        Of the power of x, and its standard error (infinite from two points).
    factor, factor_error : float
        Of the exponential: times per step of x by one.
    start : float
        The smallest x looked at.
    scale : float
        Seconds that the power gives at x = 1.
    base : float
        Seconds that the exponential gives at x = 0.
    """

    exponent: float
    exponent_error: float
    factor: float
    factor_error: float
    start: float
    scale: float
    base: float

    def seconds(self, x: Array, exponential: bool) -> Array:
        """The fitted law."""
        if exponential:
            return np.asarray(self.base * self.factor**x)
        return np.asarray(self.scale * x**self.exponent)


def growth(x: ArrayLike, seconds: ArrayLike) -> Growth:
    """Fit a power and an exponential to the upper half of a curve.

    Least squares of log time over log x (over x for the exponential). The upper half is that of
    the range of log x, where costs that do not grow dominate no longer; it has three points at
    least, where there are as many.

    Raises
    ------
    InputError
        For less than two points, or numbers that are not positive.

    Examples
    --------
    >>> found = growth([10, 20, 40, 80], [1.0, 4.0, 16.0, 64.0])
    >>> round(found.exponent, 6), found.start
    (2.0, 20.0)
    """
    x, seconds = np.asarray(x, dtype=float), np.asarray(seconds, dtype=float)
    if x.ndim != 1 or x.shape != seconds.shape or len(x) < 2:
        raise InputError("curve", "points", x.shape, "two or more, one time each")
    if not ((x > 0).all() and (seconds > 0).all() and np.isfinite([x, seconds]).all()):
        raise InputError("curve", "points", "not positive", "positive numbers")
    order = np.argsort(x)
    x, seconds = x[order], seconds[order]
    upper = x >= math.sqrt(x[0] * x[-1]) * (1.0 - 1e-9)
    upper[-3:] = True
    x, logs = x[upper], np.log(seconds[upper])
    exponent, error, constant = _line(np.log(x), logs)
    rate, rate_error, start = _line(x, logs)
    factor = math.exp(rate)
    return Growth(
        exponent,
        error,
        factor,
        factor * rate_error,
        float(x[0]),
        math.exp(constant),
        math.exp(start),
    )


def _line(x: Array, y: Array) -> tuple[float, float, float]:
    """Slope, its standard error and the value at 0 of the line of least squares."""
    away = x - x.mean()
    spread = float(away @ away)
    slope = float(away @ y) / spread
    constant = float(y.mean() - slope * x.mean())
    if len(x) < 3:
        return slope, math.inf, constant
    misfit = y - constant - slope * x
    return slope, math.sqrt(float(misfit @ misfit) / (len(x) - 2) / spread), constant


def measure(
    curves: Sequence[Curve], turns: int = 9, progress: Callable[[str], Any] | None = None
) -> list[Measured]:
    """Time all points of all curves, one after the other, forth and back several times.

    Parameters
    ----------
    curves
        Related ones, which take turns.
    turns
        Each point's time is the median of so many; of fewer where they take long.
    progress
        Is told of each point of the first turn.
    """
    works: dict[tuple[int, int], Work] = {}
    times: dict[tuple[int, int], list[float]] = {}
    ended: dict[int, int] = {}
    for curve in curves:
        curve.prepare(curve.x[0]).run()  # compiles, and fills caches
    points = [
        (position, number)
        for position in range(max(len(curve.x) for curve in curves))
        for number, curve in enumerate(curves)
        if position < len(curve.x)
    ]
    for turn in range(turns):
        for position, number in reversed(points) if turn % 2 else points:
            curve, point = curves[number], (position, number)
            if number in ended and position > ended[number]:
                continue
            if turn == 0:
                works[point], times[point] = curve.prepare(curve.x[position]), []
            work = works[point]
            spent = sum(times[point]) * work.count
            if turn and spent > PATIENCE:
                continue
            times[point].append(_seconds(work) / work.count)
            if turn == 0:
                if times[point][0] * work.count > LONGEST:
                    ended[number] = position
                if progress is not None:
                    progress(f"{curve.panel} {curve.what} {curve.x[position]}: {times[point][0]}")
    found = []
    for number, curve in enumerate(curves):
        count = ended.get(number, len(curve.x) - 1) + 1
        seconds = [statistics.median(times[position, number]) for position in range(count)]
        found.append(
            Measured(
                curve,
                np.array(curve.x[:count], dtype=float),
                np.array(seconds),
                count < len(curve.x),
            )
        )
    return found


def _seconds(work: Work) -> float:
    """Processor time of one call, from several where it is short."""
    start = time.process_time()
    work.run()
    once = time.process_time() - start
    if once >= SHORTEST:
        return once
    repeats = min(1000, math.ceil(SHORTEST / max(once, 1e-9)))
    start = time.process_time()
    for _ in range(repeats):
        work.run()
    return max(time.process_time() - start, 1e-9) / repeats
