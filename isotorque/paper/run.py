"""The whole comparison: pieces of work, the table made of them, figures and pages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from isotorque.learning.files.software_versions import software_versions
from isotorque.paper.experiments.experiments import experiments_of
from isotorque.paper.experiments.measured import Experiment
from isotorque.paper.finished_work import Parts
from isotorque.paper.table.items import ITEMS
from isotorque.paper.table.table import Row, make_rows
from isotorque.paper.work import Piece, perform
from isotorque.parallel import in_processes, on_cluster
from isotorque.symbolic.common.files import output_directory
from isotorque.symbolic.robots.load_robot import load_robot

Progress = Callable[[str, int, int, str], None]
ROBOTS = ("2r", "3r")
"""Built-in robots that the experiments are made with."""
QUICK = 0.01
"""Share of the paper's samples with ``--quick``."""


@dataclass(frozen=True)
class PaperOptions:
    """Rows that are compared, and the effort spent on each.

    Attributes
    ----------
    part : str
        ``2r``, ``3r``, ``batch``, ``figures`` or ``all``.
    seed : int
        First seed.
    seeds : int
        Number of seeds; they are seed, seed + 1, ...
    share : float
        See `isotorque.paper.experiments.measured.Effort`.
    jobs : int
        Local processes.
    scheduler : str or None
        Address of a Dask scheduler to work on instead.
    """

    part: str = "all"
    seed: int = 0
    seeds: int = 1
    share: float = 1.0
    jobs: int = 2
    scheduler: str | None = None


@dataclass(frozen=True, eq=False)
class Comparison:
    """The table and what figures are drawn from.

    Attributes
    ----------
    options : PaperOptions
    rows : list of Row
    pictures : dict
        Pictures of the first seed, by experiment.
    curves : dict
        Pictures of every seed, by experiment.
    """

    options: PaperOptions
    rows: list[Row]
    pictures: dict[str, dict[str, Any]]
    curves: dict[str, list[dict[str, Any]]]

    def document(self) -> dict[str, Any]:
        """Return what ``paper.json`` holds."""
        chosen = asdict(self.options)
        del chosen["jobs"], chosen["scheduler"]
        return {
            "format": 1,
            "options": chosen,
            "versions": software_versions(),
            "held": sum(row.holds for row in self.rows),
            "rows": [asdict(row) for row in self.rows],
        }


def compare(options: PaperOptions, out: Path, progress: Progress) -> Comparison:
    """Do all experiments that are not done yet, and make the table.

    Parameters
    ----------
    options
        What is asked for.
    out
        Directory; every finished piece of work is kept in ``out/parts`` and used again.
    progress
        Called as ``progress(stage, done, total, note)``.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        For options that cannot be used, and for pieces made with other ones or other versions.
    """
    experiments = experiments_of(options.part)
    pieces = _pieces(experiments, options)
    robots = {name: load_robot(name).digest for name in ROBOTS}
    parts = Parts(output_directory(out) / "parts", {"share": options.share, "robots": robots})
    done = parts.load(piece.name for piece in pieces)
    stage, kept = "experiments", len(done)
    progress(stage, kept, len(pieces), f"{kept} were done before" if kept else "")
    left = [piece for piece in pieces if piece.name not in done]
    for piece, result in _results(left, options):
        parts.save(piece.name, result)
        done[piece.name] = result
        progress(stage, len(done), len(pieces), piece.name)
    by_experiment = {
        entry.name: [done[Piece(entry.name, seed, options.share).name] for seed in _seeds(options)]
        for entry in experiments
    }
    rows = make_rows(
        ITEMS, {name: [r["numbers"] for r in found] for name, found in by_experiment.items()}
    )
    pictures = {name: [r["pictures"] for r in found] for name, found in by_experiment.items()}
    first = {name: found[0] for name, found in pictures.items()}
    return Comparison(options, rows, first, pictures)


def _seeds(options: PaperOptions) -> range:
    return range(options.seed, options.seed + options.seeds)


def _pieces(experiments: Sequence[Experiment], options: PaperOptions) -> list[Piece]:
    """Return all pieces, long ones first, seed by seed."""
    long_first = sorted(experiments, key=lambda entry: -entry.minutes)
    return [
        Piece(entry.name, seed, options.share) for seed in _seeds(options) for entry in long_first
    ]


def _results(
    pieces: Sequence[Piece], options: PaperOptions
) -> Iterator[tuple[Piece, dict[str, Any]]]:
    if not pieces:
        return iter(())
    if options.scheduler is not None:
        return on_cluster(perform, pieces, options.scheduler)
    return in_processes(perform, pieces, options.jobs)
