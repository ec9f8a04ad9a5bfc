"""Fig. 5 of the paper: physical and virtual joint angles of an arm with two joints."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc
from numpy.typing import ArrayLike

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.style import BLUE, FAINT, GREEN, INK, ORANGE, panels, settings


def joint_angles(links: ArrayLike) -> Figure:
    """Draw q1, q2 and the virtual angle q* = q1 + q2 of a planar arm.

    Parameters
    ----------
    links
        Positions of shoulder, elbow and tip (3, 2) [m].

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are not three points in a plane.
    """
    chain = np.asarray(links, dtype=float)
    if chain.shape != (3, 2):
        raise InputError("figure", "shape of links", chain.shape, "(3, 2)")
    steps = np.diff(chain, axis=0)
    size = float(np.linalg.norm(steps, axis=1).sum())
    first, second = np.degrees(np.arctan2(steps[:, 1], steps[:, 0]))
    with settings():
        figure, (ax,) = panels(1, width=3.9, height=3.2)
        for start, direction in ((chain[0], (1.0, 0.0)), (chain[1], (1.0, 0.0))):
            end = start + 0.45 * size * np.array(direction)
            ax.plot(*np.stack([start, end]).T, color=FAINT, linestyle=(0, (4, 3)), linewidth=0.9)
        ahead = chain[1] + 0.4 * size * steps[0] / np.linalg.norm(steps[0])
        ax.plot(*np.stack([chain[1], ahead]).T, color=FAINT, linestyle=(0, (4, 3)), linewidth=0.9)
        ax.plot(*chain.T, color=INK, linewidth=3.0, solid_capstyle="round")
        ax.plot(*chain[0], "s", color=INK, markersize=8)
        ax.plot(*chain[1:].T, "o", color=INK, markersize=6)
        _arc(ax, chain[0], 0.22 * size, 0.0, float(first), "$q_1$", BLUE)
        _arc(ax, chain[1], 0.2 * size, float(first), float(second), "$q_2$", ORANGE)
        _arc(ax, chain[1], 0.33 * size, 0.0, float(second), "$q^* = q_1 + q_2$", GREEN)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.margins(0.12)
        return figure


def _arc(
    ax: Axes, center: ArrayLike, radius: float, start: float, end: float, text: str, colour: str
) -> None:
    """Draw an angle between two directions [degrees] with its name."""
    x, y = np.asarray(center, dtype=float)
    low, high = sorted((start, end))
    ax.add_patch(
        Arc((x, y), 2 * radius, 2 * radius, theta1=low, theta2=high, color=colour, linewidth=1.6)
    )
    middle = np.radians((start + end) / 2)
    ax.annotate(
        text,
        (x + radius * np.cos(middle), y + radius * np.sin(middle)),
        xytext=(5 * np.cos(middle), 5 * np.sin(middle)),
        textcoords="offset points",
        color=colour,
        ha="left",
        va="center",
        fontsize=9,
    )
