"""Contestants of the benchmark of learning costs, and the work of each."""

from __future__ import annotations

import time
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from itertools import cycle
from typing import Any

import numpy as np
import pinocchio as pin
from sklearn.base import clone

from benchmarks.batch.learners import kernel_ridge, multilayer
from benchmarks.learning_costs import peers
from benchmarks.online.learners import joint, replayed, replayed_3r
from benchmarks.peers.literal_map import ArrayMap, LiteralMap
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.topological_map import TopologicalMap
from isotorque.learning.learners.registry import LearningTask, learner_by_name
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = np.ndarray
Samples = tuple[Array, Array]

TEST = 1000
MORE = 2000  # samples that updates are timed on, over and over
SINGLE = 200  # predictions one at a time between two looks at the clock
LEAST = 0.05  # seconds to be measured at least


@dataclass(frozen=True)
class Contestant:
    """Something that takes time.

    Attributes
    ----------
    name
        Its name in the table.
    run
        Does it and returns processor seconds per item.
    beside
        Learners of this package that it is a peer of.
    error
        RMSE [N m] of what was run, None where nothing was learned.
    """

    name: str
    run: Callable[[], float]
    beside: tuple[str, ...] = ()
    error: Callable[[], float | None] = lambda: None


class Bench:
    """An arm, its group, and the torques learners are judged by."""

    def __init__(self, name: str) -> None:
        self.name, self.robot = name, load_robot(name)
        self.n, self.gravity = self.robot.n, GravityModel(self.robot)
        self.group = primary_symmetries(self.gravity.potential)
        self.q, self.torque = self.random(TEST, 2018)
        self.active = np.abs(self.torque).max(axis=0) > 1e-9
        scale = self.torque.std(axis=0)
        self.scale = np.where(self.active, scale, 1.0)

    def random(self, count: int, seed: int) -> Samples:
        """Samples over all joint angles."""
        q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, self.n))
        return q, self.gravity.torque(q)

    def lattice(self, count: int) -> Samples:
        """Samples on a lattice in the fundamental domain."""
        region = SamplingRegion.of_domain(FundamentalDomain(self.group))
        q = lattice_samples(region, count, np.random.default_rng(0)).q
        return q, self.gravity.torque(q)

    def rmse(self, learner: Any) -> float:
        """Error over all joint angles, of the joints that gravity loads [N m]."""
        error = (learner.predict(self.q) - self.torque)[:, self.active]
        return float(np.sqrt(np.mean(error**2)))

    def local_linear_maps(self) -> tuple[LocalLinearMap, LocalLinearMap]:
        """As printed, and LLM_it, with prototypes as far apart as the dimension allows."""
        if self.name == "2r":
            return LocalLinearMap(0.15, learning_rate=0.7, group=self.group), replayed(self.group)
        return LocalLinearMap(0.5, learning_rate=0.7, group=self.group), replayed_3r(self.group)


def per_item(work: Callable[[], Any], items: int) -> float:
    """Return processor seconds per item, work being repeated until there is enough to measure."""
    done, start = 0, time.process_time()
    while True:
        work()
        done += items
        seconds = time.process_time() - start
        if seconds >= LEAST:
            return seconds / done


def update_contest(bench: Bench, known: int) -> list[Contestant]:
    """Everyone has learned the same samples; then every run learns further ones, one by one."""
    start, more = bench.random(known, 0), bench.random(MORE, 1)
    known_samples = list(zip(start[0][:, None], start[1][:, None], strict=True))
    printed, iterated = (x.fit(*start) for x in bench.local_linear_maps())
    check_literal(printed, start, more, bench.q)
    loops, arrays, at_once = LiteralMap.like(printed), ArrayMap.like(printed), deepcopy(printed)
    squares = joint(bench.group).fit(*start)
    topology = TopologicalMap(printed.radius, group=bench.group)
    network = peers.online_network(bench.group, bench.scale)
    features = peers.online_features(bench.group, bench.scale)

    def stimuli(q: Array, _: Array) -> None:
        for relation in bench.group:
            topology.adapt(relation.configuration(q[0]))

    for sample in known_samples:
        stimuli(*sample)
        network.partial_fit(*sample)
        features.partial_fit(*sample)
    errors = {id(x): bench.rmse(x) for x in (printed, iterated, squares, network, features)}

    def contestant(
        name: str,
        learn: Callable[[Array, Array], Any],
        learner: Any = None,
        beside: tuple[str, ...] = (),
        chunk: int = 20,
    ) -> Contestant:
        samples = cycle(zip(more[0][:, None], more[1][:, None], strict=True))

        def run() -> float:
            return per_item(lambda: [learn(*next(samples)) for _ in range(chunk)], chunk)

        return Contestant(name, run, beside, lambda: errors.get(id(learner)))

    ours = ("LLM", "LLM_it", "least squares")
    return [
        contestant("LLM", printed.partial_fit, printed),
        Contestant(
            "LLM, one call",
            lambda: per_item(lambda: at_once.partial_fit(*more), MORE),
            error=lambda: errors[id(printed)],
        ),
        contestant("LLM_it", iterated.partial_fit, iterated, chunk=1),
        contestant("least squares", lambda q, t: squares.partial_fit(q, t).predict(q), squares),
        contestant("topological map (nodes only)", stimuli, chunk=1),
        contestant("literal LLM, loops", loops.partial_fit, printed, ours[:1], 1),
        contestant("literal LLM, arrays", arrays.partial_fit, printed, ours[:1], 1),
        contestant("MLPRegressor.partial_fit", network.partial_fit, network, ours),
        contestant("SGDRegressor on RBFSampler", features.partial_fit, features, ours),
    ]


