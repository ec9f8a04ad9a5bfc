"""Finished runs kept in a directory, so that a benchmark that was stopped goes on."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

Result = TypeVar("Result")


class Store:
    """Results by name.

    Parameters
    ----------
    directory : Path or None
        Where pickles are kept; None: nothing is kept. Delete it when the code has changed.
    """

    def __init__(self, directory: Path | None = None) -> None:
        self._directory = directory
        if directory is not None:
            directory.mkdir(parents=True, exist_ok=True)

    def get(self, name: str, make: Callable[[], Result]) -> Result:
        """The kept result of this name, or a new one, which is kept."""
        if self._directory is None:
            return make()
        path = self._directory / (re.sub(r"[^\w.-]+", "_", name) + ".pickle")
        if path.exists():
            return pickle.loads(path.read_bytes())
        result = make()
        unfinished = path.with_suffix(".part")
        unfinished.write_bytes(pickle.dumps(result))
        unfinished.replace(path)
        return result
