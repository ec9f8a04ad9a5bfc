"""Runs of the whole scheme on a simulated arm, with errors by number of samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.online.store import Store
from benchmarks.online.truth import Truth
from isotorque.learning.exploration.exploration import Counts, Exploration
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.strategies import GuidedDirectionSampling
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain

MakeLearner = Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Run:
    """A finished run.

    Attributes
    ----------
    discovery : int
        Samples settled before exploration began.
    curve : dict
        By name of the test set: pairs of settled samples and RMSE [N m].
    counts : Counts
        What exploration counted.
    """

    discovery: int
    curve: dict[str, list[tuple[int, float]]]
    counts: Counts

    def reached(self, name: str, threshold: float) -> float:
        """Samples after which the error stays below the threshold; infinity if it never does."""
        first = float("inf")
        for samples, error in reversed(self.curve[name]):
            if error > threshold:
                break
            first = samples
        return first

    @property
    def failed(self) -> float:
        """Share of the commanded torques that the arm did not settle under."""
        return 1.0 - self.counts.settled / self.counts.commands

    def last(self, name: str) -> float:
        """Error at the end [N m]."""
        return self.curve[name][-1][1]


@dataclass(frozen=True)
class Plan:
    """Length of a run, and the samples after which it is judged.

    Attributes
    ----------
    samples : int
        Torques commanded.
    every : int
        Settled samples between evaluations.
    sets : tuple of str
        Test sets.
    """

    samples: int
    every: int
    sets: tuple[str, ...]


def scheme_run(
    truth: Truth,
    make: MakeLearner,
    settings: ExplorationSettings,
    plan: Plan,
    seed: int,
    *,
    noise: SensorNoise | None = None,
    physics: str = "open_loop",
    bold: bool = False,
) -> Run:
    """Discover symmetries and static torques, explore, learn; nothing is given.

    A bold run also admits the torques of configurations that discovery passed by.
    """
    arm = SimulatedArm(truth.robot, physics, noise=noise, rng=np.random.default_rng(seed + 1000))
    scheme = Scheme(
        arm,
        np.random.default_rng(seed),
        make,
        SchemeSettings(samples=plan.samples, exploration=settings, from_trajectories=bold),
    )
    for _ in scheme.discover():
        pass
    steps = scheme.learn()
    next(steps)
    assert scheme.exploration is not None
    curve = _watched(truth, scheme.exploration, lambda: scheme.learner, plan, steps)
    return Run(len(scheme.samples[0]), curve, scheme.exploration.counts)


def guided_run(
    truth: Truth, learner: Any, settings: ExplorationSettings, plan: Plan, seed: int
) -> Run:
    """Explore with an arm that is placed and held; the symmetries are the learner's."""
    arm = SimulatedArm(truth.robot, physics="guided")
    exploration = GuidedDirectionSampling(
        arm,
        learner,
        np.random.default_rng(seed),
        domain=FundamentalDomain.near(truth.group, arm.q),
        torque_range=truth.torque_range,
        settings=settings,
    )
    curve = _watched(truth, exploration, lambda: learner, plan, exploration.steps(plan.samples))
    return Run(0, curve, exploration.counts)


def explored(truth: Truth, exploration: Exploration, learner: Any, plan: Plan) -> Run:
    """Run any exploration to its end."""
    curve = _watched(truth, exploration, lambda: learner, plan, exploration.steps(plan.samples))
    return Run(0, curve, exploration.counts)


def _watched(
    truth: Truth,
    exploration: Exploration,
    learner: Callable[[], Any],
    plan: Plan,
    steps: Iterator[Any],
) -> dict[str, list[tuple[int, float]]]:
    curve: dict[str, list[tuple[int, float]]] = {name: [] for name in plan.sets}
    seen = 0
    for _ in steps:
        settled = exploration.counts.settled
        if settled >= seen + plan.every or exploration.counts.commands == plan.samples:
            seen = settled
            for name in plan.sets:
                curve[name].append((settled, truth.error(learner(), name)))
    return curve


def all_seeds(store: Store, name: str, count: int, run: Callable[[int], Run]) -> list[Run]:
    """One run for each seed from 0 on, under this name in the store."""
    return [
        store.get(f"{name}-{seed}", lambda seed=seed: run(seed))  # type: ignore[misc]
        for seed in range(count)
    ]


def last_errors(runs: Sequence[Run], name: str) -> list[float]:
    """The error at the end of each run [N m]."""
    return [run.last(name) for run in runs]
