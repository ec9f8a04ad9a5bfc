"""Pictures of growing costs: one per quantity, both axes logarithmic."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter, NullLocator

from benchmarks.growth.curves import Measured, growth
from benchmarks.growth.table import law
from isotorque.verify.report.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PINK,
    RED,
    SKY,
    panels,
    settings,
)
from isotorque.verify.report.figures.style import to_svg as as_svg

COLOURS = (BLUE, RED, GREEN, ORANGE, PINK, INK, SKY)
MARKERS = "osD^vP*"
"""Curves differ in colour and mark."""
HEIGHT, PER_ENTRY = 3.0, 0.19
"""Of the axes and of an entry of the legend below them [in]."""


def picture(quantity: str, measured: Sequence[Measured]) -> Figure:
    """Draw the times of curves over one quantity, a panel for each kind.

    Parameters
    ----------
    quantity
        What they grow with.
    measured
        The curves; dotted lines are the fitted laws, drawn where they were fitted.
    """
    kinds = list(dict.fromkeys(m.curve.panel for m in measured))
    grouped = [[m for m in measured if m.curve.panel == kind] for kind in kinds]
    entries = max(len(group) for group in grouped)
    with settings():
        height = HEIGHT + PER_ENTRY * (entries + 1)
        figure, axes = panels(len(kinds), width=4.4 if len(kinds) > 1 else 5.6, height=height)
        for ax, kind, group in zip(axes, kinds, grouped, strict=True):
            for number, one in enumerate(group):
                _draw(ax, one, number)
            _finish(ax, quantity, kind, group)
    return figure


def to_svg(figure: Figure, name: str, quantity: str) -> str:
    """The picture as text, the same for the same times."""
    title = f"Processor time against {quantity}, logarithmic axes, with fitted exponents."
    return as_svg(figure, title, prefix=name)


def write_picture(folder: Path, name: str, quantity: str, measured: Sequence[Measured]) -> Path:
    """Write ``growth-NAME.svg``; returns where."""
    path = folder / f"growth-{name}.svg"
    path.write_text(to_svg(picture(quantity, measured), path.stem, quantity) + "\n")
    return path


def _draw(ax: Axes, one: Measured, number: int) -> None:
    colour = COLOURS[number % len(COLOURS)]
    label = one.curve.what
    if len(one.x) > 1:
        found = growth(one.x, one.seconds)
        label += f": {law(one.curve, found)}"
        x = np.geomspace(found.start, one.x.max(), 50)
        fitted = found.seconds(x, bool(one.curve.per))
        ax.plot(x, fitted, color=colour, linewidth=2.6, alpha=0.45, linestyle=(0, (1, 1)))
    ax.plot(
        one.x,
        one.seconds,
        color=colour,
        marker=MARKERS[number % len(MARKERS)],
        markersize=4.0,
        linewidth=0.9,
        label=label,
    )


def _finish(ax: Axes, quantity: str, kind: str, group: Sequence[Measured]) -> None:
    ax.set_xscale("log")
    ax.set_yscale("log")
    ticks = sorted({float(x) for one in group for x in one.x})
    if ticks[-1] <= 64 and all(x.is_integer() for x in ticks):  # few: all are named
        ax.xaxis.set_major_locator(NullLocator())
        ax.set_xticks(ticks, [f"{x:.0f}" for x in ticks])
        ax.xaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_locator(LogLocator(numticks=20))
    ax.yaxis.set_major_formatter(EngFormatter(unit="s"))
    ax.yaxis.set_minor_formatter(NullFormatter())
    ax.set_xlabel(quantity)
    ax.set_ylabel("processor time")
    ax.set_title(kind)
    ax.grid(True, which="major")
    ax.tick_params(which="minor", color=FAINT)
    ax.legend(loc="upper left", bbox_to_anchor=(-0.02, -0.2), borderaxespad=0.0)
