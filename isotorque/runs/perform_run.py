"""A run by whichever strategy its options name."""

from __future__ import annotations

from pathlib import Path

from isotorque.runs.experiment import Progress, run_experiment
from isotorque.runs.lattice_learning import run_lattice
from isotorque.runs.options.run_options import LATTICE, RunOptions
from isotorque.runs.run_outcome import RunOutcome


def perform(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Discover and learn, by an exploration or from a lattice.

    Parameters and errors as of `isotorque.runs.experiment.discover_symmetries`.
    """
    by_strategy = run_lattice if options.strategy == LATTICE else run_experiment
    return by_strategy(options, out, progress)
