"""Finished pieces of work, kept in files so that an interrupted table can be gone on with."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from isotorque.learning.files.software_versions import software_versions
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory, write_whole

FORMAT = 1


class Parts:
    """Files of finished work in a directory, one per piece.

    Parameters
    ----------
    directory : Path
        Made where it does not exist.
    options : dict
        What the results depend on, beside their names; pieces made with others are refused.

    Raises
    ------
    InputError
        If the directory cannot be made.
    """

    def __init__(self, directory: Path, options: dict[str, Any]) -> None:
        self.directory = output_directory(directory)
        self.made_with = {"format": FORMAT, **options, "versions": software_versions()}

    def save(self, name: str, result: dict[str, Any]) -> None:
        """Write the result of a piece, whole or not at all.

        Raises
        ------
        InputError
            If a worker elsewhere made it with other versions (``versions`` in the result).
        """
        here = self.made_with["versions"]
        if result.get("versions", here) != here:
            raise InputError(name, "versions of the worker", result["versions"], f"{here}")
        text = json.dumps({"made_with": self.made_with, "result": result}, allow_nan=False)
        write_whole(self._path(name), text + "\n")

    def load(self, names: Iterable[str]) -> dict[str, Any]:
        """Return the results that are there already, by name.

        Raises
        ------
        InputError
            If a file was made with other options or by other versions, or is damaged.
        """
        return {name: self._read(name) for name in names if self._path(name).exists()}

    def _read(self, name: str) -> Any:
        path = self._path(name)
        document = self._raw(path)
        for field, here in self.made_with.items():
            found = document["made_with"].get(field)
            if found != here:
                raise InputError(path, field, found, f"{here}; or another --out")
        return document["result"]

    def _raw(self, path: Path) -> dict[str, Any]:
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(path, "file", error.strerror, "a file that can be read") from error
        except ValueError as error:
            raise InputError(path, "content", f"damaged ({error})", "JSON; or delete it") from error
        whole = isinstance(document, dict) and isinstance(document.get("made_with"), dict)
        if not whole or not isinstance(document.get("result"), dict):
            raise InputError(path, "content", "incomplete", "made_with and result; or delete it")
        return document

    def _path(self, name: str) -> Path:
        return self.directory / f"{name}.json"
