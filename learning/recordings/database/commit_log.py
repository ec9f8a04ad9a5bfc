"""Commit log of a recording, and its waits for the disk."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from isotorque.learning.recordings.database.schema import PAGE_BYTES, connect
from isotorque.learning.recordings.recording_error import translated

Statement = tuple[str, Sequence[Any]]

LOG_BYTES = 4 << 20
"""Size of the write-ahead log at which SQLite moves it into the file."""


class CommitLog:
    """The writing end of a recording file.

    Parameters
    ----------
    path
        The file, which exists.
    sync_seconds
        A commit waits for the disk when the last one that did was this long ago [s]; 0 makes
        every commit wait, infinity only the first.
    clock
        Gives the time [s]; anything that only grows.

    Notes
    -----
    A commit is in the hands of the operating system when ``commit`` returns, so it outlives the
    process, however that ends. It outlives a power failure from the moment a later (or the same)
    commit has waited for the disk. SQLite's ``synchronous=full`` is that wait; ``normal`` leaves
    it out of a commit without ever endangering the structure of the file.
    """

    def __init__(
        self,
        path: Path,
        sync_seconds: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.path = path
        self.sync_seconds = sync_seconds
        self._clock = clock
        self._synced = -float("inf")
        self.connection = connect(path, "rw")
        self.connection.execute("pragma journal_mode = wal")
        self.connection.execute("pragma synchronous = normal")
        self.connection.execute(f"pragma wal_autocheckpoint = {LOG_BYTES // PAGE_BYTES}")

    def commit(self, statements: Sequence[Statement]) -> None:
        """Carry out all statements or none.

        Raises
        ------
        RecordingError
            If the file cannot be written; then it says what it said before.
        """
        execute = self.connection.execute
        now = self._clock()
        wait = now - self._synced >= self.sync_seconds
        try:
            if wait:
                execute("pragma synchronous = full")
            execute("begin immediate")
            try:
                for text, values in statements:
                    execute(text, values)
                execute("commit")
            except BaseException:
                if self.connection.in_transaction:
                    execute("rollback")
                raise
            if wait:
                execute("pragma synchronous = normal")
                self._synced = now
        except sqlite3.Error as error:
            raise translated(self.path, error) from error

    def close(self) -> None:
        """Move the log into the file, if no reader is in the way, and close it."""
        try:
            # Does what it can; what it cannot (a full disk) the next writer does.
            self.connection.execute("pragma wal_checkpoint(truncate)")
        except sqlite3.Error:
            pass
        finally:
            self.connection.close()
