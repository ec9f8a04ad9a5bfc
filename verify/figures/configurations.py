"""Fig. 6, 10 and 11 of the paper: sets in the configuration space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle
from numpy.typing import ArrayLike, NDArray

from verify.figures.style import (
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
    corners = _ordered(rows(polygon, 2, what="polygon"))
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
                _polygon(ax, _ordered(region), **shade)
        if images is not None:
            entries.append((f"its {len(np.asarray(images))} images", outline))
            for image in np.asarray(images, dtype=float):
                _polygon(ax, _ordered(image), **outline)
        _polygon(ax, corners, **inside)
        _polygon(ax, corners, fill=False, edgecolor=GREEN, linewidth=1.6)
        if center is not None:
            ax.plot(*np.asarray(center, dtype=float), "+", color=INK, markersize=7)
        _key(ax, [Patch(label=label, **look) for label, look in entries])
        return figure


def explored_map(
    explored: ArrayLike,
    learned: ArrayLike,
    *,
    domain: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
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

    Returns
    -------
    Figure
        One panel for two joints, projections on three pairs for more.
    """
    red, blue = rows(explored, what="explored"), rows(learned, what="learned")
    n = red.shape[1]
    names = names_of(joint_names, n)
    with settings():
        pairs = joint_pairs(n)
        figure, axes = panels(len(pairs), width=3.7, height=3.75)
        for ax, (i, j) in zip(axes, pairs, strict=True):
            angle_plane(ax, (names[i], names[j]))
            for values, colour, size in ((blue, BLUE, 2.5), (red, RED, 3.5)):
                wrapped = (values + np.pi) % (2 * np.pi) - np.pi
                points(ax, wrapped[:, i], wrapped[:, j], color=colour, s=size, alpha=0.7)
            if domain is not None and n == 2:
                corners = _ordered(rows(domain, 2, what="domain"))
                _polygon(ax, corners, fill=False, edgecolor=INK, linewidth=1.1)
        marks = ((f"explored ({len(red)})", RED), (f"learned ({len(blue)})", BLUE))
        _key(axes[0], [_mark("o", colour, label) for label, colour in marks])
        return figure


def reached_map(
    targets: ArrayLike,
    observed: ArrayLike,
    *,
    domain: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Figure:
    """Draw test targets (red crosses) and where the arm stayed (blue circles), Fig. 11 and 12.

    Parameters
    ----------
    targets, observed
        Configurations (m, n) [rad].
    domain
        Corners of the domain of two joints, (v, 2) [rad].
    joint_names
        Labels of the joints.

    Returns
    -------
    Figure
    """
    wanted, seen = rows(targets, what="targets"), rows(observed, what="observed")
    n = wanted.shape[1]
    names = names_of(joint_names, n)
    with settings():
        pairs = joint_pairs(n)
        figure, axes = panels(len(pairs), width=3.7, height=3.75)
        for ax, (i, j) in zip(axes, pairs, strict=True):
            angle_plane(ax, (names[i], names[j]))
            seen_at, wanted_at = ((x + np.pi) % (2 * np.pi) - np.pi for x in (seen, wanted))
            ax.plot(
                seen_at[:, i], seen_at[:, j], "o", color=BLUE, markersize=5.0,
                markerfacecolor="none", markeredgewidth=0.9,
            )  # fmt: skip
            ax.plot(wanted_at[:, i], wanted_at[:, j], "x", color=RED, markersize=3.6)
            if domain is not None and n == 2:
                corners = _ordered(rows(domain, 2, what="domain"))
                _polygon(ax, corners, fill=False, edgecolor=INK, linewidth=1.1)
        circle = _mark("o", BLUE, "observed")
        circle.set_markerfacecolor("none")
        _key(axes[0], [_mark("x", RED, "target"), circle])
        return figure


def _key(ax: Axes, handles: Sequence[Artist]) -> None:
    ax.legend(
        handles=list(handles), loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=len(handles),
        borderaxespad=0.2, handletextpad=0.5, columnspacing=1.2, handlelength=1.2,
    )  # fmt: skip


def _mark(marker: str, colour: str, label: str) -> Line2D:
    return Line2D([], [], linestyle="", marker=marker, color=colour, markersize=5, label=label)


def _polygon(ax: Axes, corners: Array, **look: Any) -> None:
    """Draw a polygon on the torus: all its copies, cut at the edges of the square of one turn."""
    square = Rectangle((-np.pi, -np.pi), 2 * np.pi, 2 * np.pi, transform=ax.transData)
    for copy in _on_the_torus(corners):
        patch = Polygon(copy, **look)
        ax.add_patch(patch)
        patch.set_clip_path(square)


def _ordered(corners: Array) -> Array:
    """Order the corners of a convex polygon around its middle."""
    middle = corners.mean(axis=0)
    angle = np.arctan2(corners[:, 1] - middle[1], corners[:, 0] - middle[0])
    return np.asarray(corners[np.argsort(angle)])


def _on_the_torus(corners: Array) -> list[Array]:
    """Return the copies of a polygon, shifted by whole turns, that meet the square of one turn."""
    near = corners - 2 * np.pi * np.round(corners.mean(axis=0) / (2 * np.pi))
    turns = 2 * np.pi * np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2)
    copies = [near + turn for turn in turns]
    edge = np.pi - 1e-6
    return [c for c in copies if np.all(c.min(axis=0) < edge) and np.all(c.max(axis=0) > -edge)]
