"""The measured table inside a page of the documentation, between two marks."""

from __future__ import annotations

from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "online.md"
BEGIN = "<!-- measured: begin -->"
END = "<!-- measured: end -->"


def put_into_page(text: str, page: Path = PAGE) -> None:
    """Replace what stands between the marks of the page.

    Raises
    ------
    ValueError
        If the page does not have both marks, in this order.
    """
    whole = page.read_text()
    before, begin, rest = whole.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"{page}: marks {BEGIN} and {END} are missing")
    page.write_text(f"{before}{BEGIN}\n\n{text.strip()}\n\n{END}{after}")
