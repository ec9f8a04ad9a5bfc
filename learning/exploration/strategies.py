"""Learning while moving: constrained direction sampling, goal babbling, motor babbling."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Arm, GuidedArm, Outcome
from isotorque.learning.exploration.exploration import Counts, Exploration, ExplorationStep, Learner
from isotorque.learning.exploration.exploration_region import ExplorationRegion
from isotorque.learning.exploration.explored_share import ExploredShare
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.static_projection import StaticTorques
from isotorque.learning.exploration.targets import (
    DirectionTargets,
    Domain,
    GoalTargets,
    Target,
    TargetSource,
)
from isotorque.symbolic.common.angles import wrap

__all__ = [
    "ConstrainedDirectionSampling",
    "ConstrainedGoalBabbling",
    "Counts",
    "DirectionSampling",
    "Exploration",
    "ExplorationSettings",
    "ExplorationStep",
    "GoalBabbling",
    "GuidedArm",
    "GuidedDirectionSampling",
    "MotorBabbling",
]

Vector = NDArray[np.float64]


class ConstrainedDirectionSampling(Exploration):
    """Algorithm 2: random directions through the BCTS, torques kept in the set of static torques.

    Parameters and attributes as in ``Exploration``; ``static_torques`` and ``domain`` are what
    constrains it.

    Notes
    -----
    Readings of the paper: where the arm moves away from the intended direction (alpha < 0) the
    sample is kept, the target is reset to the previously observed configuration and a new
    direction is drawn; a visit home is one step, followed by a new direction; a torque that ends
    at a limit or in a time out is marked inadmissible and not learned, the arm starts again from
    home.

    References
    ----------
    Rayyes, Kubus, Steil (2018), section 5.2, Algorithm 2; Rolf (2013), "Goal babbling with unknown
    ranges: a direction-sampling approach", ICDL.
    """

    def __init__(
        self,
        arm: Arm,
        learner: Learner,
        rng: np.random.Generator,
        *,
        static_torques: StaticTorques,
        domain: Domain | None,
        torque_range: Any,
        home_torque: Any = None,
        settings: ExplorationSettings | None = None,
        explored: ExploredShare | None = None,
    ) -> None:
        super().__init__(
            arm,
            learner,
            rng,
            torque_range=torque_range,
            home_torque=home_torque,
            static_torques=static_torques,
            domain=domain,
            settings=settings,
            explored=explored,
        )

    def _make_targets(self, home: Vector) -> TargetSource:
        return _direction_targets(self, home)


class DirectionSampling(Exploration):
    """Direction Sampling without constraints (Rolf 2013), for comparison.

    Every torque is applied as it is, and what happened at a joint limit is learned as well when
    ``settings.learn_inadmissible`` says so. Pass ``domain=JointBox(limits)`` to keep targets
    within the joint limits.
    """

    def _make_targets(self, home: Vector) -> TargetSource:
        return _direction_targets(self, home)


class GuidedDirectionSampling(Exploration):
    """Direction sampling with a guided arm: every target is reached and held.

    Parameters
    ----------
    arm : GuidedArm
        The arm.
    domain : Domain or None
        Where targets may lie (the BCTS).
    **options
        As in ``Exploration``, by keyword; torques are measured, so there is neither noise nor a
        set of static torques.

    Notes
    -----
    For what an arm cannot hold by itself: with constant torques it settles in stable
    configurations alone, and on the 3R arm four fifths of all orbits have none. A departure from
    learning without a controller, and counted as such. Targets are wrapped to [-pi, pi].
    """

    def __init__(
        self,
        arm: GuidedArm,
        learner: Learner,
        rng: np.random.Generator,
        *,
        domain: Domain | None,
        torque_range: Any,
        settings: ExplorationSettings | None = None,
        explored: ExploredShare | None = None,
    ) -> None:
        super().__init__(
            arm,
            learner,
            rng,
            torque_range=torque_range,
            domain=domain,
            settings=settings,
            explored=explored,
        )
        self._guided = arm

    def _make_targets(self, home: Vector) -> TargetSource:
        return _direction_targets(self, home)

    def _hold_home(self) -> Outcome:
        return self._guided.hold()

    def _command(self, home: Vector) -> tuple[Target | None, Vector]:
        assert self._targets is not None
        return self._targets.next(self._rng), np.zeros(len(home))

    def _execute(self, target: Target | None, torque: Vector) -> Outcome:
        assert target is not None
        self._guided.place(wrap(target.q))
        return self._guided.hold()


class GoalBabbling(Exploration):
    """Goal Babbling: straight paths between given goals (Rolf et al. 2011).

    Parameters
    ----------
    goals : (m, n) array
        Configurations to be learned to reach [rad].
    **options
        As in ``Exploration``, by keyword.

    Notes
    -----
    Unconstrained without ``static_torques`` and ``domain``; there is no test of alpha, as there
    is no direction to lose.
    """

    def __init__(
        self, arm: Arm, learner: Learner, rng: np.random.Generator, goals: Any, **options: Any
    ) -> None:
        super().__init__(arm, learner, rng, **options)
        self._goals = np.atleast_2d(np.asarray(goals, dtype=float))

    def _make_targets(self, home: Vector) -> TargetSource:
        return GoalTargets(
            home,
            self._goals,
            self.settings.step_width,
            self._weights,
            self.settings.home_probability,
            self._domain,
        )


class ConstrainedGoalBabbling(GoalBabbling):
    """Goal Babbling with torques kept in the set of static torques (section 5.1 of the paper).

    Parameters
    ----------
    goals : (m, n) array
        Configurations to be learned to reach [rad], inside the domain.
    static_torques, domain
        The constraints.
    **options
        As in ``Exploration``, by keyword.
    """

    def __init__(
        self,
        arm: Arm,
        learner: Learner,
        rng: np.random.Generator,
        goals: Any,
        *,
        static_torques: StaticTorques,
        domain: Domain | None = None,
        **options: Any,
    ) -> None:
        super().__init__(
            arm, learner, rng, goals, static_torques=static_torques, domain=domain, **options
        )


class MotorBabbling(Exploration):
    """Random torques, uniform within the torque ranges: the comparison that wants to go nowhere.

    Parameters and attributes as in ``Exploration``; ``domain`` has no meaning here. With
    ``static_torques`` the torques are moved to the nearest static torque as everywhere.
    """

    def _make_targets(self, home: Vector) -> None:
        return None

    def _command(self, home: Vector) -> tuple[Target | None, Vector]:
        return None, self._rng.uniform(-self._range, self._range)


def _direction_targets(exploration: Exploration, home: Vector) -> DirectionTargets:
    settings = exploration.settings
    domain: Any = exploration._domain
    if hasattr(domain, "halfspaces"):
        domain = ExplorationRegion(domain)
    return DirectionTargets(
        home, settings.step_width, exploration._weights, settings.home_probability, domain
    )