def check_literal(learner: LocalLinearMap, start: Samples, more: Samples, q: Array) -> None:
    """Make sure that the literal equations learn what the map does where it cuts nothing off."""
    few = slice(3)
    mine = clone(learner).set_params(cutoff=6.0).fit(*start)
    others = [kind.like(mine) for kind in (LiteralMap, ArrayMap)]
    mine.partial_fit(*(x[few] for x in more))
    for other in others:
        other.partial_fit(*(x[few] for x in more))
        gap = np.abs(other.predict(q[few]) - mine.predict(q[few])).max()
        if gap > 1e-6:
            name = type(other).__name__
            raise AssertionError(f"{name} and the local linear map differ by {gap} N m")


def prediction_contests(bench: Bench, known: int, count: int) -> dict[str, list[Contestant]]:
    """One configuration at a time, and many: online learners as above, others from a lattice."""
    printed = bench.local_linear_maps()[0].fit(*bench.random(known, 0))
    samples, task = bench.lattice(count), LearningTask(joints=bench.n, samples=count)
    network, process, waves = (
        learner_by_name(name, bench.group, task).fit(*samples)
        for name in ("network", "gaussian-process", "trigonometric")
    )
    kernels = ("gaussian-process",)
    learners: dict[str, tuple[Any, tuple[str, ...]]] = {
        "LLM": (printed, ()),
        "least squares": (joint(bench.group).fit(*bench.random(known, 0)), ()),
        "network": (network, ()),
        "gaussian-process": (process, ()),
        "trigonometric": (waves, ()),
        "literal LLM, arrays": (ArrayMap.like(printed), ("LLM",)),
        "MLPRegressor": (multilayer(bench.group, network.hidden).fit(*samples), ("network",)),
        "KernelRidge": (kernel_ridge(bench.group).fit(*samples), kernels),
        "GaussianProcessRegressor": (peers.gaussian_process(bench.group).fit(*samples), kernels),
    }
    ways: dict[str, list[Contestant]] = {"one at a time": [], f"{TEST} in one call": []}
    single = [q[None] for q in bench.q[:SINGLE]]

    def enter(name: str, beside: tuple[str, ...], works: Any, error: float) -> None:
        for entries, (work, items) in zip(ways.values(), works, strict=True):
            run = partial(per_item, work, items)
            entries.append(Contestant(name, run, beside, lambda: error))

    for name, (learner, beside) in learners.items():
        works = (
            (partial(one_by_one, learner.predict, single), SINGLE),
            (partial(learner.predict, bench.q), TEST),
        )
        enter(name, beside, works, bench.rmse(learner))
    gravity = partial(
        pin.computeGeneralizedGravity, bench.robot.model, bench.robot.model.createData()
    )
    works = (
        (partial(one_by_one, gravity, list(bench.q[:SINGLE])), SINGLE),
        (partial(one_by_one, gravity, list(bench.q)), TEST),
    )
    enter("Pinocchio", ("LLM", "trigonometric"), works, 0.0)
    return ways


def one_by_one(call: Callable[[Array], Any], items: list[Array]) -> None:
    for item in items:
        call(item)


def fit_contest(bench: Bench, count: int) -> list[Contestant]:
    """Fits to the same samples, from nothing."""
    samples, few = bench.lattice(count), bench.lattice(8)
    task = LearningTask(joints=bench.n, samples=count, robot=bench.name)

    def contestant(name: str, make: Callable[[], Any], beside: tuple[str, ...] = ()) -> Contestant:
        make().fit(*few)  # compiled code is loaded
        fitted: list[Any] = []

        def run() -> float:
            return per_item(lambda: fitted.append(make().fit(*samples)), 1)

        return Contestant(name, run, beside, lambda: bench.rmse(fitted[-1]) if fitted else None)

    def ours(name: str) -> Contestant:
        return contestant(name, lambda: learner_by_name(name, bench.group, task))

    hidden = learner_by_name("network", bench.group, task).hidden
    return [
        *map(ours, ("network", "gaussian-process", "trigonometric", "parametric")),
        contestant("MLPRegressor", lambda: multilayer(bench.group, hidden), ("network",)),
        contestant(
            "GaussianProcessRegressor",
            lambda: peers.gaussian_process(bench.group),
            ("gaussian-process",),
        ),
        contestant(
            "LinearRegression",
            lambda: peers.linear_regression(bench.group),
            ("trigonometric", "parametric"),
        ),
    ]
