"""Fig. 9 of the paper: the structure of an arm in space."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from verify.figures.style import BLUE, FAINT, GREEN, INK, ORANGE, PINK, RED, panels, settings

Array = NDArray[np.float64]

VIEW = np.array([[0.94, -0.34, 0.0], [0.12, 0.28, 0.95]])
"""World x, y, z onto the page: x to the right, z up, y into it."""
SAME_PLACE = 1e-9


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
    chain = np.vstack([places, end]) @ VIEW.T
    size = max(float(np.linalg.norm(np.diff(np.vstack([places, end]), axis=0), axis=1).sum()), 1e-9)
    with settings():
        figure, (ax,) = panels(1, width=4.6, height=3.2)
        ax.plot(*chain.T, color=INK, linewidth=3.0, solid_capstyle="round", zorder=2)
        for i, (place, direction) in enumerate(zip(places, turning, strict=True)):
            colour = (BLUE, ORANGE, GREEN, PINK)[i % 4]
            half = 0.17 * size * direction
            ends = np.stack([place - half, place + half]) @ VIEW.T
            ax.annotate(
                "", xy=tuple(ends[1]), xytext=tuple(ends[0]),
                arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.6},
            )  # fmt: skip
            x, y = ends[1] + 0.03 * size
            ax.text(x, y, f"$q_{{{i + 1}}}$", color=colour, fontsize=10)
            ax.plot(*(place @ VIEW.T), "o", color=INK, markersize=5, zorder=3)
        for a, b in zip(np.vstack([places, end])[:-1], np.vstack([places, end])[1:], strict=True):
            length = float(np.linalg.norm(b - a))
            if length > SAME_PLACE:
                middle = (a + b) / 2 @ VIEW.T
                ax.annotate(
                    f"{length:g} m", tuple(middle), xytext=(0, -12), textcoords="offset points",
                    ha="center", fontsize=8.5, color=FAINT,
                )  # fmt: skip
        ax.plot(*(end @ VIEW.T), "o", color=RED, markersize=13, zorder=3)
        ax.annotate(
            f"{mass:g} kg", tuple(end @ VIEW.T), xytext=(0, 11), textcoords="offset points",
            ha="center", fontsize=9, color=RED,
        )  # fmt: skip
        corner = np.array([-0.3 * size, 0.0, -0.4 * size])
        for direction, name in zip(np.eye(3), "xyz", strict=True):
            ends = np.stack([corner, corner + 0.15 * size * direction]) @ VIEW.T
            ax.annotate(
                "", xy=tuple(ends[1]), xytext=tuple(ends[0]),
                arrowprops={"arrowstyle": "-|>", "color": FAINT, "linewidth": 0.9},
            )  # fmt: skip
            x, y = ends[1] + 0.015 * size
            ax.text(x, y, name, color=FAINT, fontsize=8, style="italic")
        ax.set_aspect("equal")
        ax.axis("off")
        ax.margins(0.1)
        return figure
