"""Numbers of the table as people read them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from isotorque.paper.table.table import Row

BEGIN, END = "<!-- table -->", "<!-- end of table -->"


def shown(value: Any) -> str:
    """Write a number, a nested list of numbers, or words.

    Examples
    --------
    >>> shown(0.005312), shown(16.0), shown(None), shown([[0.0, 1.5708]]), shown("avoided")
    ('0.00531', '16', 'not reached', '(0, 1.57)', 'avoided')
    """
    if value is None:
        return "not reached"
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        inner = ", ".join(shown(entry) for entry in value)
        return inner if value and isinstance(value[0], Sequence) else f"({inner})"
    number = float(value)
    if number.is_integer() and abs(number) < 1e6:
        return f"{int(number)}"
    if abs(number) >= 100:
        return f"{number:.0f}"
    return f"{number:.3g}" if math.isfinite(number) else "not reached"


def markdown(rows: Iterable[Row]) -> str:
    """Return the table in Markdown.

    Notes
    -----
    Times are left out of the interval: they differ from machine to machine.
    """
    lines = ["| section | item | paper | ours | holds | rule, and why not |", "|---" * 6 + "|"]
    for row in rows:
        unit = f" [{row.unit}]" if row.unit else ""
        beside = "".join(f"<br>{name}: {shown(value)}" for name, value in row.beside.items())
        ours = shown(row.ours)
        if row.interval is not None:
            ours += f" ({shown(row.interval[0])} … {shown(row.interval[1])})"
        reason = row.rule + (f"; {row.why}" if row.why else "")
        cells = [
            row.section,
            row.item + unit + beside,
            shown(row.paper),
            ours,
            "yes" if row.holds else "**no**",
            reason,
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def with_table(text: str, table: str) -> str:
    r"""Return a document with the table between its two marks replaced.

    Raises
    ------
    ValueError
        If the marks are not there.

    Examples
    --------
    >>> with_table(f"a\n{BEGIN}\nold\n{END}\nb", "new").splitlines()
    ['a', '<!-- table -->', 'new', '<!-- end of table -->', 'b']
    """
    before, _ = text.split(BEGIN)
    _, after = text.split(END)
    return f"{before}{BEGIN}\n{table}\n{END}{after}"
