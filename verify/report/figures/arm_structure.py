"""Fig. 9 of the paper: the structure of an arm in space."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PINK,
    RED,
    panels,
    settings,
)

Array = NDArray[np.float64]

VIEW = np.array([[0.94, -0.34, 0.0], [0.12, 0.28, 0.95]])
"""World x, y, z onto the page: x to the right, z up, y into it."""
SAME_PLACE = 1e-9
AXIS = 0.16
"""Half the length of a drawn joint axis, of that of the arm."""
COLOURS = (BLUE, ORANGE, GREEN, PINK)


def arm_structure(joints: ArrayLike, axes: ArrayLike, tip: ArrayLike, mass: float) -> Figure:
    """Draw joints with their axes, the links between them, and the mass at the end.

    Parameters
    ----------
    joints, axes
        Position [m] and direction of each joint axis in the world, (n, 3).
    tip
        Where the arm ends (3,) [m].
    mass
        Mass drawn there [kg].

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If positions and axes do not belong together.
    """
    places, turning = np.asarray(joints, dtype=float), np.asarray(axes, dtype=float)
    if places.shape != turning.shape or places.ndim != 2 or places.shape[1] != 3:
        raise InputError("figure", "shape of axes", turning.shape, f"{places.shape}, rows of 3")
    end = np.asarray(tip, dtype=float)
    places = np.vstack([places, end])
    size = max(float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum()), SAME_PLACE)
    with settings():
        figure, (ax,) = panels(1, width=4.6, height=3.4)
        ax.plot(*_seen(places), color=INK, linewidth=3.0, solid_capstyle="round", zorder=2)
        for i, (place, direction) in enumerate(zip(places, turning, strict=False)):
            half = AXIS * size * direction
            _arrow(ax, place - half, 2 * half, f"$q_{{{i + 1}}}$", COLOURS[i % len(COLOURS)])
            ax.plot(*_seen(place), "o", color=INK, markersize=5, zorder=3)
        for a, b in itertools.pairwise(places):
            length = float(np.linalg.norm(b - a))
            if length > SAME_PLACE:
                x, y = _seen((a + b) / 2)
                ax.annotate(
                    f"{length:.3g} m",
                    (x, y),
                    xytext=(8, -10),
                    textcoords="offset points",
                    ha="left",
                    fontsize=8.5,
                    color=FAINT,
                )
        x, y = _seen(end)
        ax.plot(x, y, "o", color=RED, markersize=13, zorder=3)
        ax.annotate(
            f"{mass:g} kg",
            (x, y),
            xytext=(0, 11),
            textcoords="offset points",
            ha="center",
            fontsize=9,
            color=RED,
        )
        corner = places.min(axis=0) - np.array([0.25, 0.0, 0.3]) * size
        for direction, name in zip(np.eye(3), "xyz", strict=True):
            _arrow(ax, corner, 0.15 * size * direction, name, FAINT)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.margins(0.12)
        return figure


def _seen(points: Array) -> Array:
    """Return points (m, 3) or (3,) on the page: (2, m) or (2,)."""
    return np.asarray(VIEW @ points.T)


def _arrow(ax: Axes, start: Array, step: Array, name: str, colour: str) -> None:
    """Draw an arrow with a name at its head."""
    (x, y), (to_x, to_y) = _seen(start), _seen(start + step)
    ax.plot([x, to_x], [y, to_y], color=colour, linewidth=1.4, zorder=1)
    ax.annotate(
        "",
        xy=(to_x, to_y),
        xytext=(x, y),
        arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.4},
    )
    away = np.array([to_x - x, to_y - y])
    away *= 9 / max(float(np.linalg.norm(away)), SAME_PLACE)
    ax.annotate(
        name,
        (to_x, to_y),
        xytext=tuple(away),
        textcoords="offset points",
        ha="center",
        va="center",
        color=colour,
        fontsize=9.5,
    )
