"""Online learning run on a simulated arm, and its error as samples come in."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.exploration.exploration import ExplorationStep
from isotorque.learning.exploration.strategies import (
    Exploration,
    ExplorationSettings,
    GuidedDirectionSampling,
)
from isotorque.learning.scheme import Discovery, LearnerFactory, Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.paper.experiments.measured import rmse
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.paper_targets import paper_targets
from isotorque.verify.models.stability import has_stable_image
from isotorque.verify.models.target_sets import dense_targets

Array = NDArray[np.float64]
DENSE, STABLE, COUNTED = "dense", "dense, orbits with a stable member", "{} targets"


@dataclass(frozen=True, eq=False)
class TestSets:
    """Configurations to test on and the torques they need.

    Attributes
    ----------
    q, torque : dict of str to (m, n) array
        By name of the set: ``dense``, its part whose orbits an arm can hold, the paper's targets.
    """

    __test__ = False  # not a test of pytest's

    q: dict[str, Array]
    torque: dict[str, Array]

    @classmethod
    def of(cls, robot: Robot, gravity: GravityModel, group: SymmetryGroup) -> TestSets:
        """Return the dense set, its stable part and the paper's targets."""
        dense = dense_targets(robot.limits).q
        sets = {DENSE: dense, STABLE: dense[has_stable_image(dense, gravity, group)]}
        for targets in paper_targets(robot):
            sets[COUNTED.format(len(targets.q))] = targets.q
        return cls(sets, {name: gravity.torque(q) for name, q in sets.items()})

    def errors(self, learner: Any) -> dict[str, float]:
        """Return the torque RMSE of a learner on each set [N m]."""
        return {
            name: rmse(np.asarray(learner.predict(q)) - self.torque[name])
            for name, q in self.q.items()
        }


@dataclass(eq=False)
class LearningRun:
    """A finished run.

    Attributes
    ----------
    robot, gravity, group
        The arm and its truth.
    sets : TestSets
    learner
        What was learned.
    domain : FundamentalDomain or None
        Where it explored.
    motions : list of Discovery
        The discovery before; empty with given symmetries.
    samples : list of int
        Settled samples at each evaluation.
    errors : list of dict
        Torque RMSE by test set then [N m].
    explored_q : list of arrays
        Configurations learned from [rad].
    explored : list
        Share of the domain explored at each evaluation; None where that is not watched.
    inadmissible, commands : int
        Torques that the arm could not hold, of all commanded.
    """

    robot: Robot
    gravity: GravityModel
    group: SymmetryGroup
    sets: TestSets
    learner: Any = None
    domain: FundamentalDomain | None = None
    motions: list[Discovery] = field(default_factory=list)
    samples: list[int] = field(default_factory=list)
    errors: list[dict[str, float]] = field(default_factory=list)
    explored_q: list[Array] = field(default_factory=list)
    explored: list[float | None] = field(default_factory=list)
    inadmissible: int = 0
    commands: int = 0

    def at(self, samples: int, name: str) -> float:
        """Torque RMSE after so many samples, at the evaluation nearest to them [N m]."""
        place = int(np.argmin(np.abs(np.array(self.samples) - samples)))
        return self.errors[place][name]

    def reached(self, name: str, threshold: float) -> int | None:
        """Samples after which the error stays at or below a threshold; None: never."""
        first = None
        for samples, errors in zip(reversed(self.samples), reversed(self.errors), strict=True):
            if errors[name] > threshold:
                break
            first = samples
        return first


def open_loop_run(
    robot: Robot,
    make: LearnerFactory,
    settings: ExplorationSettings,
    samples: int,
    seed: int,
    every: Callable[[int], int],
    n_min: int | None = None,
) -> LearningRun:
    """Discover symmetries, then explore and learn: Fig. 8 on an arm without controller.

    Parameters
    ----------
    robot
        The arm.
    make
        Makes the learner for the symmetries that were learned.
    settings
        Of Constrained Direction Sampling.
    samples
        Torques commanded while learning.
    seed
        Of everything.
    every
        Samples until the next evaluation, given those so far.
    n_min
        Relations needed before learning begins; by default the arm's number of symmetries, as
        the paper sets it.
    """
    run = _new_run(robot)
    needed = run.group.order if n_min is None else n_min
    scheme = Scheme(
        SimulatedArm(robot),
        np.random.default_rng(seed),
        make,
        SchemeSettings(samples=samples, exploration=settings, n_min=needed, from_trajectories=True),
    )
    run.motions = list(scheme.discover())
    steps = scheme.learn()
    first = next(steps)
    assert scheme.exploration is not None
    run.learner, run.domain = scheme.learner, scheme.domain
    _follow(run, scheme.exploration, _after(first, steps), every)
    return run


def guided_run(
    robot: Robot,
    make: LearnerFactory,
    settings: ExplorationSettings,
    samples: int,
    seed: int,
    every: Callable[[int], int],
) -> LearningRun:
    """Explore with an arm that is guided to each target and held; exact symmetries.

    Parameters are those of `open_loop_run`.
    """
    run = _new_run(robot)
    arm = SimulatedArm(robot, physics="guided")
    torques = np.abs(run.sets.torque[DENSE]).max(axis=0)
    run.learner = make(run.group, torques)
    run.domain = FundamentalDomain.near(run.group, arm.q)
    exploration = GuidedDirectionSampling(
        arm,
        run.learner,
        np.random.default_rng(seed),
        domain=run.domain,
        torque_range=torques,
        settings=settings,
    )
    _follow(run, exploration, exploration.steps(samples), every)
    return run


def _new_run(robot: Robot) -> LearningRun:
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    return LearningRun(robot, gravity, group, TestSets.of(robot, gravity, group))


def _after(first: ExplorationStep, rest: Iterator[ExplorationStep]) -> Iterator[ExplorationStep]:
    yield first
    yield from rest


def _follow(
    run: LearningRun,
    exploration: Exploration,
    steps: Iterator[ExplorationStep],
    every: Callable[[int], int],
) -> None:
    evaluate_at = every(0)
    settled = 0
    share: float | None = None
    for step in steps:
        if step.learned:
            run.explored_q.append(np.array(step.outcome.q))
        share = step.explored
        settled = exploration.counts.settled
        if settled >= evaluate_at:
            _evaluate(run, settled, share)
            evaluate_at = settled + every(settled)
    if not run.samples or run.samples[-1] < settled:
        _evaluate(run, settled, share)
    run.inadmissible = exploration.counts.inadmissible
    run.commands = exploration.counts.commands


def _evaluate(run: LearningRun, samples: int, share: float | None) -> None:
    run.samples.append(samples)
    run.explored.append(share)
    run.errors.append(run.sets.errors(run.learner))
