"""Processor time of an update with all its symmetric copies."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.online.learners import joint
from benchmarks.online.table import Row
from benchmarks.online.truth import Truth
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap


def speed_rows(options: argparse.Namespace) -> Iterator[Row]:
    """Samples along a path, as exploration gives them; the best of five goes."""
    for name, radius, demanded, stretch, paper in (
        ("2r", 0.15, 10.0, "2 us", "120 ms"),
        ("3r", 0.5, 150.0, "15 us", "1.8 s"),
    ):
        truth = Truth.of(name)
        rng = np.random.default_rng(0)
        q = np.cumsum(rng.normal(0, 0.1, (24_000, truth.robot.n)), axis=0)
        torque = truth.gravity.torque(q)
        learner = LocalLinearMap(radius, group=truth.group).fit(q, torque)
        few = learner.n_prototypes_
        best = _best_time(
            lambda learner=learner, q=q, t=torque: learner.partial_fit(q[:4000], t[:4000])
        )
        cost = 1e6 * best / 4000
        copies = len(truth.group)
        yield Row(
            f"{name.upper()}, update of the LLM, all {copies} copies, {few} prototypes",
            paper,
            f"{demanded:.0f} us",
            stretch,
            f"{cost:.1f} us",
            cost,
            demanded,
        )
        exact = joint(truth.group)
        start = time.process_time()
        for i in range(400):
            exact.partial_fit(q[i : i + 1], torque[i : i + 1])
            exact.predict(q[i : i + 1])
        cost = 1e3 * (time.process_time() - start) / 400
        yield Row(
            f"{name.upper()}, update and prediction of joint least squares, amortised",
            "-",
            "1 ms",
            "",
            f"{cost:.2f} ms",
            cost,
            1.0,
        )


def _best_time(work: Callable[[], Any]) -> float:
    times = []
    for _ in range(5):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)
