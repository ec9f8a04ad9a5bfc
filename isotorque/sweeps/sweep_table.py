"""The table of a sweep: which robots, learners, options and seeds to run."""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
import json
import math
import re
import shlex
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from isotorque.learning.exploration.registry import DIRECTIONS
from isotorque.runs.options.learn_options import learn_options
from isotorque.runs.options.run_options import LATTICE, ArmOptions, RunOptions, default_samples
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import STANDARD_INPUT, load_robot

SAMPLES = 1000
"""Torques commanded in a run where the table does not say."""
MOST_RUNS = 100_000
"""Runs that one table may ask for."""
REQUIRED = ("robot", "learner", "seed")
PLURALS = {"robots": "robot", "learners": "learner", "strategies": "strategy", "seeds": "seed"}
"""Keys of a TOML table that have other names than the columns of a CSV table."""
READERS: dict[str, Callable[[Any], Any]] = {
    "str": lambda value: value if isinstance(value, str) else _unfit(),
    "int": lambda value: _unfit() if isinstance(value, bool | float) else int(value),
    "float": lambda value: _unfit() if isinstance(value, bool) else float(value),
    "bool": lambda value: {True: True, False: False, "true": True, "false": False}[value],
}
WANTED = {"str": "a name", "int": "a whole number", "float": "a number", "bool": "true or false"}
ROBOT_OPTIONS: dict[str, str] = {
    f.name: "bool" if f.type == "bool" else "str" for f in fields(RobotOptions) if f.name != "spec"
}
"""Options of a robot, written as on the command line."""
SEVERAL = ("lock", "payload")
"""Options that may be given several times: with spaces between, quoted as in a shell."""
SET = "set"
"""Settings as ``--set`` takes them, with spaces between."""
OPTIONS: dict[str, str] = {
    f.name: str(f.type)
    for f in (*fields(RunOptions), *fields(ArmOptions))
    if f.type in READERS and f.name not in (*REQUIRED, "learn_anyway")
} | {**ROBOT_OPTIONS, SET: "str"}
"""What a table may say beside the required columns, each with its type: as options of `learn`.
A sweep measures: it always learns, and tells whether the gate was passed."""


@dataclass(frozen=True)
class SweepRun:
    """One run of a sweep.

    Attributes
    ----------
    robot : str
        Built-in name or file.
    digest : str
        Fingerprint of that robot.
    options : RunOptions
        As of ``isotorque learn``.
    """

    robot: str
    digest: str
    options: RunOptions

    @property
    def learner(self) -> str:
        """Name of the learner."""
        return self.options.learner

    @property
    def seed(self) -> int:
        """Seed of all random choices."""
        return self.options.arm.seed

    def option(self, name: str) -> Any:
        """Return one of `OPTIONS`."""
        options = self.options
        if name == SET:
            return shlex.join(options.settings.words)
        if name in ROBOT_OPTIONS:
            value = options.robot.as_json().get(name, getattr(options.robot, name))
            if name in SEVERAL:
                return shlex.join(value)
            return ",".join(map(str, value)) if isinstance(value, list) else value
        return getattr(options if hasattr(options, name) else options.arm, name)

    @property
    def name(self) -> str:
        """Name of its file of results, without ending."""
        stem = re.sub(r"[^A-Za-z0-9]+", "-", Path(self.robot).stem)[:60]
        tail = hashlib.sha256(f"{self.robot} {self.digest}".encode()).hexdigest()[:8]
        options = self.options
        name = f"{stem}-{tail}-{self.learner}-{options.symmetries}-{options.samples}-{self.seed}"
        usual = RunOptions(
            RobotOptions(self.robot),
            ArmOptions(self.seed),
            learner=self.learner,
            symmetries=options.symmetries,
            samples=options.samples,
        )
        if options == usual:
            return name
        text = json.dumps(asdict(options), sort_keys=True)
        return f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"


