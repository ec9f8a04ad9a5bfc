"""JSON input whose every misfit is refused in one line that names file, field and value."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError


@dataclass(frozen=True)
class Field:
    """A value of a JSON document together with where it stands.

    Attributes
    ----------
    where : str
        The file.
    name : str
        The place in it, e.g. ``relations[2].A[0]``; empty for the whole document.
    value : object
        What stands there.

    Examples
    --------
    >>> field = Field("r.json", "relations[2].d", [0.5, "x"])
    >>> field.vector(2)
    Traceback (most recent call last):
    ...
    isotorque.InputError: r.json: relations[2].d[1] is "x"; accepted: a finite number
    """

    where: str
    name: str
    value: Any

    def refuse(self, accepted: str) -> NoReturn:
        """Raise the error that says what would be accepted here."""
        shown = json.dumps(self.value) if _is_json(self.value) else self.value
        raise InputError(self.where, self.name or "document", shown, accepted)

    @property
    def is_object(self) -> bool:
        """Whether this is a JSON object."""
        return isinstance(self.value, dict)

    def optional(self, key: str) -> Field | None:
        """Return the entry ``key`` of an object, None where it has none."""
        if not self.is_object:
            self.refuse("an object")
        if key not in self.value:
            return None
        return Field(self.where, f"{self.name}.{key}" if self.name else key, self.value[key])

    def entry(self, key: str) -> Field:
        """Return the entry ``key`` of an object, which must be there."""
        found = self.optional(key)
        if found is None:
            name = f"{self.name}.{key}" if self.name else key
            raise InputError(self.where, name, "missing", f"an object with the entry '{key}'")
        return found

    def items(self, *, at_least: int = 0, exactly: int | None = None) -> list[Field]:
        """Return the items of a list of the given length."""
        if not isinstance(self.value, list):
            self.refuse("a list" if exactly is None else f"a list of {exactly} entries")
        if exactly is not None and len(self.value) != exactly:
            self.refuse(f"a list of {exactly} entries")
        if len(self.value) < at_least:
            self.refuse(f"a list of at least {at_least} entries")
        return [Field(self.where, f"{self.name}[{i}]", x) for i, x in enumerate(self.value)]

    def number(self) -> float:
        """Return a finite number; JSON's true and false are none.

        A decimal stands for the float nearest to it; an integer that no float equals is refused.
        """
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            self.refuse("a finite number")
        try:
            number = float(self.value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            self.refuse("a finite number")
        if isinstance(self.value, int) and number != self.value:
            self.refuse("an integer that a float holds exactly")
        return number

    def integer(self) -> int:
        """Return an integer (3.0 is one)."""
        if isinstance(self.value, int) and not isinstance(self.value, bool):
            return self.value
        number = self.number()
        if number != round(number):
            self.refuse("an integer")
        return round(number)

    def boolean(self) -> bool:
        """Return true or false."""
        if not isinstance(self.value, bool):
            self.refuse("true or false")
        return self.value

    def text(self) -> str:
        """Return a string that is not empty."""
        if not isinstance(self.value, str) or not self.value:
            self.refuse("a string that is not empty")
        return str(self.value)

    def vector(self, length: int) -> NDArray[np.float64]:
        """Return finite numbers, shape (length,)."""
        return np.array([item.number() for item in self.items(exactly=length)], dtype=float)

    def matrix(self, *, columns: int, rows: int | None = None) -> NDArray[np.float64]:
        """Return finite numbers, shape (rows, columns); any number of rows where None."""
        found = [item.vector(columns) for item in self.items(exactly=rows)]
        return np.array(found, dtype=float).reshape(len(found), columns)


def read_json(path: str | Path) -> Field:
    """Read a JSON file.

    Raises
    ------
    InputError
        If it is not there, cannot be read, is not UTF-8 or not JSON (which knows neither NaN nor
        Infinity), nests too deeply or repeats a key.
    """
    where = str(path)
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(where, "file", error.strerror or error, "a readable JSON file") from None
    except UnicodeDecodeError as error:
        raise InputError(where, "encoding", error.reason, "JSON in UTF-8") from None
    try:
        value = json.loads(
            text,
            parse_constant=float,
            object_pairs_hook=lambda pairs: _without_repetition(where, pairs),
        )
    except json.JSONDecodeError as error:
        place = f"JSON at line {error.lineno}, column {error.colno}"
        raise InputError(where, place, error.msg, "a JSON document") from None
    except RecursionError:
        raise InputError(where, "nesting", "too deep", "lists in lists in lists") from None
    except InputError:
        raise
    except ValueError as error:  # an integer of more digits than Python converts
        raise InputError(where, "a number", error, "a finite number") from None
    field = Field(where, "", value)
    if any(name in text for name in ("NaN", "Infinity")):
        _refuse_constants(field)
    return field


def _refuse_constants(field: Field) -> None:
    """Refuse NaN and Infinity, which JSON does not know, wherever they stand."""
    if isinstance(field.value, list):
        for item in field.items():
            _refuse_constants(item)
    elif isinstance(field.value, dict):
        for key in field.value:
            _refuse_constants(field.entry(key))
    elif isinstance(field.value, float) and not math.isfinite(field.value):
        field.refuse("a finite number")


def _without_repetition(where: str, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise InputError(where, f"entry '{key}'", "repeated", "each entry once")
        found[key] = value
    return found


def _is_json(value: Any) -> bool:
    return value is None or isinstance(value, str | int | float | list | dict)
