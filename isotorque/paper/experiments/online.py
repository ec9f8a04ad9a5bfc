"""Section 7.1: online learning of the 2R and the 3R arm."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.paper.experiments.learning_run import (
    DENSE,
    STABLE,
    LearningRun,
    guided_run,
    open_loop_run,
)
from isotorque.paper.experiments.maintained import copies_held, maintained
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.published import (
    ITERATIONS_3R,
    ITERATIONS_LLM,
    ITERATIONS_LLM_IT,
    LONG_ITERATIONS,
    RMSE_3R,
    RMSE_66,
    SAMPLES_PER_ITERATION,
)
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.stability import is_stable
from isotorque.verify.report.summaries import summarise_domain, thinned

Array = NDArray[np.float64]
SMALL_STEPS = ExplorationSettings(noise=0.01, step_width=0.15)
STEPS = ExplorationSettings(noise=0.01, step_width=0.3)
WIDE_STEPS = ExplorationSettings(noise=0.02, step_width=0.5)
SHOWN, SHOWN_IMAGES = 1500, 6000
LONGER = 2
"""LLM_it is watched for this many times the paper's samples."""


def literal(group: SymmetryGroup | None, _: Array) -> LocalLinearMap:
    """Eq. 17-22 as printed, one gradient step per sample."""
    return LocalLinearMap(0.15, learning_rate=0.5, group=group)


def literal_iterated(group: SymmetryGroup | None, _: Array) -> LocalLinearMap:
    """LLM_it with the printed kernel: gradient steps until the sample's error has vanished."""
    return LocalLinearMap(0.15, inner_iterations=None, relaxation=0.6, group=group)


def iterated(group: SymmetryGroup | None, _: Array) -> LocalLinearMap:
    """LLM_it with wider kernels and replay: what brings the paper's number of samples."""
    return LocalLinearMap(
        0.3, kernel_width=2.5, inner_iterations=None, relaxation=0.6, replay=60, group=group
    )


def iterated_3r(group: SymmetryGroup | None, _: Array) -> LocalLinearMap:
    """The same with the prototypes further apart, for three joints."""
    return LocalLinearMap(
        0.5, kernel_width=2.0, inner_iterations=None, relaxation=0.6, replay=20, group=group
    )


