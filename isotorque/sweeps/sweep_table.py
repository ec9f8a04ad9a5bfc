"""The table of a sweep: which robots, learners and seeds to run."""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from isotorque.runs.run_options import ArmOptions, RunOptions
from symbolic.errors import InputError
from symbolic.robots import load_robot

SAMPLES = 1000
"""Torques commanded in a run where the table does not say."""
REQUIRED = ("robot", "learner", "seed")
OPTIONAL = ("symmetries", "samples")


@dataclass(frozen=True)
class SweepRun:
    """One run of a sweep.

    Attributes
    ----------
    robot : str
        Built-in name or file.
    digest : str
        Fingerprint of that robot.
    learner, symmetries : str
        As the options of ``isotorque run``.
    samples : int
        Torques commanded while learning.
    seed : int
    """

    robot: str
    digest: str
    learner: str
    symmetries: str
    samples: int
    seed: int

    @property
    def name(self) -> str:
        """Name of its file of results, without ending."""
        stem = re.sub(r"[^A-Za-z0-9]+", "-", Path(self.robot).stem)
        tail = hashlib.sha256(f"{self.robot} {self.digest}".encode()).hexdigest()[:8]
        return f"{stem}-{tail}-{self.learner}-{self.symmetries}-{self.samples}-{self.seed}"


def read_sweep(path: Path) -> list[SweepRun]:
    """Read the table of a sweep.

    Parameters
    ----------
    path
        ``.csv``: a header ``robot,learner,seed`` and, if wanted, ``symmetries`` and ``samples``;
        one run per line. ``.toml``: lists ``robots``, ``learners`` and ``symmetries``, ``seeds``
        (a number, or a list) and ``samples``; all combinations are run.

    Returns
    -------
    list of SweepRun
        Each once, in the order of the table.

    Raises
    ------
    InputError
        Naming the file, the row and the field.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(path, "file", error.strerror, "a table that can be read") from error
    except UnicodeDecodeError as error:
        raise InputError(path, "content", "not UTF-8", "text") from error
    readers: dict[str, Callable[[Path, str], list[SweepRun]]] = {".csv": _csv, ".toml": _toml}
    if path.suffix.lower() not in readers:
        raise InputError(path, "ending", path.suffix or "none", ".csv or .toml")
    runs = readers[path.suffix.lower()](path, text)
    if not runs:
        raise InputError(path, "rows", "none", "at least one run")
    return list(dict.fromkeys(runs))


def _csv(path: Path, text: str) -> list[SweepRun]:
    reader = csv.reader(io.StringIO(text))
    header = [name.strip() for name in next(reader, [])]
    known = REQUIRED + OPTIONAL
    for name in header:
        if name not in known or header.count(name) > 1:
            raise InputError(f"{path}, row 1", "column", repr(name), ", ".join(known) + ", once")
    for name in REQUIRED:
        if name not in header:
            raise InputError(f"{path}, row 1", "column", f"{name} is missing", ", ".join(known))
    runs = []
    for cells in reader:
        if not any(cell.strip() for cell in cells):
            continue
        where = f"{path}, row {reader.line_num}"
        if len(cells) != len(header):
            raise InputError(where, "number of fields", len(cells), f"{len(header)}")
        entry = {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
        runs.append(
            _run(
                where, entry["robot"], entry["learner"], entry.get("symmetries") or "learned",
                _whole(where, "samples", entry.get("samples") or SAMPLES),
                _whole(where, "seed", entry["seed"]),
            )
        )  # fmt: skip
    return runs


def _toml(path: Path, text: str) -> list[SweepRun]:
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(path, "content", f"no TOML ({error})", "key = value") from error
    known = ("robots", "learners", "seeds", "symmetries", "samples")
    for key in table:
        if key not in known:
            raise InputError(path, "key", repr(key), ", ".join(known))
    robots = _texts(path, "robots", table.get("robots"))
    learners = _texts(path, "learners", table.get("learners"))
    symmetries = _texts(path, "symmetries", table.get("symmetries", ["learned"]))
    samples = _whole(path, "samples", table.get("samples", SAMPLES))
    seeds = table.get("seeds", 1)
    if not isinstance(seeds, list):
        seeds = list(range(_whole(path, "seeds", seeds)))
    return [
        _run(f"{path}, entry {number}", robot, learner, kind, samples, _whole(path, "seeds", seed))
        for number, (robot, learner, kind, seed) in enumerate(
            itertools.product(robots, learners, symmetries, seeds), 1
        )
    ]


def _texts(path: Path, key: str, value: Any) -> list[str]:
    if not isinstance(value, list) or not value or not all(isinstance(x, str) for x in value):
        raise InputError(path, key, "missing" if value is None else value, "a list of names")
    return value


def _whole(where: Any, field: str, value: Any) -> int:
    try:
        number = int(value) if not isinstance(value, bool | float) else -1
    except (TypeError, ValueError):
        number = -1
    if number < (0 if field.startswith("seed") else 1):
        raise InputError(where, field, repr(value), "a whole number, not negative")
    return number


def _run(
    where: str, robot: str, learner: str, symmetries: str, samples: int, seed: int
) -> SweepRun:
    """Check one run; the message names where in the table it stands."""
    try:
        digest = load_robot(robot).digest
        RunOptions(robot, ArmOptions(seed), learner=learner, symmetries=symmetries, samples=samples)
    except InputError as error:
        raise InputError(
            where, error.field, f"{error.value} ({error.where})", error.accepted
        ) from (error)
    return SweepRun(robot, digest, learner, symmetries, samples, seed)