def read_sweep(path: Path) -> list[SweepRun]:
    """Read the table of a sweep.

    Parameters
    ----------
    path
        ``.csv``: a header ``robot,learner,seed`` and, if wanted, any of `OPTIONS`; one run per
        line, an empty field is the default. ``.toml``: lists ``robots`` and ``learners``,
        ``seeds`` (a number, or a list), ``strategies``, and any other option as a value or a list
        of values; all combinations are run.

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
    try:
        runs = readers[path.suffix.lower()](path, text)
    except csv.Error as error:
        raise InputError(path, "content", f"no CSV ({error})", "comma separated values") from error
    if not runs:
        raise InputError(path, "rows", "none", "at least one run")
    return list(dict.fromkeys(runs))


def _csv(path: Path, text: str) -> list[SweepRun]:
    reader = csv.reader(io.StringIO(text))
    header = [name.strip() for name in next(reader, [])]
    known = (*REQUIRED, *OPTIONS)
    for name in header:
        if name not in known or header.count(name) > 1:
            raise InputError(f"{path}, row 1", "column", repr(name), ", ".join(known) + ", once")
    for name in REQUIRED:
        if name not in header:
            raise InputError(f"{path}, row 1", "column", f"{name} is missing", ", ".join(known))
    runs: list[SweepRun] = []
    for cells in reader:
        if not any(cell.strip() for cell in cells):
            continue
        where = f"{path}, row {reader.line_num}"
        if len(cells) != len(header):
            raise InputError(where, "number of fields", len(cells), f"{len(header)}")
        if len(runs) == MOST_RUNS:
            raise InputError(where, "run", f"number {MOST_RUNS + 1}", f"at most {MOST_RUNS} runs")
        entry = {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
        given = {k: v for k, v in entry.items() if v or k in REQUIRED}
        runs.append(_run(where, {k: _value(where, k, v) for k, v in given.items()}))
    return runs


def _toml(path: Path, text: str) -> list[SweepRun]:
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also whole numbers of too many digits
        raise InputError(path, "content", f"no TOML ({error})", "key = value") from error
    known = (*PLURALS, *(name for name in OPTIONS if name not in PLURALS.values()))
    for key in table:
        if key not in known:
            raise InputError(path, "key", repr(key), ", ".join(known))
    table = {"symmetries": "learned", "seeds": 1} | table
    lists: dict[str, list[Any]] = {}
    for key in sorted(table, key=known.index):
        name, value = PLURALS.get(key, key), table[key]
        if name in REQUIRED[:2] or key == "strategies":
            value = _texts(path, key, value)
        if key == "seeds" and not isinstance(value, list):
            count = _value(path, key, value, "int")
            if not 0 < count <= MOST_RUNS:
                raise InputError(path, key, count, f"1 to {MOST_RUNS}, or a list")
            value = list(range(count))
        values = value if isinstance(value, list) else [value]
        if not values:
            raise InputError(path, key, "an empty list", "at least one value")
        lists[name] = [_value(path, key, v, _kind(name)) for v in values]
    for plural in ("robots", "learners"):
        if plural not in table:
            raise InputError(path, plural, "missing", "a list of names")
    lists["seed"] = lists.pop("seed")  # innermost
    number = math.prod(len(values) for values in lists.values())
    if number > MOST_RUNS:
        raise InputError(path, "number of combinations", number, f"at most {MOST_RUNS} runs")
    return [
        _run(f"{path}, entry {i}", dict(zip(lists, values, strict=True)))
        for i, values in enumerate(itertools.product(*lists.values()), 1)
    ]


def _texts(path: Path, key: str, value: Any) -> list[str]:
    if not isinstance(value, list) or not value or not all(isinstance(x, str) for x in value):
        raise InputError(path, key, value, "a list of names")
    return value


def _kind(name: str) -> str:
    return OPTIONS.get(name, "int" if name == "seed" else "str")


def _value(where: Any, field: str, value: Any, kind: str | None = None) -> Any:
    """Read a value of the type of its field."""
    kind = _kind(field) if kind is None else kind
    try:
        found = READERS[kind](value)
    except (TypeError, ValueError, KeyError, OverflowError):
        found = None
    negative = isinstance(found, int | float) and not (found >= 0 and math.isfinite(found))
    if found is None or negative:
        wanted = WANTED[kind] + (", not negative" if kind in ("int", "float") else "")
        raise InputError(where, field, repr(value), wanted)
    return found


def _unfit() -> Any:
    raise TypeError


def _run(where: str, given: Mapping[str, Any]) -> SweepRun:
    """Check one run; the message names where in the table it stands."""
    robot, learner = given["robot"], given["learner"]
    strategy = given.get("strategy", DIRECTIONS)
    usual = default_samples(strategy, learner) if strategy == LATTICE else SAMPLES
    try:
        part = _robot(robot, given)
        given = {**given, "settings": _words(SET, given.get(SET, ""))}
        options = learn_options(
            part,
            None,
            strategy,
            given.get("symmetries", "learned"),
            learner,
            given.get("samples", usual),
            given,
        )
        digest = _digest(part)
    except InputError as error:
        raise InputError(
            where, error.field, f"{error.value} ({error.where})", error.accepted
        ) from error
    return SweepRun(robot, digest, options)


@lru_cache(maxsize=64)
def _digest(robot: RobotOptions) -> str:
    return load_robot(robot).digest


def _robot(spec: str, given: Mapping[str, Any]) -> RobotOptions:
    """Return the robot of a run; where several entries of one option may stand, they are split."""
    if spec == STANDARD_INPUT:
        raise InputError(spec, "robot", "standard input", "a built-in name or a file")
    options = {name: given[name] for name in ROBOT_OPTIONS if name in given}
    for name in SEVERAL:
        if name in options:
            options[name] = _words(name, options[name])
    return RobotOptions(spec, **options)


def _words(name: str, text: str) -> list[str]:
    """Split the entries of an option that may be given several times."""
    try:
        return shlex.split(text)
    except ValueError as error:
        accepted = "words with spaces between, quoted as in a shell"
        raise InputError("table", name, f"{text!r} ({error})", accepted) from error


def told_options(runs: Sequence[SweepRun]) -> list[str]:
    """Return the `OPTIONS` in which the runs differ from each other."""
    return [name for name in OPTIONS if len({run.option(name) for run in runs}) > 1]
