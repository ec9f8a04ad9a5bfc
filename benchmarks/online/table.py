"""The table of the online learners, and what to say of rows that miss."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

HEADER = "| | paper | demanded | stretch | here | holds |\n|---|---|---|---|---|---|"


@dataclass(frozen=True)
class Row:
    """One figure beside what was published and what is demanded.

    Attributes
    ----------
    what, paper, demanded, stretch, here : str
        Cells of the table.
    value, limit : float or None
        The figure and what it may be at most; None where nothing is demanded.
    why : str
        Why the demand is missed, if it is.
    """

    what: str
    paper: str
    demanded: str
    stretch: str
    here: str
    value: float | None = None
    limit: float | None = None
    why: str = ""

    @property
    def holds(self) -> bool | None:
        """Whether the demand is met; None where nothing is demanded."""
        if self.value is None or self.limit is None:
            return None
        return self.value <= self.limit

    def line(self) -> str:
        """The row in Markdown."""
        verdict = "" if self.holds is None else ("yes" if self.holds else "no")
        cells = (self.what, self.paper, self.demanded, self.stretch, self.here, verdict)
        return "| " + " | ".join(cells) + " |"

    def miss(self) -> str:
        """By how much the demand is missed, and why, as an item of a Markdown list."""
        assert self.value is not None
        assert self.limit is not None
        ratio = self.value / self.limit
        missed = "not reached" if ratio == float("inf") else f"{ratio:.2g} times the demand"
        return f"- {self.what}: {missed}. {self.why}".rstrip()


def spread(values: Sequence[float], unit: str, digits: int) -> str:
    """Median and worst of what seeds gave."""
    middle, worst = statistics.median(values), max(values)
    return f"{_number(middle, digits)}{unit} (worst {_number(worst, digits)}{unit})"


def table(rows: Sequence[Row]) -> str:
    """All rows in Markdown, then the rows that miss."""
    lines = [HEADER, *(row.line() for row in rows)]
    missed = [row.miss() for row in rows if row.holds is False]
    if missed:
        lines += ["", "Rows that miss, by how much and why:", "", *missed]
    elif any(row.holds for row in rows):
        lines += ["", "No row misses."]
    return "\n".join(lines)


def _number(value: float, digits: int) -> str:
    return "never" if value == float("inf") else f"{value:.{digits}f}"
