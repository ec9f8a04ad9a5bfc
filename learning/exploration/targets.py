"""Targets of exploration: directions through a domain, or given goals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Vector = NDArray[np.float64]

#: Directions tried before the home configuration is the next target instead.
TRIES = 50
#: A step that must be shortened below this share to stay in the domain is not worth taking.
LEAST_SHARE = 0.1
#: Steps of the search for the boundary of a domain that only says what it contains.
BISECTIONS = 7


class Phase(StrEnum):
    """Why a target was chosen."""

    START = "start"
    DIRECTION = "direction"
    GOAL = "goal"
    HOME = "home"
    MOTOR = "motor"


class Domain(Protocol):
    """The part of the configuration space to explore (``FundamentalDomain``)."""

    def contains(self, q: Vector) -> Any:
        """Whether the configuration (n,) [rad] lies in the domain."""
        ...


@dataclass(frozen=True, eq=False)
class JointBox:
    """The configurations within joint limits, as a domain.

    Attributes
    ----------
    limits : (n, 2) array
        Lower and upper joint limits [rad].
    """

    limits: NDArray[np.float64]

    def contains(self, q: Vector) -> bool:
        """Whether every joint angle of q (n,) [rad] is within its limits."""
        q = np.asarray(q)
        return bool(np.all((q >= self.limits[:, 0]) & (q <= self.limits[:, 1])))


@dataclass(frozen=True, eq=False)
class Target:
    """The next configuration to try.

    Attributes
    ----------
    q : (n,) array
        Target configuration q*_t [rad].
    step : (n,) array or None
        ``q*_t - q*_(t-1)`` where a direction is followed; None where none is (home, start).
    phase : Phase
        Why it was chosen.
    """

    q: Vector
    step: Vector | None
    phase: Phase


class TargetSource(Protocol):
    """Source of an exploration's targets."""

    def next(self, rng: np.random.Generator) -> Target:
        """The next target."""
        ...

    def restart(self, q: Vector) -> None:
        """Go on from configuration q (n,) [rad] in a new direction."""
        ...


class DirectionTargets:
    """Targets along random directions (Eq. 13), inside a domain.

    Parameters
    ----------
    home : (n,) array
        Home configuration [rad], the first target.
    step_width : float
        epsilon: weighted length of one step [rad].
    weights : (n,) array
        w of Eq. 13: lengths are ``|w * dq|``. Zero keeps a joint where it is.
    home_probability : float
        Probability of choosing home as the next target; a new direction follows.
    domain : Domain or None
        Targets stay inside (the BCTS); None: anywhere.

    Notes
    -----
    A target that would leave the domain ends the direction. It is moved to the nearest point of
    the domain (``ExplorationRegion``; along the step where the domain cannot tell), so that targets
    reach the boundary and its corners; then a new direction is drawn. From outside (home, or an
    observed configuration) targets approach the domain step by step. Eq. 13 prints ``|w^T dq|``
    where the norm ``|w * dq|`` is meant.
    """

    def __init__(
        self,
        home: Vector,
        step_width: float,
        weights: Vector,
        home_probability: float,
        domain: Domain | None = None,
    ) -> None:
        self._home = np.asarray(home, dtype=float)
        self._weights = np.asarray(weights, dtype=float)
        if not (step_width > 0 and np.isfinite(step_width)):
            raise InputError("targets", "step width", step_width, "a number > 0 [rad]")
        if self._weights.shape != self._home.shape or not (self._weights >= 0).all():
            raise InputError("targets", "weights", weights, "one number >= 0 per joint")
        if not self._weights.any():
            raise InputError("targets", "weights", weights, "at least one number > 0")
        if not 0 <= home_probability <= 1:
            raise InputError("targets", "home probability", home_probability, "0 to 1")
        self._step_width = step_width
        self._home_probability = home_probability
        self._domain = domain
        self._current = self._home
        self._direction: Vector | None = None

    def next(self, rng: np.random.Generator) -> Target:
        """The next target: a step in the present direction, or home."""
        if rng.random() < self._home_probability:
            return self._go_home()
        for _ in range(TRIES):
            if self._direction is None:
                self._direction = self._draw(rng)
            step, inside = self._inside(self._direction)
            if np.linalg.norm(self._weights * step) > LEAST_SHARE * self._step_width:
                self._current = self._current + step
                if not inside:
                    self._direction = None
                return Target(self._current, step, Phase.DIRECTION)
            self._direction = None
        return self._go_home()

    def restart(self, q: Vector) -> None:
        """Go on from q (n,) [rad] in a new direction."""
        self._current = np.asarray(q, dtype=float)
        self._direction = None

    def _go_home(self) -> Target:
        self.restart(self._home)
        return Target(self._home, None, Phase.HOME)

    def _draw(self, rng: np.random.Generator) -> Vector:
        direction = rng.standard_normal(len(self._home))
        direction[self._weights == 0] = 0.0
        length = np.linalg.norm(self._weights * direction)
        return np.asarray(self._step_width / length * direction)

    def _inside(self, step: Vector) -> tuple[Vector, bool]:
        """The step, or what remains of it within the domain; whether it is whole."""
        domain = self._domain
        if domain is None or domain.contains(self._current + step):
            return step, True
        nearest = getattr(domain, "nearest", None)
        if nearest is not None:
            step = np.asarray(nearest(self._current + step) - self._current)
            length = float(np.linalg.norm(self._weights * step))
            return step * min(1.0, self._step_width / max(length, 1e-300)), False
        if not domain.contains(self._current):
            return np.zeros_like(step), False
        inside, outside = 0.0, 1.0
        for _ in range(BISECTIONS):
            middle = 0.5 * (inside + outside)
            if domain.contains(self._current + middle * step):
                inside = middle
            else:
                outside = middle
        return inside * step, False