def measure_literal(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Run the literal LLM for 3000 iterations on an arm without controller (Fig. 10-13)."""
    samples = effort.of(LONG_ITERATIONS * SAMPLES_PER_ITERATION, 300)
    run = open_loop_run(robot, literal, SMALL_STEPS, samples, seed, _every)
    measured = _long_run(run)
    stay = maintained(robot, run.gravity, run.learner, _targets(run, 66))
    measured.numbers["held_66"] = int(stay["held"].sum())
    measured.numbers["stable_66"] = int(is_stable(_targets(run, 66), run.gravity).sum())
    if run.domain is not None:
        measured.numbers["copies_held_66"] = copies_held(
            robot, run.gravity, run.learner, _targets(run, 66), run.domain
        )
    measured.pictures.update(_explored(run))
    measured.pictures["maintained_66"] = stay
    measured.pictures["maintained_90"] = maintained(
        robot, run.gravity, run.learner, _targets(run, 90)
    )
    return measured


def measure_guided_literal(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Run the literal LLM for 3000 iterations on a guided arm."""
    samples = effort.of(LONG_ITERATIONS * SAMPLES_PER_ITERATION, 300)
    return _long_run(guided_run(robot, literal, SMALL_STEPS, samples, seed, _every))


def _long_run(run: LearningRun) -> Measured:
    numbers: dict[str, Any] = {
        "samples": run.samples[-1],
        "explored_share": run.explored[-1],
        "inadmissible": run.inadmissible / run.commands,
        "discovery_samples": len(run.motions),
    }
    for name, key in _SETS_2R.items():
        numbers[f"rmse_{key}"] = run.at(ITERATIONS_LLM * SAMPLES_PER_ITERATION, name)
        numbers[f"long_rmse_{key}"] = run.errors[-1][name]
        numbers[f"iterations_{key}"] = _iterations(run, name, RMSE_66)
    curve = _curve(run, _SETS_2R)
    numbers |= {"curve_samples": curve["samples"], "curve_dense": curve["dense"]}
    return Measured(numbers, {"curve": curve})


def measure_iterated(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Run LLM_it, with wider kernels and replay and as printed (Fig. 12B, Fig. 13)."""
    commands = effort.of(LONGER * ITERATIONS_LLM_IT * SAMPLES_PER_ITERATION, 200)
    at = ITERATIONS_LLM_IT * SAMPLES_PER_ITERATION
    run = open_loop_run(robot, iterated, STEPS, commands, seed, _every)
    printed = open_loop_run(robot, literal_iterated, STEPS, commands, seed, _every)
    numbers: dict[str, Any] = {}
    for name, key in _SETS_2R.items():
        numbers[f"rmse_{key}"] = run.at(at, name)
        numbers[f"printed_rmse_{key}"] = printed.at(at, name)
        numbers[f"iterations_{key}"] = _iterations(run, name, RMSE_66)
    stay = maintained(robot, run.gravity, run.learner, _targets(run, 84))
    numbers["held_84"] = int(stay["held"].sum())
    numbers["stable_84"] = int(is_stable(_targets(run, 84), run.gravity).sum())
    pictures = {
        "curve": _curve(run, _SETS_2R),
        "printed_curve": _curve(printed, _SETS_2R),
        "maintained_84": stay,
    }
    return Measured(numbers, pictures)


def measure_3r(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Run LLM_it on the 3R arm, without controller and guided (Fig. 15A)."""
    commands = effort.of(ITERATIONS_3R * SAMPLES_PER_ITERATION, 200)
    free = open_loop_run(robot, iterated_3r, WIDE_STEPS, commands, seed, _every)
    guided = guided_run(robot, iterated_3r, WIDE_STEPS, commands, seed, _every)
    numbers: dict[str, Any] = {"explored_share": free.explored[-1]}
    for name, key in _SETS_3R.items():
        numbers[f"rmse_{key}"] = free.errors[-1][name]
        numbers[f"iterations_{key}"] = _iterations(free, name, RMSE_3R)
        numbers[f"guided_rmse_{key}"] = guided.errors[-1][name]
        numbers[f"guided_iterations_{key}"] = _iterations(guided, name, RMSE_3R)
    stay = maintained(robot, guided.gravity, guided.learner, _targets(guided, 64))
    numbers["held_64"] = int(stay["held"].sum())
    numbers["stable_64"] = int(is_stable(_targets(guided, 64), guided.gravity).sum())
    pictures = {
        "maintained_64": stay,
        "curve": _curve(free, _SETS_3R),
        "guided_curve": _curve(guided, _SETS_3R),
    }
    return Measured(numbers, pictures)


_SETS_2R = {"66 targets": "66", "90 targets": "90", "84 targets": "84", DENSE: "dense"}
_SETS_3R = {"64 targets": "64", DENSE: "dense", STABLE: "stable"}


def _every(samples: int) -> int:
    """Evaluate at each iteration at first, later at every twentieth part of the samples."""
    return max(SAMPLES_PER_ITERATION, samples // 20)


def _iterations(run: LearningRun, name: str, threshold: float) -> float | None:
    reached = run.reached(name, threshold)
    return None if reached is None else reached / SAMPLES_PER_ITERATION


def _curve(run: LearningRun, sets: dict[str, str]) -> dict[str, Any]:
    errors = {key: [e[name] for e in run.errors] for name, key in sets.items()}
    return {"samples": run.samples, **errors}


def _targets(run: LearningRun, count: int) -> Array:
    return run.sets.q[f"{count} targets"]


def _explored(run: LearningRun) -> dict[str, Any]:
    """Return what Fig. 10 shows, thinned."""
    seen = thinned(np.array(run.explored_q), SHOWN)
    group = run.group if run.domain is None else run.domain.group
    images = wrap(group.orbit(seen)[1:]).reshape(-1, run.robot.n)
    polygon = None if run.domain is None else summarise_domain(run.domain).polygon
    return {"explored": seen, "images": thinned(images, SHOWN_IMAGES), "polygon": polygon}
