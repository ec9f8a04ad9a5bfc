"""Learning while moving: constrained direction sampling, goal babbling, motor babbling."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from learning.arm import Arm
from learning.exploration_loop import Exploration, Learner, StaticTorques
from learning.exploration_settings import ExplorationSettings
from learning.exploration_step import Counts, ExplorationStep
from learning.explored_share import ExploredShare
from learning.targets import DirectionTargets, Domain, GoalTargets, Target, TargetSource

__all__ = [
    "ConstrainedDirectionSampling",
    "ConstrainedGoalBabbling",
    "Counts",
    "DirectionSampling",
    "Exploration",
    "ExplorationSettings",
    "ExplorationStep",
    "GoalBabbling",
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
            arm, learner, rng, torque_range=torque_range, home_torque=home_torque,
            static_torques=static_torques, domain=domain, settings=settings, explored=explored,
        )  # fmt: skip

    def _make_targets(self, home: Vector) -> TargetSource:
        return DirectionTargets(
            home,
            self.settings.step_width,
            self._weights,
            self.settings.home_probability,
            self._domain,
        )


class DirectionSampling(Exploration):
    """Direction Sampling without constraints (Rolf 2013), for comparison.

    Every torque is applied as it is, and what happened at a joint limit is learned as well when
    ``settings.learn_inadmissible`` says so. Pass ``domain=JointBox(limits)`` to keep targets
    within the joint limits.
    """

    def _make_targets(self, home: Vector) -> TargetSource:
        return DirectionTargets(
            home,
            self.settings.step_width,
            self._weights,
            self.settings.home_probability,
            self._domain,
        )


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
