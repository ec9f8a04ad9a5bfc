"""Reader of a recording, finished or still being written."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import OutcomeKind, Playback, Vector
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.recordings.database.damage_check import check_content
from isotorque.learning.recordings.database.queries import (
    RecordedPart,
    read_checkpoint,
    read_parts,
    read_playback,
    read_robot,
    read_rows,
)
from isotorque.learning.recordings.database.schema import check_schema, connect
from isotorque.learning.recordings.recorded_checkpoint import Checkpoint
from isotorque.learning.recordings.recorded_command import FLOATS, RecordedCommand, Row
from isotorque.learning.recordings.recording_error import RecordingError, clear_errors


@dataclass(frozen=True, eq=False, kw_only=True)
class SettledSamples(StaticSamples):
    """Settled samples of a recording: m pairs of a configuration and the torque that holds it.

    Attributes
    ----------
    q, tau : (m, n) arrays
        Observed joint angles [rad] and torques [N m].
    commanded : (m, n) array
        Torques as commanded [N m]; equal to ``tau`` unless its measurement is noisy, and where
        nothing was commanded (``hold``).
    seconds : (m,) array
        Time each command took on the arm [s], nan where unknown.
    labels : (m,) int array
        Groups as given when recording, -1 where none was given.
    phases : (m,) array of str
        Phase of each sample.
    numbers : (m,) int array
        Number of the command within its part.
    """

    commanded: Vector
    seconds: Vector
    labels: NDArray[np.int64]
    phases: NDArray[np.str_]
    numbers: NDArray[np.int64]

    def torque_groups(self) -> NDArray[np.int64]:
        """Group samples by |commanded torque|, equal in every bit (Algorithm 1's target torques).

        Returns
        -------
        (m,) int array
            Group of each sample: 0, 1, ... in the order of first appearance.
        """
        torques = np.abs(self.commanded)
        _, first, groups = np.unique(torques, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(np.argsort(first))
        appearance: NDArray[np.int64] = order[groups.reshape(-1)]
        return appearance


@dataclass(frozen=True)
class Count:
    """Number of commands of one kind that ended in one way, and their time on the arm [s]."""

    part: str
    phase: str
    kind: str
    outcome: OutcomeKind | None
    commands: int
    seconds: float


class RecordingReader:
    """Reads a recording while it is written or afterwards; never changes what it says.

    Parameters
    ----------
    path
        The file.
    check
        Look through the whole file for damage first (0.3 s for 54,000 commands); what is
        committed later is not looked at.

    Raises
    ------
    RecordingError
        If the file is missing, no recording, of a newer version or damaged.

    Notes
    -----
    Each method sees all that was committed when it was called.

    Examples
    --------
    >>> import tempfile
    >>> from isotorque.learning.recordings.recording import Recording
    >>> from isotorque.learning.files.run_info import RunInfo
    >>> directory = tempfile.TemporaryDirectory()
    >>> path = Path(directory.name) / "run.sqlite"
    >>> Recording.create(path, RunInfo("2r", "1f0c", ("shoulder", "elbow"), seed=7)).close()
    >>> with RecordingReader(path) as reader:
    ...     print(reader.parts[0].info.seed, len(reader.samples().q))
    7 0
    >>> directory.cleanup()
    """

    def __init__(self, path: str | Path, *, check: bool = True) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise RecordingError(path, "file", "missing", "an Isotorque recording")
        with clear_errors(self.path):
            self._connection = _opened(self.path)
            try:
                check_schema(self._connection, self.path)
                if check:
                    check_content(self._connection, self.path)
                self.robot, self.digest, self.joint_names = read_robot(self._connection)
            except BaseException:
                self._connection.close()
                raise

    def __enter__(self) -> RecordingReader:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    @property
    def parts(self) -> tuple[RecordedPart, ...]:
        """All parts of the run, in the order they were begun."""
        with clear_errors(self.path):
            return read_parts(self._connection)

    def commands(
        self, part: str | None = None, phase: str | None = None
    ) -> Iterator[RecordedCommand]:
        """Yield all commands, starts included, of one part or phase or of all."""
        for row in self._rows(part, phase):
            yield RecordedCommand.from_row(row)

    def samples(self, part: str | None = None, phase: str | None = None) -> SettledSamples:
        """Settled samples of one part or phase or of all, as arrays."""
        kinds = "outcome = 'settled' and kind in ('apply', 'play', 'hold', 'data')"
        rows = list(self._rows(part, phase, kinds))
        n = len(self.joint_names)

        def table(blobs: list[bytes]) -> Vector:
            return np.frombuffer(b"".join(blobs), FLOATS).astype(np.float64).reshape(-1, n)

        seconds = [np.nan if row[6] is None else row[6] for row in rows]
        return SettledSamples(
            q=table([row[7] for row in rows]),
            tau=table([row[4] if row[8] is None else row[8] for row in rows]),
            commanded=table([row[8] if row[3] == "hold" else row[4] for row in rows]),
            seconds=np.array(seconds, dtype=np.float64),
            labels=np.array([-1 if row[2] is None else row[2] for row in rows], dtype=np.int64),
            phases=np.array([row[1] for row in rows], dtype=np.str_),
            numbers=np.array([row[0] for row in rows], dtype=np.int64),
        )

    def playback(self, number: int, part: str | None = None) -> Playback:
        """Trajectory of the profile played as command ``number`` of a part (default: the first).

        Raises
        ------
        RecordingError
            If that command was no profile.
        """
        with clear_errors(self.path):
            playback = read_playback(self._connection, self._part_id(part), number)
        if playback is None:
            raise RecordingError(self.path, "command", number, "the number of a torque profile")
        return playback

    def counts(self) -> tuple[Count, ...]:
        """Commands and time by part, phase, kind and outcome; starts are left out."""
        query = """
            select part.name, phase, kind, outcome, count(*), coalesce(sum(seconds), 0.0)
            from command join part on part.id = part where kind != 'start'
            group by part.id, phase, kind, outcome order by part.id, min(number)
        """
        with clear_errors(self.path):
            return tuple(
                Count(part, phase, kind, how and OutcomeKind(how), many, seconds)
                for part, phase, kind, how, many, seconds in self._connection.execute(query)
            )

    def checkpoint(self, name: str, part: str | None = None) -> Checkpoint | None:
        """Latest checkpoint of that name in a part (default: the first), or None."""
        with clear_errors(self.path):
            return read_checkpoint(self._connection, self._part_id(part), name)

    def _part_id(self, part: str | None) -> int:
        parts = {p.info.part: p.id for p in read_parts(self._connection)}
        if part is None:
            return min(parts.values())
        if part not in parts:
            raise RecordingError(self.path, "part", repr(part), f"one of {sorted(parts)}")
        return parts[part]

    def _rows(self, part: str | None, phase: str | None, condition: str = "1") -> Iterator[Row]:
        values: list[Any] = []
        with clear_errors(self.path):
            if part is not None:
                condition += " and part = ?"
                values.append(self._part_id(part))
            if phase is not None:
                condition += " and phase = ?"
                values.append(phase)
            yield from read_rows(self._connection, condition, values)


def _opened(path: Path) -> sqlite3.Connection:
    """Open for reading, tidily where possible.

    A reader that may write removes the log's index file when it closes last; one that may not (a
    directory without permission) can still read a file nobody is writing.
    """
    try:
        connection = connect(path, "rw")
        connection.execute("pragma query_only = on")
        connection.execute("select count(*) from sqlite_master").fetchone()
    except sqlite3.OperationalError:
        log = path.with_name(path.name + "-wal")
        if log.exists() and log.stat().st_size:
            raise
        connection = connect(path, "immutable")
    return connection
