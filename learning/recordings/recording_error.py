"""The one exception for recordings that cannot be made, read or continued."""

from __future__ import annotations

import errno
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from isotorque.symbolic.common.errors import InputError

READABLE = "a file and directory this user may read and write"


class RecordingError(InputError):
    """A recording that cannot be made, read or continued, said in one line.

    Takes the same arguments as ``InputError``, so the command line treats it the same way.

    Examples
    --------
    >>> print(RecordingError("run.sqlite", "robot", "2r", "3r"))
    run.sqlite: robot is 2r; accepted: 3r
    """


def translated(path: Path, error: sqlite3.Error | OSError | UnicodeDecodeError) -> RecordingError:
    """Say in the user's words what SQLite or the operating system refused.

    Parameters
    ----------
    path
        The recording.
    error
        What was raised while it was read or written.
    """
    kept = "; what was recorded before is kept, and the same command continues there"
    if isinstance(error, OSError):
        reason = error.strerror or str(error)
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            return RecordingError(path, "disk", f"full ({reason})", "a disk with free space" + kept)
        return RecordingError(path, "access", f"refused ({reason})", READABLE)
    # Python's sqlite3 raises the last one when damage has reached SQLite's own message.
    if isinstance(error, UnicodeDecodeError):
        found = f"damaged ({error.object!r})"
        return RecordingError(path, "content", found, "an undamaged recording")
    # The low byte is SQLite's primary result code; Python's own errors carry none.
    primary = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF
    if primary == sqlite3.SQLITE_FULL:
        return RecordingError(path, "disk", f"full ({error})", "a disk with free space" + kept)
    if primary == sqlite3.SQLITE_IOERR:
        wanted = "a disk with free space that can be read and written"
        return RecordingError(path, "disk", f"not usable ({error})", wanted + kept)
    if primary in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM):
        return RecordingError(path, "access", f"refused ({error})", READABLE)
    if primary in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        wanted = "a recording that no other program is writing"
        return RecordingError(path, "file", f"in use ({error})", wanted)
    if primary == sqlite3.SQLITE_NOTADB:
        return RecordingError(path, "file", f"no recording ({error})", "an Isotorque recording")
    return RecordingError(path, "content", f"damaged ({error})", "an undamaged recording")


@contextmanager
def clear_errors(path: Path) -> Iterator[None]:
    """Raise ``RecordingError`` in place of errors of SQLite and of the operating system."""
    try:
        yield
    except (sqlite3.Error, OSError, UnicodeDecodeError) as error:
        raise translated(path, error) from error
