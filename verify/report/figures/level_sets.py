"""Fig. 2 of the paper: level sets and symmetric configurations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from isotorque.verify.report.figures.style import (
    BLUE,
    CYCLE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PAPER,
    RED,
    angle_plane,
    halo,
    names_of,
    panels,
    rows,
    settings,
    subscript,
)

Array = NDArray[np.float64]

FINE = 0.01
"""Longest stroke of a curve [rad]."""

PANEL_POINTS, LABEL_DISTANCE = 215.0, 9.5
"""Width of a panel of stick figures and distance of a number from its tip, in printer's points."""


def stick_figure(
    links: ArrayLike,
    sets: ArrayLike,
    *,
    labels: Sequence[str] | None = None,
    stable: ArrayLike | None = None,
) -> Figure:
    """Draw symmetric configurations as stick figures, one panel per primary set (Fig. 2A).

    Parameters
    ----------
    links
        Positions of the joints and the tip in the drawing plane, (m, joints + 1, 2) [m]; gravity
        points down.
    sets
        Primary set of each configuration, (m,), counted from 0.
    labels
        Number of each configuration; 1, 2, ... within each set by default.
    stable
        Whether each is a stable equilibrium, (m,); unstable ones are dashed with hollow tips.

    Returns
    -------
    Figure
    """
    chains = np.asarray(links, dtype=float)
    member = np.asarray(sets, dtype=int)
    steady = np.ones(len(chains), bool) if stable is None else np.asarray(stable, dtype=bool)
    reach = 1.24 * np.linalg.norm(chains, axis=-1).max(initial=0.1)
    with settings():
        count = int(member.max(initial=0)) + 1
        figure, axes = panels(count, width=3.2, height=3.35)
        for index, ax in enumerate(axes):
            chosen = np.flatnonzero(member == index)
            colour = CYCLE[index % len(CYCLE)]
            _gravity_frame(ax, reach)
            for i in chosen:
                _arm(ax, chains[i], colour, bool(steady[i]))
            texts = [str(i) for i in range(1, len(chosen) + 1)]
            if labels is not None:
                texts = [labels[i] for i in chosen.tolist()]
            _number(ax, chains[chosen], texts, PANEL_POINTS / (2 * reach))
            title = f"$S_{{{chr(65 + index)}}}$" if index < 26 else f"set {index + 1}"
            ax.set_title(f"{title}: {len(chosen)} configurations", pad=8)
        return figure


def _gravity_frame(ax: Axes, reach: float) -> None:
    ax.axvline(0.0, color=FAINT, linewidth=0.7, linestyle=(0, (2, 3)), zorder=0)
    ax.axhline(0.0, color=FAINT, linewidth=0.7, linestyle=(0, (2, 3)), zorder=0)
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_aspect("equal")
    ax.axis("off")
    arrow = {"arrowstyle": "-|>", "color": FAINT, "linewidth": 1.0, "mutation_scale": 9}
    ax.annotate(
        "",
        xy=(-0.93 * reach, 0.68 * reach),
        xytext=(-0.93 * reach, 0.95 * reach),
        arrowprops=arrow,
    )
    ax.text(-0.87 * reach, 0.8 * reach, "g", color=FAINT, style="italic", va="center")


def _arm(ax: Axes, chain: Array, colour: str, stable: bool) -> None:
    style = "-" if stable else (0, (3, 1.5))
    ax.plot(
        chain[:, 0],
        chain[:, 1],
        color=colour,
        linewidth=1.8 if stable else 1.2,
        linestyle=style,
        solid_capstyle="round",
        zorder=2,
    )
    ax.plot(*chain[1:-1].T, "o", color=INK, markersize=3.2, zorder=3)
    ax.plot(*chain[0], "s", color=INK, markersize=5.0, zorder=4)
    face = colour if stable else PAPER
    ax.plot(*chain[-1], "o", color=colour, markerfacecolor=face, markersize=5.0, zorder=3)


def _number(ax: Axes, chains: Array, texts: Sequence[str], scale: float) -> None:
    """Write a number beside each tip, outwards, pushed apart where tips lie close together."""
    tips = chains[:, -1] * scale  # printer's points
    outward = _unit(chains[:, -1] - chains[:, -2]) + 0.6 * _unit(chains[:, -1] - chains[:, 0])
    places = tips + LABEL_DISTANCE * _unit(outward)
    for _ in range(60):
        gap = places[:, None] - places[None]
        distance = np.linalg.norm(gap, axis=-1) + 1e-9
        crowded = np.clip(LABEL_DISTANCE - distance, 0.0, None)
        np.fill_diagonal(crowded, 0.0)
        places += 0.25 * (gap / distance[..., None] * crowded[..., None]).sum(axis=1)
        away = places - tips
        size = np.linalg.norm(away, axis=-1, keepdims=True)
        places = tips + away * np.maximum(1.0, 0.8 * LABEL_DISTANCE / np.maximum(size, 1e-9))
    for tip, place, text in zip(chains[:, -1], places - tips, texts, strict=True):
        ax.annotate(
            text,
            tip,
            xytext=tuple(place),
            textcoords="offset points",
            ha="center",
            va="center",
            color=INK,
            fontsize=8.5,
            zorder=5,
        )


