"""Fig. 11, 12, 14 and 15 of the paper: targets and where learned torques hold the arm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.marks import key, mark, ordered, polygon_on_torus
from isotorque.verify.report.figures.style import (
    BLUE,
    INK,
    PAPER,
    RED,
    angle_plane,
    joint_pairs,
    names_of,
    panels,
    rows,
    settings,
)


def maintained_map(
    targets: ArrayLike,
    observed: ArrayLike,
    held: ArrayLike,
    *,
    domain: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Figure:
    """Draw test targets (red crosses) and the equilibria of the learned torques (blue circles).

    Parameters
    ----------
    targets, observed
        Configurations (m, n) [rad].
    held
        Whether the arm, without controller, stayed there, (m,): filled circles; the others,
        unstable equilibria, are hollow.
    domain
        Corners of the domain of two joints, (v, 2) [rad].
    joint_names
        Labels of the joints.

    Returns
    -------
    Figure
        One panel for two joints, projections on three pairs for more.

    Raises
    ------
    InputError
        If the arrays do not have the same number of rows.
    """
    wanted, seen = rows(targets, what="targets"), rows(observed, what="observed")
    stays = np.asarray(held, dtype=bool)
    if not len(wanted) == len(seen) == len(stays):
        raise InputError(
            "figure",
            "rows of targets, observed, held",
            (len(wanted), len(seen), len(stays)),
            "equal numbers",
        )
    n = wanted.shape[1]
    names = names_of(joint_names, n)
    wanted, seen = ((x + np.pi) % (2 * np.pi) - np.pi for x in (wanted, seen))
    with settings():
        pairs = joint_pairs(n)
        figure, axes = panels(len(pairs), width=3.7, height=3.75)
        for ax, (i, j) in zip(axes, pairs, strict=True):
            angle_plane(ax, (names[i], names[j]))
            for chosen, face in ((stays, BLUE), (~stays, PAPER)):
                ax.plot(
                    seen[chosen, i],
                    seen[chosen, j],
                    "o",
                    color=BLUE,
                    markersize=5.2,
                    markerfacecolor=face,
                    markeredgewidth=0.9,
                )
            ax.plot(wanted[:, i], wanted[:, j], "x", color=RED, markersize=3.4)
            if domain is not None and n == 2:
                corners = ordered(rows(domain, 2, what="domain"))
                polygon_on_torus(ax, corners, fill=False, edgecolor=INK, linewidth=1.1)
        hollow = mark("o", BLUE, "equilibrium")
        hollow.set_markerfacecolor(PAPER)
        stay = int(stays.sum())
        key(axes[0], [mark("x", RED, "target"), mark("o", BLUE, f"held ({stay})"), hollow])
        return figure
