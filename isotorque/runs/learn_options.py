"""Options of a learning command, beside those of a discovery it goes on from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from isotorque.runs.recorded_robot import as_recorded
from isotorque.runs.run_options import (
    LATTICE,
    ArmOptions,
    RunOptions,
    default_learner,
    default_samples,
)
from isotorque.runs.stages import recorded_discovery
from learning.physics import PhysicsMode
from symbolic.robot_options import RobotOptions


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
        Options of the arm (`ArmOptions`), ``n_min``, ``confirm`` and ``learn_anyway``, as far as
        the user gave them.

    Raises
    ------
    InputError
        For options that make no sense.
    """
    robot = RobotOptions.of(robot)
    if out is not None:  # one robot in one run: the recording refuses another one
        robot = as_recorded(robot, out)
    learner = default_learner(strategy) if learner is None else learner
    samples = default_samples(strategy, learner) if samples is None else samples
    asked = {f.name: given[f.name] for f in fields(ArmOptions) if f.name in given}
    if strategy == LATTICE and "physics" not in asked:
        asked["physics"] = PhysicsMode.GUIDED.value
    recorded = None if out is None else recorded_discovery(out)
    if recorded is None:
        arm, n_min, confirm = ArmOptions(**asked), 2, 0
        # an arm discovers by itself; it is led only to what it cannot hold
        alone = PhysicsMode.OPEN_LOOP.value
        discovery = replace(arm, physics=alone) if strategy == LATTICE else arm
    else:
        discovery, n_min, confirm = recorded
        arm = replace(discovery, **asked)
    n_min, confirm = given.get("n_min", n_min), given.get("confirm", confirm)
    anyway = bool(given.get("learn_anyway", False))
    return RunOptions(
        robot, arm, n_min, samples, learner, symmetries, strategy, discovery, confirm, anyway
    )
