"""The recording of a run: one SQLite file, every command kept before the next motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from isotorque.learning.arm import Outcome, Vector
from isotorque.learning.files.run_info import RunInfo, canonical_json
from isotorque.learning.files.software_versions import software_versions
from isotorque.learning.recordings.database.commit_log import CommitLog, Statement
from isotorque.learning.recordings.database.queries import (
    RecordedPart,
    read_checkpoint,
    read_motion,
    read_parts,
    read_rows,
    read_state,
)
from isotorque.learning.recordings.database.recording_file import (
    check_before_writing,
    part_statement,
    write_new_file,
)
from isotorque.learning.recordings.database.schema import (
    CHECKPOINT,
    COMMAND,
    MOTION,
    SESSION,
    STATE,
    checked,
    command_id,
)
from isotorque.learning.recordings.database.writer_lock import WriterLock
from isotorque.learning.recordings.recorded_checkpoint import Checkpoint, pack_arrays
from isotorque.learning.recordings.recorded_command import CommandKind, Row, row_of
from isotorque.learning.recordings.recording_error import clear_errors
from isotorque.learning.recordings.recording_reader import RecordingReader

REPLAY_CHUNK = 4096


class Recording:
    """The recording of one part of a run, open for writing.

    Made by ``create``, ``open`` or ``open_or_create``; a context manager. ``RecordedArm`` does
    the writing of commands; algorithms never see this class.

    Attributes
    ----------
    path : Path
        The file.
    info : RunInfo
        What the part was made with.
    length : int
        Commands recorded so far in this part, its start (number 0) included.

    Notes
    -----
    Each commit survives the end of the process, however it comes; a power failure loses at most
    the commands of the last ``sync_seconds`` of recording (docs/recordings.md).

    Examples
    --------
    >>> import tempfile
    >>> directory = tempfile.TemporaryDirectory()
    >>> path = Path(directory.name) / "run.sqlite"
    >>> info = RunInfo("2r", "1f0c", ("shoulder", "elbow"), seed=7)
    >>> with Recording.create(path, info) as recording:
    ...     recording.save_checkpoint("learner", {"weights": [0.5, 1.5]})
    >>> with Recording.open(path, info) as recording:
    ...     recording.load_checkpoint("learner").arrays["weights"]
    array([0.5, 1.5])
    >>> directory.cleanup()
    """

    def __init__(self, log: CommitLog, lock: WriterLock, part: RecordedPart) -> None:
        self.path = log.path
        self.info = part.info
        self._log = log
        self._lock = lock
        self._part = part.id
        self._finished = part.finished
        self._session_is_noted = False
        query = "select count(*) from command where part = ?"
        (self.length,) = log.connection.execute(query, (part.id,)).fetchone()

    @classmethod
    def create(cls, path: str | Path, info: RunInfo, *, sync_seconds: float = 1.0) -> Recording:
        """Begin a new file; it appears whole or not at all.

        Parameters
        ----------
        path
            The file, in an existing directory.
        info
            What the run is made with.
        sync_seconds
            Recording time [s] that a power failure may cost; 0 makes every command wait for the
            disk.

        Raises
        ------
        RecordingError
            If the file is there already, is being written, or cannot be made.
        """
        path = Path(path)
        lock = WriterLock(path)
        try:
            with clear_errors(path):
                write_new_file(path, info)
                return cls._locked(path, info, lock, sync_seconds)
        except BaseException:
            lock.release()
            raise

    @classmethod
    def open(cls, path: str | Path, expected: RunInfo, *, sync_seconds: float = 1.0) -> Recording:
        """Open a file to go on where it ends, or to add another part to it.

        Parameters
        ----------
        path
            The file.
        expected
            What the run is made with now. A part of this name must have been made with the same;
            if there is none, it is added.
        sync_seconds
            As for ``create``.

        Raises
        ------
        RecordingError
            If the file is missing, no recording, of a newer version, damaged, of another robot,
            made with other options, being written, or not writable. It is then left as it was,
            bit for bit.
        """
        path = Path(path)
        lock = WriterLock(path)
        try:
            with clear_errors(path):
                check_before_writing(path, expected)
                return cls._locked(path, expected, lock, sync_seconds)
        except BaseException:
            lock.release()
            raise

    @classmethod
    def open_or_create(
        cls, path: str | Path, info: RunInfo, *, sync_seconds: float = 1.0
    ) -> Recording:
        """Open the file if there is one, else create it."""
        make = cls.open if Path(path).exists() else cls.create
        return make(path, info, sync_seconds=sync_seconds)

    @classmethod
    def _locked(cls, path: Path, info: RunInfo, lock: WriterLock, sync_seconds: float) -> Recording:
        log = CommitLog(path, sync_seconds)
        try:
            parts = {part.info.part: part for part in read_parts(log.connection)}
            if info.part not in parts:
                added = RecordedPart(len(parts) + 1, info, 0, False)
                log.commit([part_statement(added)])
                parts[info.part] = added
            return cls(log, lock, parts[info.part])
        except BaseException:
            log.close()
            raise

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file and let others write. Doing so twice does no harm."""
        self._log.close()
        self._lock.release()

    @property
    def is_finished(self) -> bool:
        """Whether this part ran to its end."""
        return self._finished

    def finish(self) -> None:
        """Note that this part ran to its end."""
        if not self._finished:
            done = RecordedPart(self._part, self.info, self.length, finished=True)
            self._log.commit([part_statement(done)])
            self._finished = True

    def reader(self) -> RecordingReader:
        """Open a reader of the same file; close it before the recording."""
        return RecordingReader(self.path, check=False)

    def rows(self, start: int = 0) -> Iterator[Row]:
        """Yield the rows of this part from number ``start`` on, in order."""
        for first in range(start, self.length, REPLAY_CHUNK):
            with clear_errors(self.path):
                values = (command_id(self._part, k) for k in (first, first + REPLAY_CHUNK - 1))
                rows = list(read_rows(self._log.connection, "id between ? and ?", tuple(values)))
            yield from rows

    def motion(self, number: int) -> Row | None:
        """Read (step_seconds, commanded, times, q, torques) of a profile, as stored; or None."""
        with clear_errors(self.path):
            return read_motion(self._log.connection, self._part, number)

    def arm_state(self) -> Any:
        """State after the last command, as the arm's ``state()`` gave it; None without one."""
        with clear_errors(self.path):
            return read_state(self._log.connection, self._part)

    def append(
        self,
        phase: str,
        kind: CommandKind,
        argument: bytes,
        outcome: Outcome | None,
        q_after: Vector,
        *,
        label: int | None = None,
        result: bytes | None = None,
        motion: Row | None = None,
        state: Any = None,
    ) -> None:
        """Record the next command of this part, in one commit.

        Parameters
        ----------
        phase, kind, argument, outcome, q_after, label, result
            As in ``RecordedCommand``; ``argument`` as float64 bytes.
        motion
            (step_seconds, commanded, times, q, torques) if it played a profile.
        state
            State of the arm afterwards: plain data, or None if it tells none.

        Raises
        ------
        RecordingError
            If the file cannot be written; what was recorded before is kept.
        """
        part, number = self._part, self.length
        row = row_of(part, number, phase, label, kind, argument, outcome, q_after, result)
        statements: list[Statement] = [(COMMAND, row)]
        if motion is not None:
            statements.append(checked(MOTION, (part, number, *motion)))
        if state is not None:
            statements.append(checked(STATE, (part, number, canonical_json(state))))
        self._commit_commands(statements, 1)

    def append_rows(self, rows: list[Row]) -> None:
        """Record commands without a motion, numbered from ``length`` on, in one commit."""
        self._commit_commands([(COMMAND, row) for row in rows], len(rows))

    @property
    def part_id(self) -> int:
        """Number of this part in the tables of the file."""
        return self._part

    def save_checkpoint(
        self, name: str, arrays: Mapping[str, ArrayLike], number: int | None = None
    ) -> None:
        """Keep named arrays; a later checkpoint of the same name replaces an earlier one.

        Parameters
        ----------
        name
            What is saved, for example the name of a learner.
        arrays
            Arrays of numbers or text.
        number
            Commands given when it was taken (default: all recorded ones). A checkpoint taken
            before the one in the file, as happens during a replay, is not written.

        Raises
        ------
        InputError
            If an array holds Python objects.
        RecordingError
            If the file cannot be written.
        """
        number = max(self.length - 1, 0) if number is None else number
        values = (self._part, name, number, pack_arrays(arrays))
        self._log.commit([checked(CHECKPOINT, values)])

    def load_checkpoint(self, name: str) -> Checkpoint | None:
        """Latest checkpoint of that name in this part, or None."""
        with clear_errors(self.path):
            return read_checkpoint(self._log.connection, self._part, name)

    def _commit_commands(self, statements: list[Statement], count: int) -> None:
        if not self._session_is_noted:
            opened = datetime.now(UTC).isoformat(timespec="seconds")
            versions = canonical_json(software_versions())
            statements.append((SESSION, (self._part, self.length, opened, versions)))
        self._log.commit(statements)
        self._session_is_noted = True
        self.length += count
