"""Fig. 6 and 10 of the paper: sets in the configuration space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from isotorque.verify.report.figures.marks import key, mark, ordered, polygon_on_torus
from isotorque.verify.report.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    RED,
    angle_plane,
    joint_pairs,
    names_of,
    panels,
    points,
    rows,
    settings,
)

Array = NDArray[np.float64]


def domain_map(
    polygon: ArrayLike,
    *,
    images: ArrayLike | None = None,
    stable: ArrayLike | None = None,
    center: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Figure:
    """Draw a fundamental domain of two joints (BCTS, Fig. 6).

    Parameters
    ----------
    polygon
        Its corners (v, 2) [rad], in any order (it is convex).
    images
        Corners of its images under the group, (g, v, 2) [rad], drawn as outlines modulo 2 pi.
    stable
        Corners of the regions where the arm can hold itself, (k, v, 2) [rad], shaded.
    center
        Its centre (2,) [rad].
    joint_names
        Labels of the two axes.

    Returns
    -------
    Figure
    """
    corners = ordered(rows(polygon, 2, what="polygon"))
    with settings():
        figure, (ax,) = panels(1, width=3.9, height=3.85)
        angle_plane(ax, names_of(joint_names, 2)[:2])  # type: ignore[arg-type]
        shade = {"facecolor": BLUE, "alpha": 0.13, "linewidth": 0}
        outline = {"fill": False, "edgecolor": FAINT, "linewidth": 0.8}
        inside = {"facecolor": GREEN, "alpha": 0.45, "linewidth": 0}
        entries: list[tuple[str, dict[str, Any]]] = [("BCTS", inside)]
        if stable is not None:
            entries.append(("can hold itself", shade))
            for region in np.asarray(stable, dtype=float):
                polygon_on_torus(ax, ordered(region), **shade)
        if images is not None:
            entries.append((f"its {len(np.asarray(images))} images", outline))
            for image in np.asarray(images, dtype=float):
                polygon_on_torus(ax, ordered(image), **outline)
        polygon_on_torus(ax, corners, **inside)
        polygon_on_torus(ax, corners, fill=False, edgecolor=GREEN, linewidth=1.6)
        if center is not None:
            ax.plot(*np.asarray(center, dtype=float), "+", color=INK, markersize=7)
        key(ax, [Patch(label=label, **look) for label, look in entries])
        return figure


def explored_map(
    explored: ArrayLike,
    learned: ArrayLike,
    *,
    domain: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
    joints: Sequence[int] | None = None,
) -> Figure:
    """Draw explored (red) and learned (blue) configurations (Fig. 10).

    Parameters
    ----------
    explored
        Configurations the arm visited while learning, (m, n) [rad].
    learned
        Configurations whose torque was learned from those by symmetry, (k, n) [rad].
    domain
        Corners of the domain of two joints, (v, 2) [rad].
    joint_names
        Labels of the joints.
    joints
        Numbers, from 0, of the joints to be shown; all by default.

    Returns
    -------
    Figure
        One panel for two joints, projections on three pairs for more.
    """
    red, blue = rows(explored, what="explored"), rows(learned, what="learned")
    n = red.shape[1]
    names = names_of(joint_names, n)
    with settings():
        pairs = joint_pairs(n, joints)
        figure, axes = panels(len(pairs), width=3.7, height=3.75)
        for ax, (i, j) in zip(axes, pairs, strict=True):
            angle_plane(ax, (names[i], names[j]))
            for values, colour, size in ((blue, BLUE, 2.5), (red, RED, 3.5)):
                wrapped = (values + np.pi) % (2 * np.pi) - np.pi
                points(ax, wrapped[:, i], wrapped[:, j], color=colour, s=size, alpha=0.7)
            if domain is not None and n == 2:
                corners = ordered(rows(domain, 2, what="domain"))
                polygon_on_torus(ax, corners, fill=False, edgecolor=INK, linewidth=1.1)
        marks = ((f"explored ({len(red)})", RED), (f"learned ({len(blue)})", BLUE))
        key(axes[0], [mark("o", colour, label) for label, colour in marks])
        return figure
