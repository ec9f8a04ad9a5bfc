"""Worth of constraints: 1,000 commands of every exploration, with the same learner."""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.online.learners import QUICK, joint, replayed
from benchmarks.online.runs import Plan, Run, all_seeds, explored, scheme_run
from benchmarks.online.table import Row, spread
from benchmarks.online.truth import Truth
from isotorque.learning.exploration.exploration import Exploration
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.strategies import (
    ConstrainedGoalBabbling,
    DirectionSampling,
    GoalBabbling,
    MotorBabbling,
)
from isotorque.learning.exploration.targets import JointBox
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain

COMMANDS = 1000
PLAN = Plan(COMMANDS, COMMANDS, ("dense",))
FREE = ExplorationSettings(learn_inadmissible=True)
WHY = (
    "What fails is the growth of the set of static torques: its border is found by torques that "
    "lie beyond it."
)


def comparison_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Share of inadmissible torques and the model that is left."""
    truth = Truth.of("2r")
    runs = all_seeds(
        options.store,
        "1000-joint",
        options.seeds,
        lambda seed: scheme_run(truth, joint, QUICK, PLAN, seed),
    )
    shares = _shares(runs)
    yield Row(
        "2R, inadmissible torques among 1,000 commands after discovery",
        "avoided",
        "under 1 %",
        "",
        spread(shares, " %", 1) + f", {len(runs)} seeds",
        statistics.median(shares),
        1.0,
        WHY,
    )
    limits = truth.robot.limits
    goals = truth.sets["90"]
    ways: tuple[tuple[str, str, Callable[[int], Run]], ...] = (
        (
            "constrained direction sampling",
            "-",
            lambda seed: scheme_run(truth, replayed, QUICK, PLAN, seed),
        ),
        ("constrained goal babbling, goals in the BCTS", "-", lambda s: _goals_run(truth, s)),
        (
            "direction sampling without constraints (Fig. 7)",
            "47-82 %",
            lambda seed: _free_run(truth, seed, DirectionSampling),
        ),
        (
            "direction sampling within the joint limits",
            "-",
            lambda seed: _free_run(truth, seed, DirectionSampling, domain=JointBox(limits)),
        ),
        (
            "goal babbling, the 90 targets as goals",
            "-",
            lambda seed: _free_run(truth, seed, GoalBabbling, goals=goals),
        ),
        ("motor babbling", "-", lambda seed: _free_run(truth, seed, MotorBabbling)),
    )
    for what, demanded, run in ways:
        runs = all_seeds(options.store, f"1000-{what}", options.few_seeds, run)
        here = (
            f"{spread(_shares(runs), ' %', 1)} inadmissible; "
            f"model {spread([r.last('dense') for r in runs], ' Nm', 3)}, "
            f"{len(runs)} seeds"
        )
        yield Row(f"2R, {what}: 1,000 commands, LLM with kappa and replay", "-", demanded, "", here)


def _shares(runs: list[Run]) -> list[float]:
    return [100.0 * run.counts.inadmissible / run.counts.commands for run in runs]


def _free_run(truth: Truth, seed: int, kind: Callable[..., Exploration], **options: Any) -> Run:
    """An unconstrained original: every torque is applied, whatever happened is learned."""
    learner = replayed(truth.group)
    exploration = kind(
        SimulatedArm(truth.robot),
        learner,
        np.random.default_rng(seed),
        torque_range=truth.torque_range,
        settings=FREE,
        **options,
    )
    return explored(truth, exploration, learner, PLAN)


def _goals_run(truth: Truth, seed: int) -> Run:
    """Goal babbling after discovery, to 66 goals drawn in the fundamental domain it found."""
    arm = SimulatedArm(truth.robot)
    rng = np.random.default_rng(seed)
    scheme = Scheme(arm, rng, replayed, SchemeSettings(samples=1))
    for _ in scheme.discover():
        pass
    for _ in scheme.learn():
        pass
    domain = scheme.domain
    assert isinstance(domain, FundamentalDomain)
    learner = replayed(scheme.group)
    exploration = ConstrainedGoalBabbling(
        arm,
        learner,
        rng,
        domain.sample(rng, 66),
        static_torques=scheme.static_torques,
        domain=domain,
        torque_range=scheme.torque_range,
        settings=QUICK,
    )
    return explored(truth, exploration, learner, PLAN)
