"""Lock of a recording for one writer: advisory, and dies with its process."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from isotorque.learning.recordings.recording_error import RecordingError


class WriterLock:
    """Holds ``<recording>.lock`` until released or until the process ends, however it ends.

    Parameters
    ----------
    path
        The recording. The lock is a file of its own beside it: closing a second descriptor of an
        SQLite file would silently drop the locks SQLite itself holds on it (POSIX).

    Raises
    ------
    RecordingError
        If another writer holds the lock, or the directory cannot be written.

    Notes
    -----
    The lock is ``flock``'s, which the kernel drops when the process is killed: a file left behind
    locks nobody out. On network file systems it is as good as their ``flock``.
    """

    def __init__(self, path: Path) -> None:
        self._path = path.with_name(path.name + ".lock")
        while True:
            descriptor = self._opened(path)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                holder = os.pread(descriptor, 20, 0).decode("ascii", "replace").strip()
                os.close(descriptor)
                raise RecordingError(
                    path,
                    "recording",
                    f"being written by process {holder or 'unknown'}",
                    "one writer at a time; reading is possible meanwhile",
                ) from error
            if self._is_current(descriptor):
                break
            os.close(descriptor)  # the previous holder removed this file: lock the new one
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
        self._descriptor: int | None = descriptor

    def release(self) -> None:
        """Let others write. Doing so twice does no harm."""
        if self._descriptor is None:
            return
        # Removed while still locked: whoever opened it meanwhile notices in `_is_current`.
        self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None

    def _opened(self, path: Path) -> int:
        try:
            return os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise RecordingError(
                path,
                f"directory {path.parent}",
                f"not usable ({error.strerror})",
                "an existing directory in which this user may write",
            ) from error

    def _is_current(self, descriptor: int) -> bool:
        try:
            there = self._path.stat()
        except FileNotFoundError:
            return False
        here = os.fstat(descriptor)
        return (there.st_dev, there.st_ino) == (here.st_dev, here.st_ino)
