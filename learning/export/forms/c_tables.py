"""Numbers as constants of a C source."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

WIDTH = 98


class Tables:
    """Collects constants; ``source`` writes them in the order they came.

    Examples
    --------
    >>> tables = Tables()
    >>> tables.number("ROWS", 2)
    >>> tables.add("FACTOR", [[1.0, 0.5], [0.0, -1.0]])
    >>> print(tables.source())
    #define ROWS 2
    static const double FACTOR[2][2] = {
        {1.0, 0.5}, {0.0, -1.0}
    };
    """

    def __init__(self) -> None:
        self._text: list[str] = []

    def number(self, name: str, value: int) -> None:
        """A whole number."""
        self._text.append(f"#define {name} {int(value)}")

    def value(self, name: str, value: float) -> None:
        """A number."""
        self._text.append(f"#define {name} {_literal(float(value))}")

    def add(self, name: str, values: ArrayLike) -> None:
        """A table of doubles, or of whole numbers if it has an integer type.

        Notes
        -----
        Numbers are written so that C reads back the same doubles.
        """
        table = np.asarray(values)
        whole = np.issubdtype(table.dtype, np.integer)
        sizes = "".join(f"[{size}]" for size in table.shape)
        rows = _lines([_nested(row, whole) for row in table.tolist()])
        kind = "int" if whole else "double"
        self._text.append(f"static const {kind} {name}{sizes} = {{\n{rows}\n}};")

    def source(self) -> str:
        """All of them."""
        return "\n".join(self._text)


def comment(lines: Sequence[str]) -> str:
    """A comment; no line can end it or open another one."""
    safe = [re.sub(r"[*\\?\x00-\x1f]", "_", line) for line in lines]
    return "/* " + "\n".join(f" * {line}".rstrip() for line in safe)[3:] + "\n */"


def _lines(pieces: list[str]) -> str:
    """Pieces parted by commas, as many to a line as fit (``textwrap`` is slow on megabytes)."""
    lines, current = [], ""
    for piece in pieces:
        if current and len(current) + len(piece) > WIDTH:
            lines.append(current)
            current = ""
        current += (" " if current else "    ") + piece + ","
    return "\n".join([*lines, current]).removesuffix(",")


def _nested(value: object, whole: bool) -> str:
    if isinstance(value, list):
        return "{" + ", ".join(_nested(x, whole) for x in value) + "}"
    assert isinstance(value, int | float)
    return str(int(value)) if whole else _literal(float(value))


def _literal(value: float) -> str:
    return repr(value)
