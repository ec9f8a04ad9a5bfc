"""Rows of the table of the online learners."""

from __future__ import annotations

from dataclasses import dataclass

HEADER = "| | paper | demanded | stretch | here | holds |\n|---|---|---|---|---|---|"


@dataclass(frozen=True)
class Row:
    """One figure beside what was published and what is demanded.

    Attributes
    ----------
    what, paper, demanded, stretch, here : str
        Cells of the table.
    holds : bool or None
        Whether the demand is met; None where nothing is demanded.
    """

    what: str
    paper: str
    demanded: str
    stretch: str
    here: str
    holds: bool | None

    def line(self) -> str:
        """The row in Markdown."""
        verdict = "" if self.holds is None else ("yes" if self.holds else "no")
        cells = (self.what, self.paper, self.demanded, self.stretch, self.here, verdict)
        return "| " + " | ".join(cells) + " |"


def table(rows: list[Row]) -> str:
    """All rows in Markdown."""
    return "\n".join([HEADER, *(row.line() for row in rows)])
