"""Writing of files, whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from isotorque.symbolic.common.errors import InputError


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that no reader ever sees half of it.

    Raises
    ------
    InputError
        If it cannot be written (no such directory, no permission, disk full).
    """
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content.encode("utf-8") if isinstance(content, str) else content)
            Path(name).chmod(0o644)
            Path(name).replace(path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise InputError(path, "file", error.strerror, "a path that can be written") from error


def output_directory(path: Path) -> Path:
    """Return the directory, made if need be.

    Raises
    ------
    InputError
        If it is a file or cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(path, "directory", error.strerror, "a directory to write to") from error
    return path
