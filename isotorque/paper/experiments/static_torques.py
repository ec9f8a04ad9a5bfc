"""Section 5.1: exploring with and without the set of static torques (Fig. 7)."""

from __future__ import annotations

from typing import Any

import numpy as np

from isotorque.learning.arm import Settled
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.strategies import (
    ConstrainedGoalBabbling,
    DirectionSampling,
    Exploration,
    GoalBabbling,
)
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.paper.experiments.learning_run import DENSE, TestSets
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.experiments.online import iterated
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.report.summaries import thinned

COMMANDS, GOALS = 1000, 30
STEPS = ExplorationSettings()
PLAIN = ExplorationSettings(learn_inadmissible=True)
SHOWN = 1000


def measure_static_torques(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Count inadmissible torques in Goal Babbling and Direction Sampling, with and without SST.

    The originals have the same arm, learner, symmetries, step and noise; their torques are applied
    as they are, and what happened at a joint limit is learned too, as the paper says it disturbs.
    """
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    sets = TestSets.of(robot, gravity, group)
    commands = effort.of(COMMANDS, 50)
    numbers: dict[str, Any] = {}
    pictures: dict[str, Any] = {}

    def count(name: str, exploration: Exploration, learner: Any, steps: Any) -> None:
        held: list[Any] = []
        refused: list[Any] = []
        for step in steps:
            (held if isinstance(step.outcome, Settled) else refused).append(step.torque)
        counts = exploration.counts
        numbers[f"{name}_share"] = counts.inadmissible / counts.commands
        numbers[f"{name}_rmse"] = sets.errors(learner)[DENSE]
        kept = [np.array(x).reshape(len(x), robot.n) for x in (held, refused)]
        pictures[name] = {"held": thinned(kept[0], SHOWN), "refused": thinned(kept[1], SHOWN)}

    def discovered() -> Scheme:
        settings = SchemeSettings(samples=commands, exploration=STEPS, n_min=group.order)
        scheme = Scheme(SimulatedArm(robot), np.random.default_rng(seed), iterated, settings)
        for _ in scheme.discover():
            pass
        return scheme

    scheme = discovered()
    steps = list(scheme.learn())
    assert scheme.exploration is not None
    count("constrained_sampling", scheme.exploration, scheme.learner, steps)
    torques, known, domain = scheme.torque_range, scheme.group, scheme.domain
    low, high = SimulatedArm(robot).limits.T
    rng = np.random.default_rng(seed)
    goals = (
        rng.uniform(low, high, (GOALS, robot.n)) if domain is None else domain.sample(rng, GOALS)
    )

    constrained = iterated(known, torques)
    babbling = ConstrainedGoalBabbling(
        SimulatedArm(robot),
        constrained,
        np.random.default_rng(seed),
        goals,
        static_torques=discovered().static_torques,
        domain=domain,
        torque_range=torques,
        settings=STEPS,
    )
    count("constrained_babbling", babbling, constrained, babbling.steps(commands))

    free = iterated(known, torques)
    original = GoalBabbling(
        SimulatedArm(robot),
        free,
        np.random.default_rng(seed),
        goals,
        torque_range=torques,
        settings=PLAIN,
    )
    count("babbling", original, free, original.steps(commands))

    free = iterated(known, torques)
    sampling = DirectionSampling(
        SimulatedArm(robot),
        free,
        np.random.default_rng(seed),
        torque_range=torques,
        settings=PLAIN,
    )
    count("sampling", sampling, free, sampling.steps(commands))
    return Measured(numbers, pictures)
