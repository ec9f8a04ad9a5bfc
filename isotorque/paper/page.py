"""The comparison as HTML page, JSON document, Markdown table and figure files."""

from __future__ import annotations

import itertools
import json
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path

import jinja2
from markupsafe import Markup

from isotorque.paper import published
from isotorque.paper.figures.configurations import (
    arm_pictures,
    domain_picture,
    online_pictures,
    structure_picture,
    symmetry_pictures,
)
from isotorque.paper.figures.torques import (
    batch_pictures,
    discovery_pictures,
    learning_pictures,
    static_torque_pictures,
)
from isotorque.paper.run import QUICK, Comparison, PaperOptions
from isotorque.paper.table.text import markdown, shown
from isotorque.plain import plain
from isotorque.symbolic.common.files import output_directory, write_whole
from isotorque.verify.report.figures.style import save_figure, to_svg
from isotorque.verify.report.html_text import number
from isotorque.verify.report.run_figures import Picture

Progress = Callable[[str, int, int, str], None]
ENDINGS = (".svg", ".pdf")


def write_pages(comparison: Comparison, out: Path, progress: Progress) -> Path:
    """Write ``paper.html``, ``paper.json``, ``paper.md`` and ``figures/``; return the page's path.

    Parameters
    ----------
    comparison
        What was measured.
    out
        Directory, made where it does not exist.
    progress
        Called as ``progress(stage, done, total, note)``.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    output_directory(out)
    folder = output_directory(out / "figures")
    pictures = list(paper_pictures(comparison))
    for done, picture in enumerate(pictures, 1):
        for ending in ENDINGS:
            save_figure(picture.figure, folder / f"{picture.name}{ending}")
        progress("figures", done, len(pictures), picture.name)
    document = json.dumps(plain(comparison.document()), indent=1, allow_nan=False)
    write_whole(out / "paper.json", document + "\n")
    write_whole(out / "paper.md", markdown(comparison.rows) + "\n")
    page = out / "paper.html"
    write_whole(page, render_page(comparison, pictures))
    return page


def paper_pictures(comparison: Comparison) -> Iterator[Picture]:
    """Draw every figure whose experiments were made, in the order of the paper."""
    first, every = comparison.pictures, comparison.curves
    if "symmetries-2r" in first:
        yield from symmetry_pictures(first["symmetries-2r"])
    if "discovery-2r" in first:
        yield from discovery_pictures(first["discovery-2r"])
    if "domain-2r" in first:
        yield from domain_picture(first["domain-2r"])
    if "static-torques-2r" in first:
        yield from static_torque_pictures(first["static-torques-2r"])
    if "ranges-3r" in first:
        yield from structure_picture(first["ranges-3r"])
    if "literal-2r" in first:
        yield from online_pictures(first["literal-2r"], first["iterated-2r"])
        yield from learning_pictures(
            every["literal-2r"], every["guided-literal-2r"], every["iterated-2r"]
        )
    yield from arm_pictures(first.get("online-3r"), first.get("batch-2r"), first.get("batch-3r"))
    if "batch-2r" in every:
        yield from batch_pictures("2r", every["batch-2r"], published.BATCH_2R_RMSE)
        yield from batch_pictures("3r", every["batch-3r"], published.BATCH_3R_RMSE)


def render_page(comparison: Comparison, pictures: list[Picture]) -> str:
    """Return the HTML page: self-contained, without scripts."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("isotorque.verify.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "shown": shown}
    document = comparison.document()
    grouped = itertools.groupby(comparison.rows, lambda row: row.section.split(",")[0])
    return environment.get_template("paper.html.j2").render(
        title="The paper, line by line",
        rows=comparison.rows,
        sections=[(section, list(rows)) for section, rows in grouped],
        held=document["held"],
        seeds=comparison.options.seeds,
        options=comparison.options,
        versions=document["versions"],
        command=command(comparison.options),
        pictures=[
            {
                "name": picture.name,
                "svg": Markup(to_svg(picture.figure, picture.caption, prefix=picture.name)),
                "caption": f"{_title(picture.name)}: {picture.caption}",
                "wide": picture.wide,
            }
            for picture in pictures
        ],
    )


def command(options: PaperOptions) -> str:
    """Return the command that makes the same table."""
    words = ["isotorque", "paper", options.part, "--out", "DIR", "--seed", str(options.seed)]
    words += ["--seeds", str(options.seeds)] + (["--quick"] if options.share == QUICK else [])
    return shlex.join(words)


def _title(name: str) -> str:
    """Return a figure's number as the paper has it.

    Examples
    --------
    >>> _title("fig12b"), _title("factor-2r")
    ('Fig. 12B', 'Not in the paper')
    """
    if not name.startswith("fig"):
        return "Not in the paper"
    digits = name.removeprefix("fig").split("-")[0]
    return f"Fig. {digits.upper()}"
