"""Reports: one self-contained HTML page with a JSON document beside it."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from symbolic.errors import InputError
from verify.figures.style import to_svg
from verify.report_document import report_document
from verify.report_figures import Picture, report_pictures
from verify.run_report import RunReport
from verify.verdict import Verdict, all_passed


def write_report(report: RunReport, directory: str | Path) -> tuple[Path, dict[str, Any]]:
    """Write ``report.html`` and ``report.json`` of a run.

    Parameters
    ----------
    report
        Every number of it is shown; none is added.
    directory
        Made where it does not exist.

    Returns
    -------
    page : Path
        Of ``report.html``.
    document : dict
        What ``report.json`` holds.

    Raises
    ------
    InputError
        If a file cannot be written. Each file is replaced whole or not at all.
    """
    folder = Path(directory)
    page = folder / "report.html"
    document = report_document(report)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            folder, "directory", error.strerror or error, "a directory that can be written"
        ) from None
    _write(folder / "report.json", json.dumps(document, indent=1, allow_nan=False) + "\n")
    _write(page, render_report(report))
    return page, document


def render_report(report: RunReport) -> str:
    """Return the HTML page of a run's report.

    Notes
    -----
    Self-contained: styles and pictures stand in the page, nothing is fetched, there is no script.
    """
    pictures: dict[str, list[dict[str, Any]]] = {}
    for picture in report_pictures(report):
        pictures.setdefault(picture.section, []).append(_inline(picture))
    return _template("report.html.j2").render(
        report=report,
        document=report_document(report),
        pictures=pictures,
        title=f"{report.setup.robot}: run report",
    )


def verdicts_page(title: str, verdicts: Sequence[Verdict], subtitle: str = "") -> str:
    """Return a page with verdicts alone, for ``verify --report``.

    Parameters
    ----------
    title, subtitle
        What was judged; what it was judged against.
    verdicts
        The judgement.
    """
    return _template("verdicts.html.j2").render(
        title=title, subtitle=subtitle, verdicts=verdicts, passed=all_passed(verdicts)
    )


def _inline(picture: Picture) -> dict[str, Any]:
    svg = to_svg(picture.figure, picture.caption, prefix=picture.name)
    return {
        "name": picture.name,
        "svg": Markup(svg),
        "caption": picture.caption,
        "wide": picture.wide,
    }


def _template(name: str) -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("verify"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    environment.filters["vector"] = vector
    environment.filters["matrix"] = matrix
    return environment.get_template(name)


def number(value: float | int | None, digits: int = 3) -> Markup:
    """Write a number for people: ``digits`` significant ones, powers of ten where they help.

    Examples
    --------
    >>> str(number(0.0053)), str(number(-12.3456)), str(number(2.14e-15))
    ('0.0053', '−12.3', '2.14·10<sup>−15</sup>')
    """
    if value is None or not math.isfinite(value):
        return Markup("–")
    if isinstance(value, int | np.integer):
        return Markup(f"{value:,}".replace(",", "\N{NARROW NO-BREAK SPACE}").replace("-", "−"))
    if value == 0:
        return Markup("0")
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 5:
        places = max(0, digits - 1 - exponent)
        text = f"{value:,.{places}f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
        text = text.rstrip("0").rstrip(".") if "." in text else text
        return Markup(text.replace("-", "−"))
    mantissa = f"{value / 10.0**exponent:.{digits - 1}f}".rstrip("0").rstrip(".")
    power = str(exponent).replace("-", "−")
    return Markup(f"{mantissa.replace('-', '−')}·10<sup>{power}</sup>")


def vector(values: Any, digits: int = 4) -> Markup:
    """Write the entries of a vector in brackets."""
    return Markup("(") + Markup(", ").join(number(_entry(x), digits) for x in values) + Markup(")")


def matrix(values: Any) -> Markup:
    """Write a matrix as a table."""
    rows = (
        Markup("<tr>")
        + Markup("").join(
            Markup("<td>") + number(_entry(x), 5) + Markup("</td>") for x in np.atleast_1d(row)
        )
        + Markup("</tr>")
        for row in np.asarray(values)
    )
    return Markup('<table class="matrix">') + Markup("").join(rows) + Markup("</table>")


def _entry(value: Any) -> float | int:
    x = float(value)
    return int(x) if x.is_integer() and abs(x) < 1e9 else x


def _write(path: Path, text: str) -> None:
    partial = path.with_name(path.name + ".partial")
    try:
        partial.write_text(text, encoding="utf-8")
        os.replace(partial, path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise InputError(
            path, "file", error.strerror or error, "a file that can be written"
        ) from None
