"""Standard output and error that may be closed, or closed by their reader (`| head`)."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, TextIO, cast


class PatientStream:
    """A text stream that goes on, into nowhere, after its reader has left.

    Notes
    -----
    What a command has to say may be cut off; what it does, and the exit status that says how it
    went, may not.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, or drop it."""
        with self._giving_up():
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Write what is buffered, or drop it."""
        with self._giving_up():
            self._stream.flush()

    @contextmanager
    def _giving_up(self) -> Iterator[None]:
        """Once nothing more can be written, write the rest into the null device."""
        try:
            yield
        except OSError as error:
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, self._stream.fileno())
            os.close(null)
            self._stream.flush()  # else the interpreter fails on what is buffered when it leaves
            if not isinstance(error, BrokenPipeError):
                raise

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def patient_streams() -> Iterator[None]:
    """Let standard output and error be gone, or go, without any change to the work inside.

    Where they take no more for another reason, such as a full disk, the work is told once.
    """
    before = sys.stdout, sys.stderr
    # a descriptor that was closed from the start would be given to the next file opened
    output, error = (_opened() if stream is None else stream for stream in before)
    sys.stdout = cast(TextIO, PatientStream(output))
    sys.stderr = cast(TextIO, PatientStream(error))
    try:
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError):
                stream.flush()
        sys.stdout, sys.stderr = before


def _opened() -> TextIO:
    null = os.open(os.devnull, os.O_RDWR)
    while null < 3:  # takes the places of the standard streams that are closed
        null = os.open(os.devnull, os.O_RDWR)
    return os.fdopen(null, "w")
