"""Colours, axes and output shared by all figures."""

from __future__ import annotations

import io
import itertools
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import AbstractPathEffect, withStroke
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

BLUE, RED, GREEN, ORANGE = "#0072b2", "#d55e00", "#009e73", "#e69f00"
SKY, PINK = "#56b4e9", "#cc79a7"
"""Colours that colour-blind people can tell apart (Okabe and Ito, 2008)."""

INK, FAINT, PAPER = "#1b1c1d", "#8a8b8c", "#fdfefc"
"""Lines and text, grid, and background: on a page they follow its light or dark scheme."""

CYCLE = (BLUE, RED, GREEN, ORANGE, PINK, SKY)
JOINTS = (BLUE, ORANGE, INK, PINK, SKY, GREEN)
"""Colours of sets and learners, and of joints, where red is kept for what went wrong."""

_VARIABLES = {
    BLUE: "blue",
    RED: "red",
    GREEN: "green",
    ORANGE: "orange",
    SKY: "sky",
    PINK: "pink",
    INK: "ink",
    FAINT: "faint",
    PAPER: "paper",
}
_SETTINGS: Any = {
    "svg.fonttype": "path",
    "svg.hashsalt": "isotorque",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "grid.color": FAINT,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.4,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
    "axes.axisbelow": True,
}
MANY_POINTS = 1500
"""Scatters of more points are drawn as pixels inside the vector graphics, to keep files small."""


def settings() -> Any:
    """Return the context in which figures are made and written."""
    return mpl.rc_context(_SETTINGS)


def panels(count: int, *, width: float = 3.4, height: float = 3.2) -> tuple[Figure, list[Axes]]:
    """Return a figure with ``count`` axes side by side, each ``width`` x ``height`` inches."""
    engine = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06)
    figure = Figure(figsize=(width * count, height), layout=engine)
    axes = figure.subplots(1, count, squeeze=False)
    return figure, list(axes[0])


def joint_pairs(n: int, joints: Sequence[int] | None = None) -> list[tuple[int, int]]:
    """Return the pairs of joints that n-dimensional sets are projected on: at most three.

    Parameters
    ----------
    n
        Number of joints.
    joints
        Numbers, from 0, of those to be shown; all by default.

    Examples
    --------
    >>> joint_pairs(2), joint_pairs(3), joint_pairs(6, [1, 2, 4, 5])
    ([(0, 1)], [(0, 1), (0, 2), (1, 2)], [(1, 2), (1, 4), (2, 4)])
    """
    shown = range(n) if joints is None else joints
    if len(shown) < 2:
        return [(shown[0], shown[0])]
    return list(itertools.combinations(shown[:3], 2))


def angle_axis(axes: Axes, which: str, name: str, limits: tuple[float, float] | None) -> None:
    """Label an axis as a joint angle with ticks at multiples of pi/2."""
    low, high = (-np.pi, np.pi) if limits is None else limits
    margin = 0.03 * (high - low)
    ticks = [
        i * np.pi / 2
        for i in range(
            math.ceil((low - 1e-9) / (np.pi / 2)), math.floor((high + 1e-9) / (np.pi / 2)) + 1
        )
    ]
    set_limits = axes.set_xlim if which == "x" else axes.set_ylim
    set_limits(low - margin, high + margin)
    if len(ticks) >= 3:
        axis = axes.xaxis if which == "x" else axes.yaxis
        axis.set_ticks(ticks, [_pi_text(tick) for tick in ticks])
    (axes.set_xlabel if which == "x" else axes.set_ylabel)(f"{name} [rad]")


def angle_plane(
    axes: Axes,
    names: tuple[str, str],
    limits: ArrayLike | None = None,
) -> None:
    """Make axes a plane of two joint angles, as in the paper's configuration spaces."""
    box = None if limits is None else np.asarray(limits, dtype=float)
    for index, which in enumerate("xy"):
        span = None if box is None else (float(box[index, 0]), float(box[index, 1]))
        angle_axis(axes, which, names[index], span)
    axes.set_aspect("equal")
    axes.grid(True)


def subscript(name: str, index: int) -> str:
    """Return ``name`` with a subscript, e.g. q and 1."""
    return f"${name}_{{{index}}}$"


def points(axes: Axes, x: ArrayLike, y: ArrayLike, **options: Any) -> None:
    """Scatter points; many of them as pixels."""
    options = {"s": 4, "linewidths": 0, **options}
    axes.scatter(x, y, rasterized=np.size(x) > MANY_POINTS, **options)


def halo() -> list[AbstractPathEffect]:
    """Return the effect that keeps text readable on lines: an outline in the page's colour."""
    return [withStroke(linewidth=2.5, foreground=PAPER)]


def to_svg(figure: Figure, title: str, *, prefix: str = "") -> str:
    """Return a figure as SVG for a page, following the page's colour scheme.

    Parameters
    ----------
    figure
        The figure.
    title
        What it shows, for people who cannot see it.
    prefix
        Put before all ids, so that several figures can stand in one page.

    Notes
    -----
    Each colour becomes ``var(--name, #colour)``: a page may set ``--ink``, ``--paper``,
    ``--faint``, ``--blue`` ... and otherwise the colours on white are used.
    """
    buffer = io.StringIO()
    with settings():
        figure.savefig(buffer, format="svg", dpi=180, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    for colour, name in _VARIABLES.items():
        text = re.sub(rf"(?<=: ){colour}\b", f"var(--{name}, {colour})", text)
    if prefix:
        text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", text)
    label = title.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return text.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1).strip()


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure on white: .svg and .pdf are vector graphics, .png is pixels.

    Raises
    ------
    InputError
        If the file cannot be written or its ending is unknown.
    """
    ending = Path(path).suffix.lower()
    if ending not in {".svg", ".pdf", ".png"}:
        raise InputError(path, "ending", ending or "none", ".svg, .pdf or .png")
    metadata: dict[str, Any] = {} if ending == ".png" else {"Creator": None}
    if ending == ".svg":
        metadata["Date"] = None
    if ending == ".pdf":
        metadata["CreationDate"] = None
    try:
        with settings():
            figure.savefig(path, dpi=180, facecolor="white", metadata=metadata)
    except OSError as error:
        raise InputError(path, "file", error.strerror or error, "a writable path") from None


def rows(values: ArrayLike, columns: int | None = None, *, what: str) -> NDArray[np.float64]:
    """Return an array of rows, shape (m, columns), refusing other shapes."""
    found = np.asarray(values, dtype=float)
    if found.ndim != 2 or (columns is not None and found.shape[1] != columns):
        raise InputError("figure", f"shape of {what}", found.shape, f"(m, {columns or 'n'})")
    return found


def names_of(names: Sequence[str] | None, n: int) -> tuple[str, ...]:
    """Return the labels of joint angles: the given names or q_1, q_2, ..."""
    if names is None:
        return tuple(subscript("q", i + 1) for i in range(n))
    return tuple(names)


def _pi_text(angle: float) -> str:
    halves = round(angle / (np.pi / 2))
    if halves == 0:
        return "0"
    sign, size = ("−" if halves < 0 else ""), abs(halves)
    if size % 2:
        return f"{sign}{'' if size == 1 else size}π/2"
    return f"{sign}{'' if size == 2 else size // 2}π"
