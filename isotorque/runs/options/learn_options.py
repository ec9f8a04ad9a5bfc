"""Options of a learning command, beside those of a discovery it goes on from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from isotorque.learning.exploration.registry import DIRECTIONS
from isotorque.learning.simulator.settings import PhysicsMode
from isotorque.runs.options.recorded_robot import as_recorded
from isotorque.runs.options.run_options import (
    CHAIN,
    LATTICE,
    ArmOptions,
    RunOptions,
    default_learner,
    default_samples,
)
from isotorque.runs.options.settings import Settings
from isotorque.runs.stages import cannot_hold_itself, recorded_discovery
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import load_robot


def learn_options(
    robot: str | RobotOptions,
    out: Path | None,
    strategy: str,
    symmetries: str,
    learner: str | None,
    samples: int | None,
    given: Mapping[str, Any],
) -> RunOptions:
    """Return the options of ``isotorque learn`` in full.

    Parameters
    ----------
    robot, strategy, symmetries
        As in `RunOptions`.
    out
        Directory of the run. Where it holds a discovery, what is not given is taken from there.
        None: there is none.
    learner, samples
        None: the default of the strategy.
    given
        Options of the arm (`ArmOptions`), ``n_min``, ``confirm``, ``learn_anyway`` and
        ``settings`` (`Settings.of`), as far as the user gave them.

    Raises
    ------
    InputError
        For options that make no sense.
    """
    robot = RobotOptions.of(robot)
    if out is not None:  # one robot in one run: the recording refuses another one
        robot = as_recorded(robot, out)
    loaded = load_robot(robot)
    learner = default_learner(strategy, loaded.n) if learner is None else learner
    samples = default_samples(strategy, learner) if samples is None else samples
    asked = {f.name: given[f.name] for f in fields(ArmOptions) if f.name in given}
    if strategy == LATTICE and "physics" not in asked:
        asked["physics"] = PhysicsMode.GUIDED.value
    recorded = None if out is None else recorded_discovery(out)
    settings = Settings.of(given.get("settings") or ())
    guided = False
    if recorded is None:
        arm, n_min, confirm = ArmOptions(**asked), 2, 0
        guided = strategy == LATTICE and cannot_hold_itself(loaded, arm)
        discovery = _discovering(arm, strategy, guided)
    else:
        discovery, n_min, confirm, before = recorded
        arm = replace(discovery, **asked)
        settings = settings.joined(before)
    n_min, confirm = given.get("n_min", n_min), given.get("confirm", confirm)
    anyway = bool(given.get("learn_anyway", False))
    return RunOptions(
        robot,
        arm,
        n_min,
        samples,
        learner,
        symmetries,
        strategy,
        discovery,
        confirm,
        anyway,
        guided_by_need=guided,
        settings=settings,
    )


def run_options(
    robot: str | RobotOptions,
    arm: ArmOptions,
    physics: str | None,
    *,
    strategy: str,
    learner: str | None,
    samples: int | None,
    **others: Any,
) -> RunOptions:
    """Return the options of ``isotorque run`` in full.

    Parameters
    ----------
    robot, strategy
        As in `RunOptions`.
    arm
        The simulated arm, but for its physics.
    physics
        None: ``guided`` for a lattice, and for an arm that cannot hold itself where the strategy
        can lead it; else ``open_loop``.
    learner, samples
        None: the default for the strategy and the robot's number of joints; without a learner the
        model is a rigid chain where one is accepted.
    **others
        The other fields of `RunOptions`.

    Raises
    ------
    InputError
        For options that make no sense.
    """
    robot = RobotOptions.of(robot)
    loaded = load_robot(robot)
    chain = learner is None
    learner = default_learner(strategy, loaded.n) if learner is None else learner
    led_by_chain = default_samples(strategy, CHAIN) if samples is None else samples
    samples = default_samples(strategy, learner) if samples is None else samples
    guided = False
    if physics is None or strategy == LATTICE:
        guided = strategy in (DIRECTIONS, LATTICE) and cannot_hold_itself(loaded, arm)
    if physics is None:
        guided = guided or strategy == LATTICE
        physics = (PhysicsMode.GUIDED if guided else PhysicsMode.OPEN_LOOP).value
    arm = replace(arm, physics=physics)
    discovery = _discovering(arm, strategy, guided)
    return RunOptions(
        robot,
        arm,
        samples=samples,
        learner=learner,
        strategy=strategy,
        discovery_arm=discovery,
        guided_by_need=guided,
        chain=chain,
        chain_samples=led_by_chain,
        **others,
    )


def _discovering(arm: ArmOptions, strategy: str, guided: bool) -> ArmOptions:
    """The arm of the discovery: it discovers by itself, and is guided only where it cannot."""
    alone = strategy == LATTICE and not guided
    return replace(arm, physics=PhysicsMode.OPEN_LOOP.value) if alone else arm
