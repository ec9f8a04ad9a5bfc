"""Reports: one self-contained HTML page with a JSON document beside it."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.document import report_document
from isotorque.verify.report.figures.style import to_svg
from isotorque.verify.report.html_text import map_lines, matrix, number, vector
from isotorque.verify.report.run_figures import Picture, report_pictures
from isotorque.verify.report.run_report import RunReport
from isotorque.verify.verdict import Verdict, all_passed


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


def verdicts_page(
    title: str, verdicts: Sequence[Verdict], subtitle: str = "", remarks: Sequence[str] = ()
) -> str:
    """Return a page with verdicts alone, for ``verify --report``.

    Parameters
    ----------
    title, subtitle
        What was judged; what it was judged against.
    verdicts
        The judgement.
    remarks
        What else is to be said.
    """
    return _template("verdicts.html.j2").render(
        title=title,
        subtitle=subtitle,
        verdicts=verdicts,
        remarks=remarks,
        passed=all_passed(verdicts),
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
        loader=jinja2.PackageLoader("isotorque.verify.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "vector": vector, "matrix": matrix, "map": map_lines}
    return environment.get_template(name)


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
