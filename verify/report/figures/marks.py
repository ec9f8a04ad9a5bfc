"""Keys, marks and polygons on the torus, for maps of configurations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

Array = NDArray[np.float64]


def key(ax: Axes, handles: Sequence[Artist]) -> None:
    """Put a key above the axes."""
    ax.legend(
        handles=list(handles),
        loc="lower left",
        bbox_to_anchor=(-0.02, 1.0),
        ncols=len(handles),
        borderaxespad=0.2,
        handletextpad=0.5,
        columnspacing=1.2,
        handlelength=1.2,
    )


def mark(marker: str, colour: str, label: str) -> Line2D:
    """Return a mark for a key."""
    return Line2D([], [], linestyle="", marker=marker, color=colour, markersize=5, label=label)


def polygon_on_torus(ax: Axes, corners: Array, **look: Any) -> None:
    """Draw a polygon on the torus: all its copies, cut at the edges of the square of one turn."""
    square = Rectangle((-np.pi, -np.pi), 2 * np.pi, 2 * np.pi, transform=ax.transData)
    for copy in _copies(corners):
        patch = Polygon(copy, **look)
        ax.add_patch(patch)
        patch.set_clip_path(square)


def ordered(corners: Array) -> Array:
    """Order the corners of a convex polygon around its middle."""
    middle = corners.mean(axis=0)
    angle = np.arctan2(corners[:, 1] - middle[1], corners[:, 0] - middle[0])
    return np.asarray(corners[np.argsort(angle)])


def _copies(corners: Array) -> list[Array]:
    """Return the copies of a polygon, shifted by whole turns, that meet the square of one turn."""
    near = corners - 2 * np.pi * np.round(corners.mean(axis=0) / (2 * np.pi))
    turns = 2 * np.pi * np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2)
    copies = [near + turn for turn in turns]
    edge = np.pi - 1e-6
    return [c for c in copies if np.all(c.min(axis=0) < edge) and np.all(c.max(axis=0) > -edge)]