def _unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)


def level_set_map(
    curves: Sequence[tuple[int, int, ArrayLike]],
    q: ArrayLike,
    sets: ArrayLike,
    *,
    labels: Sequence[str] | None = None,
    stable: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Figure:
    """Draw component-wise level sets and their intersections in the configuration plane (Fig. 2B).

    Parameters
    ----------
    curves
        Component-wise level sets (Eq. 6 and 7): component (0 or 1), sign (+1 or -1), and points
        (p, 2) [rad] in order along the curve, drawn modulo 2 pi; NaN rows break it.
    q
        Symmetric configurations (m, 2) [rad], drawn modulo 2 pi.
    sets, labels, stable
        As in `stick_figure`; unstable equilibria are drawn hollow.
    joint_names
        Labels of the two axes.

    Returns
    -------
    Figure
    """
    found = rows(q, 2, what="q")
    wrapped = (found + np.pi) % (2 * np.pi) - np.pi
    member = np.asarray(sets, dtype=int)
    steady = np.ones(len(found), bool) if stable is None else np.asarray(stable, dtype=bool)
    with settings():
        figure, (ax,) = panels(1, width=4.4, height=4.0)
        angle_plane(ax, names_of(joint_names, 2)[:2])  # type: ignore[arg-type]
        seen = set()
        for component, sign, line in curves:
            colour = GREEN if component == 0 else ORANGE
            name = ("−" if sign < 0 else "+") + subscript("\\tau", component + 1)
            path = _broken(rows(line, 2, what="curve"))
            ax.plot(
                path[:, 0],
                path[:, 1],
                color=colour,
                linewidth=1.3,
                linestyle="-" if sign > 0 else (0, (4, 2)),
                label=None if (component, sign) in seen else name,
            )
            seen.add((component, sign))
        counts: dict[int, int] = {}
        for i, (point, index) in enumerate(zip(wrapped, member, strict=True)):
            counts[index] = counts.get(index, 0) + 1
            colour = (BLUE, RED)[index % 2] if index < 2 else CYCLE[index % len(CYCLE)]
            ax.plot(
                *point,
                "o",
                color=colour,
                markersize=6.0,
                zorder=4,
                markerfacecolor=colour if steady[i] else PAPER,
                markeredgewidth=1.3,
            )
            text = str(counts[index]) if labels is None else labels[i]
            ax.annotate(
                text,
                point,
                xytext=(6, 5),
                textcoords="offset points",
                color=colour,
                fontsize=8.5,
                fontweight="bold",
                zorder=5,
                path_effects=halo(),
            )
        ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), handlelength=2.2, borderaxespad=0.2)
        return figure


def _broken(path: Array) -> Array:
    """Wrap a curve into one turn and break it where it jumps across the edge."""
    if len(path) < 2:
        return path
    gaps = np.diff(path, axis=0)
    length = np.nan_to_num(np.abs(gaps).max(axis=1))
    pieces = np.maximum(np.ceil(length / FINE).astype(int), 1)
    start = np.repeat(np.arange(len(gaps)), pieces)
    step = np.arange(len(start)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    dense = path[start] + (step / pieces[start])[:, None] * gaps[start]
    dense = np.concatenate([dense, path[-1:]])
    wrapped = (dense + np.pi) % (2 * np.pi) - np.pi
    jump = np.any(np.abs(np.diff(wrapped, axis=0)) > np.pi, axis=1)
    return np.insert(wrapped, np.flatnonzero(jump) + 1, np.nan, axis=0)


def planar_chain(q: ArrayLike, lengths: ArrayLike) -> Array:
    """Return joint and tip positions of planar arms, q = 0 stretched out to the right.

    Parameters
    ----------
    q
        Configurations (m, n) [rad], positive angles turning upwards.
    lengths
        Link lengths (n,) [m].

    Returns
    -------
    (m, n + 1, 2) array
        Horizontal and vertical position [m].

    Examples
    --------
    >>> planar_chain([[0.0, np.pi / 2]], [0.25, 0.25]).round(3).tolist()
    [[[0.0, 0.0], [0.25, 0.0], [0.25, 0.25]]]
    """
    direction = np.cumsum(np.asarray(q, dtype=float), axis=-1)
    steps = np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    steps = steps * np.asarray(lengths, dtype=float)[:, None]
    origin = np.zeros((*steps.shape[:-2], 1, 2))
    return np.concatenate([origin, np.cumsum(steps, axis=-2)], axis=-2)
