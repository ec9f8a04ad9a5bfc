"""Fig. 1 of the paper: many configurations, one torque."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from isotorque.verify.report.figures.style import (
    CYCLE,
    FAINT,
    angle_plane,
    names_of,
    panels,
    rows,
    settings,
    subscript,
)


def many_to_one(q: ArrayLike, torques: ArrayLike) -> Figure:
    """Draw configurations of one absolute torque, and the signed torques they need.

    Parameters
    ----------
    q
        Configurations (m, 2) [rad].
    torques
        The torque of each, (m, 2) [N m], equal up to signs.

    Returns
    -------
    Figure
        Configurations on the left, torques on the right, in one colour where they belong together.
    """
    points, needed = rows(q, 2, what="q"), rows(torques, 2, what="torques")
    places = (points + np.pi) % (2 * np.pi) - np.pi
    signs = np.where(needed >= 0, 1, -1)
    kinds = np.unique(signs, axis=0)[::-1]
    with settings():
        figure, (left, right) = panels(2, width=3.7, height=3.6)
        angle_plane(left, names_of(None, 2)[:2])  # type: ignore[arg-type]
        left.set_title("configurations", pad=8)
        right.set_title("torques", pad=8)
        for kind, colour, mark in zip(kinds, CYCLE, "osD^", strict=False):
            chosen = np.all(signs == kind, axis=1)
            left.plot(*places[chosen].T, mark, color=colour, markersize=6.0)
            middle = needed[chosen].mean(axis=0)
            right.plot(*middle, mark, color=colour, markersize=8.0)
            right.annotate(
                f"{chosen.sum()} configurations",
                tuple(middle),
                xytext=(0, 9),
                textcoords="offset points",
                ha="center",
                fontsize=8,
                color=colour,
            )
        span = 1.9 * np.abs(needed).max(axis=0)
        right.set_xlim(-span[0], span[0])
        right.set_ylim(-span[1], span[1])
        right.axhline(0.0, linewidth=0.6, color=FAINT)
        right.axvline(0.0, linewidth=0.6, color=FAINT)
        right.set_xlabel(subscript("\\tau", 1) + " [N m]")
        right.set_ylabel(subscript("\\tau", 2) + " [N m]")
        return figure
