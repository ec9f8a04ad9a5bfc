"""A sweep: robots x learners x seeds, one table of learning curves."""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from isotorque.learning.files.software_versions import software_versions
from isotorque.paper.finished_work import Parts
from isotorque.parallel import in_processes, on_cluster
from isotorque.runs.experiment import run_experiment
from isotorque.runs.lattice_learning import learn_from_lattice
from isotorque.runs.options.run_options import LATTICE
from isotorque.sweeps.sweep_table import SweepRun, told_options
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory, write_whole
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.verify.report.figures.learning_curves import LearningCurve, curve_panels
from isotorque.verify.report.figures.style import save_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Progress = Callable[[str, int, int, str], None]
COLUMNS = (
    "robot",
    "learner",
    "strategy",
    "symmetries",
    "seed",
    "samples",
    "rmse",
    "largest",
    "explored",
    "motions",
    "inadmissible",
    "gate",
)


@dataclass(frozen=True)
class SweepResult:
    """Files of a finished sweep and what stands in them.

    Attributes
    ----------
    rows : tuple of dict
        One per evaluation of a run, with `COLUMNS`: torque RMSE and largest error on the dense set
        [N m] after so many commands, share of the BCTS explored by then; motions of the discovery
        before, share of the commands that were inadmissible, and whether enough relations were
        known before learning (it goes on without). Other options in which runs differ follow.
    table, plot : Path
        ``sweep.csv`` and ``sweep.svg``.
    """

    rows: tuple[dict[str, Any], ...]
    table: Path
    plot: Path


def perform_run(run: SweepRun) -> dict[str, Any]:
    """Discover and learn once; return plain numbers, the same wherever it is done.

    What the robot turns out to be unfit for is returned as well: other runs go on.
    """
    try:
        with tempfile.TemporaryDirectory() as folder, single_thread():
            found = _learned(run, Path(folder))
    except InputError as error:
        found = {"refused": str(error)}
    return {**found, "versions": software_versions()}


def _learned(run: SweepRun, folder: Path) -> dict[str, Any]:
    options = replace(run.options, learn_anyway=True)  # whether the gate was passed is told
    if options.strategy == LATTICE:
        learned = learn_from_lattice(options, folder, _silent)
        curve, motions, lost = learned.curve, learned.discovery_motions, 0.0
        gate = not learned.choices.get("learn_anyway", False)
    else:
        result = run_experiment(options, folder, _silent)
        gate = result.gate_passed
        curve, motions = tuple(result.curve), len(result.motions)
        unsettled = sum(str(step.outcome.kind) != "settled" for step in result.steps)
        lost = unsettled / max(1, len(result.steps))
    points = [asdict(point) for point in curve]
    return {"curve": points, "motions": motions, "inadmissible": lost, "gate": gate}


def _silent(stage: str, done: int, total: int, note: str) -> None:
    pass


def sweep(
    runs: Sequence[SweepRun],
    out: Path,
    progress: Progress,
    *,
    jobs: int = 2,
    scheduler: str | None = None,
) -> SweepResult:
    """Do all runs that are not done yet, and write their table and plot.

    Parameters
    ----------
    runs
        From `read_sweep`.
    out
        Directory; every finished run is kept in ``out/parts`` and used again.
    progress
        Called as ``progress(stage, done, total, note)``.
    jobs
        Local processes.
    scheduler
        Address of a Dask scheduler to work on instead.

    Raises
    ------
    InputError
        For results made by other versions, and files that cannot be written; for runs that were
        refused, after the table of all others is written.
    """
    parts = Parts(output_directory(out) / "parts", {"kind": "sweep", "columns": list(COLUMNS)})
    done = parts.load(run.name for run in runs)
    progress("runs", len(done), len(runs), f"{len(done)} were done before" if done else "")
    left = [run for run in runs if run.name not in done]
    results = (
        in_processes(perform_run, left, jobs)
        if scheduler is None
        else on_cluster(perform_run, left, scheduler)
    )
    refused: list[tuple[SweepRun, str]] = []
    for run, result in results if left else ():
        if "refused" in result:
            refused.append((run, result["refused"]))
            continue
        parts.save(run.name, result)
        done[run.name] = result
        progress("runs", len(done), len(runs), run.name)
    finished = [run for run in runs if run.name in done]
    more = [name for name in told_options(finished) if name not in COLUMNS]
    rows = tuple(row for run in finished for row in _rows(run, done[run.name], more))
    table, plot = out / "sweep.csv", out / "sweep.svg"
    write_whole(table, _text(rows, more))
    if finished:
        save_figure(_plot(finished, done), plot)
    if refused:
        _refuse(refused, table)
    return SweepResult(rows, table, plot)


def _refuse(refused: Sequence[tuple[SweepRun, str]], table: Path) -> NoReturn:
    run, why = min(refused, key=lambda pair: pair[0].name)
    others = f"; {len(refused) - 1} more runs are refused" if len(refused) > 1 else ""
    what = f"run of {run.robot} with {run.learner}, seed {run.seed},"
    accepted = f"runs that can be done; the others are in {table}"
    raise InputError("sweep", what, f"refused ({why}){others}", accepted)


def _rows(run: SweepRun, result: dict[str, Any], more: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {
            "robot": run.robot,
            "learner": run.learner,
            "strategy": run.options.strategy,
            "symmetries": run.options.symmetries,
            "seed": run.seed,
            "samples": point["samples"],
            "rmse": point["rmse"],
            "largest": point["largest"],
            "explored": point["explored"],
            "motions": result["motions"],
            "inadmissible": result["inadmissible"],
            "gate": result["gate"],
            **{name: run.option(name) for name in more},
        }
        for point in result["curve"]
    ]


def _text(rows: Sequence[dict[str, Any]], more: Sequence[str]) -> str:
    """Return rows as CSV; numbers in full, nothing where there is none."""
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, (*COLUMNS, *more), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()


def _plot(runs: Sequence[SweepRun], done: dict[str, dict[str, Any]]) -> Figure:
    """Draw one panel per robot: medians over seeds, with the lowest and highest."""
    panels: dict[str, dict[str, list[dict[str, Any]]]] = {}
    differing = [name for name in told_options(runs) if name != "learner"]
    for run in runs:
        name = ", ".join([run.learner, *(_said(run, option) for option in differing)])
        entry = panels.setdefault(run.robot, {}).setdefault(name, [])
        entry.append(done[run.name])
    return curve_panels(
        {
            Path(robot).stem: [_curve(name, seeds) for name, seeds in learners.items()]
            for robot, learners in panels.items()
        }
    )


def _said(run: SweepRun, option: str) -> str:
    value = run.option(option)
    return value if isinstance(value, str) else f"{option} {value}"


def _curve(name: str, seeds: Sequence[dict[str, Any]]) -> LearningCurve:
    longest = max((seed["curve"] for seed in seeds), key=len)
    samples = np.array([float(point["samples"]) for point in longest])
    errors = np.array(
        [
            np.interp(
                samples, [p["samples"] for p in seed["curve"]], [p["rmse"] for p in seed["curve"]]
            )
            for seed in seeds
        ]
    )
    if len(seeds) == 1:
        return LearningCurve(name, samples, errors[0])
    return LearningCurve(
        name, samples, np.median(errors, axis=0), errors.min(axis=0), errors.max(axis=0)
    )
