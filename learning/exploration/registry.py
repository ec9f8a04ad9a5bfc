"""The explorations by the names the command line knows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.exploration.exploration import Exploration, Learner
from isotorque.learning.exploration.strategies import (
    ConstrainedDirectionSampling,
    ConstrainedGoalBabbling,
    GuidedDirectionSampling,
    MotorBabbling,
)
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain

Array = NDArray[np.float64]

DIRECTIONS, GOALS, MOTORS = "direction-sampling", "goal-babbling", "motor-babbling"
EXPLORATIONS = (DIRECTIONS, GOALS, MOTORS)
GUIDED_DIRECTIONS = "guided-direction-sampling"
"""Direction sampling with a guided arm, see `GuidedDirectionSampling`."""
GOAL_COUNT = 64
"""Goals of goal babbling, the number of the paper's targets for its 3R arm."""


def check_exploration(name: str) -> str:
    """Return the name of an exploration, checked.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    known = (*EXPLORATIONS, GUIDED_DIRECTIONS)
    if name not in known:
        raise InputError("exploration", "strategy", name, ", ".join(known))
    return name


def exploration_by_name(
    name: str,
    arm: Any,
    learner: Learner,
    rng: np.random.Generator,
    *,
    domain: FundamentalDomain | None,
    seen: Array,
    **options: Any,
) -> Exploration:
    """Return a constrained exploration, ready to go.

    Parameters
    ----------
    name
        ``direction-sampling``: random directions through the domain (Algorithm 2).
        ``goal-babbling``: straight paths between goals spread over the domain.
        ``motor-babbling``: random torques, moved to the nearest static torque.
        ``guided-direction-sampling``: as the first, with a guided arm.
    arm, learner, rng
        As in ``Exploration``.
    domain
        The BCTS; None: no symmetries are known. Goals are then drawn from the range of angles
        ``seen``.
    seen : (k, n) array
        Configurations observed so far [rad].
    **options
        The other parameters of ``Exploration``, by keyword.

    Raises
    ------
    InputError
        If there is no exploration of that name.
    """
    check_exploration(name)
    if name == DIRECTIONS:
        return ConstrainedDirectionSampling(arm, learner, rng, domain=domain, **options)
    if name == GUIDED_DIRECTIONS:
        guided = {k: v for k, v in options.items() if k not in ("static_torques", "home_torque")}
        return GuidedDirectionSampling(arm, learner, rng, domain=domain, **guided)
    if name == MOTORS:
        return MotorBabbling(arm, learner, rng, **options)
    goals = _goals(domain, seen, rng)
    return ConstrainedGoalBabbling(arm, learner, rng, goals, domain=domain, **options)


def _goals(domain: FundamentalDomain | None, seen: Array, rng: np.random.Generator) -> Array:
    if domain is None:
        return rng.uniform(seen.min(axis=0), seen.max(axis=0), (GOAL_COUNT, seen.shape[1]))
    return lattice_samples(SamplingRegion.of_domain(domain), GOAL_COUNT, rng, exact=False).q