class GoalTargets:
    """Targets on straight paths between randomly chosen given goals (Goal Babbling).

    Parameters
    ----------
    home : (n,) array
        Home configuration [rad], where the first path starts.
    goals : sequence of (n,) arrays
        Configurations to be reached [rad].
    step_width : float
        Weighted length of one step [rad].
    weights : (n,) array
        w of Eq. 13.
    home_probability : float
        Probability of choosing home as the next target; the path goes on from there.
    domain : Domain or None
        Goals outside are refused.

    Notes
    -----
    Paths take the shorter way round where angles wrap.
    """

    def __init__(
        self,
        home: Vector,
        goals: Sequence[Vector] | NDArray[np.float64],
        step_width: float,
        weights: Vector,
        home_probability: float,
        domain: Domain | None = None,
    ) -> None:
        self._home = np.asarray(home, dtype=float)
        self._goals = np.atleast_2d(np.asarray(goals, dtype=float))
        if self._goals.shape[1:] != self._home.shape or not np.isfinite(self._goals).all():
            raise InputError(
                "targets", "shape of the goals", self._goals.shape, f"(m, {len(self._home)})"
            )
        if domain is not None:
            for goal in self._goals:
                if not domain.contains(goal):
                    raise InputError("targets", "goal", goal, "a configuration inside the domain")
        if not (step_width > 0 and np.isfinite(step_width)):
            raise InputError("targets", "step width", step_width, "a number > 0 [rad]")
        self._step_width = step_width
        self._weights = np.asarray(weights, dtype=float)
        self._home_probability = home_probability
        self._current = self._home
        self._goal: Vector | None = None

    def next(self, rng: np.random.Generator) -> Target:
        """The next target: a step towards the present goal, or home."""
        if rng.random() < self._home_probability:
            self._current = self._home
            return Target(self._home, None, Phase.HOME)
        if self._goal is None:
            self._goal = self._goals[rng.integers(len(self._goals))]
        way = wrap(self._goal - self._current)
        length = float(np.linalg.norm(self._weights * way))
        if length > self._step_width:
            way = way * (self._step_width / length)
        else:
            self._goal = None
        self._current = self._current + way
        return Target(self._current, way, Phase.GOAL)

    def restart(self, q: Vector) -> None:
        """Go on from q (n,) [rad] to another goal."""
        self._current = np.asarray(q, dtype=float)
        self._goal = None
