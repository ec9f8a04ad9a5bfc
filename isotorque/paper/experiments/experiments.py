"""The list of the paper's experiments."""

from __future__ import annotations

from isotorque.paper.experiments.batch import measure_batch_2r, measure_batch_3r
from isotorque.paper.experiments.discovery import measure_discovery
from isotorque.paper.experiments.measured import Experiment
from isotorque.paper.experiments.online import (
    measure_3r,
    measure_guided_literal,
    measure_iterated,
    measure_literal,
)
from isotorque.paper.experiments.static_torques import measure_static_torques
from isotorque.paper.experiments.statics import measure_domain, measure_ranges, measure_symmetries
from isotorque.paper.experiments.update_times import measure_update_times
from isotorque.paper.holding import measure_holding
from isotorque.symbolic.common.errors import InputError

EXPERIMENTS = (
    Experiment("symmetries-2r", "2r", "2r", measure_symmetries),
    Experiment("domain-2r", "2r", "2r", measure_domain),
    Experiment("ranges-2r", "2r", "2r", measure_ranges),
    Experiment("discovery-2r", "2r", "2r", measure_discovery),
    Experiment("static-torques-2r", "2r", "2r", measure_static_torques, 0.2),
    Experiment("holding-2r", "2r", "2r", measure_holding),
    Experiment("literal-2r", "2r", "2r", measure_literal, 4.0),
    Experiment("guided-literal-2r", "2r", "2r", measure_guided_literal, 2.0),
    Experiment("iterated-2r", "2r", "2r", measure_iterated, 0.5),
    Experiment("update-times-2r", "2r", "2r", measure_update_times, 0.2),
    Experiment("ranges-3r", "3r", "3r", measure_ranges),
    Experiment("discovery-3r", "3r", "3r", measure_discovery),
    Experiment("online-3r", "3r", "3r", measure_3r, 2.0),
    Experiment("batch-2r", "batch", "2r", measure_batch_2r, 0.5),
    Experiment("batch-3r", "batch", "3r", measure_batch_3r, 0.7),
)
"""All experiments."""

PARTS = ("2r", "3r", "batch", "figures", "all")
"""What can be asked for; figures need all experiments."""


def experiment(name: str) -> Experiment:
    """Return an experiment by its name.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    for entry in EXPERIMENTS:
        if entry.name == name:
            return entry
    raise InputError("paper", "experiment", name, ", ".join(e.name for e in EXPERIMENTS))


def experiments_of(part: str) -> tuple[Experiment, ...]:
    """Return the experiments of a part of the paper.

    Raises
    ------
    InputError
        If there is no such part.
    """
    if part not in PARTS:
        raise InputError("paper", "part", part, ", ".join(PARTS))
    if part in ("figures", "all"):
        return EXPERIMENTS
    return tuple(entry for entry in EXPERIMENTS if entry.part == part)
