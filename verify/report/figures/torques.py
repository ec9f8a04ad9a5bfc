"""Fig. 3, 4 and 7 of the paper: torque profiles, what they lead to, and the static torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.style import (
    BLUE,
    FAINT,
    INK,
    JOINTS,
    RED,
    joint_pairs,
    panels,
    points,
    rows,
    settings,
    subscript,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ProfileTrace:
    """One torque profile and the motion it led to.

    Attributes
    ----------
    times : (T,) array
        Time since the profile began [s].
    torques : (T, n) array
        Torques applied [N m].
    q : (T, n) array
        Joint angles observed [rad].
    outcome : str
        "settled", "limit" or "timeout".
    final : (n,) array or None
        Where the arm came to rest under the last torque, or was stopped [rad]; the last observed
        angles by default.
    """

    times: Array
    torques: Array
    q: Array
    outcome: str
    final: Array | None = None

    def __post_init__(self) -> None:
        shape = (len(self.times), np.shape(self.q)[-1])
        for field in ("torques", "q"):
            if np.shape(getattr(self, field)) != shape:
                found = np.shape(getattr(self, field))
                raise InputError("profile trace", f"shape of {field}", found, f"{shape}")


def torque_profiles(
    traces: Sequence[ProfileTrace], *, joints: Sequence[int] | None = None
) -> Figure:
    """Draw torque profiles one after the other (Fig. 3), one line per joint.

    Parameters
    ----------
    traces
        Profiles in the order in which they were played.
    joints
        Numbers, from 0, of the joints to be shown; all by default.

    Returns
    -------
    Figure
    """
    with settings():
        figure, (ax,) = panels(1, width=5.6, height=2.5)
        start = 0.0
        shown = _shown(traces, joints)
        for trace in traces:
            for joint in shown:
                ax.plot(
                    start + trace.times,
                    trace.torques[:, joint],
                    color=JOINTS[joint % len(JOINTS)],
                    label=subscript("\\tau", joint + 1) if start == 0.0 else None,
                )
            start += float(trace.times[-1])
            ax.axvline(start, color=FAINT, linewidth=0.7, linestyle=(0, (2, 3)), zorder=0)
        ax.set_xlim(0.0, max(start, 1e-9))
        ax.set_xlabel("time [s]")
        ax.set_ylabel("torque [N m]")
        _legend(ax, len(shown))
        return figure


def joint_trajectories(
    traces: Sequence[ProfileTrace], *, joints: Sequence[int] | None = None
) -> Figure:
    """Draw the motion under torque profiles (Fig. 4).

    Parameters
    ----------
    traces
        Profiles in the order in which they were played. Black dots mark where the arm settled,
        red crosses where it met a joint limit (and went home) or did not settle in time.
    joints
        Numbers, from 0, of the joints to be shown; all by default.

    Returns
    -------
    Figure
    """
    with settings():
        figure, (ax,) = panels(1, width=5.6, height=2.5)
        start = 0.0
        shown = _shown(traces, joints)
        for trace in traces:
            for joint in shown:
                ax.plot(
                    start + trace.times,
                    trace.q[:, joint],
                    color=JOINTS[joint % len(JOINTS)],
                    label=subscript("q", joint + 1) if start == 0.0 else None,
                )
            start += float(trace.times[-1])
            settled = trace.outcome == "settled"
            last = trace.q[-1, shown]
            final = last if trace.final is None else trace.final[shown]
            for before, after in zip(last, final, strict=True):  # the wait is not drawn
                ax.plot([start, start], [before, after], color=FAINT, linewidth=0.8, zorder=1)
            ax.plot(
                np.full(len(shown), start),
                final,
                "o" if settled else "x",
                color=INK if settled else RED,
                markersize=4.0 if settled else 6.0,
                markeredgewidth=1.5,
                zorder=4,
                clip_on=False,
            )
        ax.set_xlim(0.0, max(start, 1e-9))
        ax.set_xlabel("time [s]")
        ax.set_ylabel("joint angle [rad]")
        ax.grid(True, axis="y")
        _legend(ax, len(shown))
        return figure


def static_torque_map(
    admissible: ArrayLike,
    inadmissible: ArrayLike,
    *,
    triangles: ArrayLike | None = None,
    boundary: ArrayLike | None = None,
    joints: Sequence[int] | None = None,
) -> Figure:
    """Draw static torques (blue) and torques that proved inadmissible (red crosses), Fig. 7.

    Parameters
    ----------
    admissible
        Torques under which the arm settled, (m, n) [N m].
    inadmissible
        Torques that drove it to a joint limit or did not settle, (k, n) [N m].
    triangles
        Corners of the triangles of the estimated set, (t, 3, 2) [N m]; two joints only.
    boundary
        Points (p, 2) of the true set's boundary [N m], NaN rows break it; two joints only.
    joints
        Numbers, from 0, of the joints to be shown; all by default.

    Returns
    -------
    Figure
        One panel for two joints, projections on three pairs for more.
    """
    good, bad = rows(admissible, what="admissible"), rows(inadmissible, what="inadmissible")
    n = good.shape[1]
    with settings():
        pairs = joint_pairs(n, joints)
        figure, axes = panels(len(pairs), width=4.4, height=3.5)
        for ax, (i, j) in zip(axes, pairs, strict=True):
            if triangles is not None and n == 2:
                cells = PolyCollection(
                    list(np.asarray(triangles, dtype=float)),
                    facecolors=BLUE,
                    alpha=0.16,
                    linewidths=0,
                )
                ax.add_collection(cells)
            if boundary is not None and n == 2:
                ax.plot(*rows(boundary, 2, what="boundary").T, color=INK, linewidth=1.0)
            points(ax, good[:, i], good[:, j], color=BLUE, s=7)
            if len(bad):
                ax.plot(
                    bad[:, i],
                    bad[:, j],
                    "x",
                    color=RED,
                    markersize=4,
                    markeredgewidth=0.9,
                    rasterized=len(bad) > 1500,
                )
            ax.set_xlabel(subscript("\\tau", i + 1) + " [N m]")
            ax.set_ylabel(subscript("\\tau", j + 1) + " [N m]")
            ax.grid(True)
        axes[0].plot([], [], "o", color=BLUE, markersize=4, label=f"settled ({len(good)})")
        axes[0].plot([], [], "x", color=RED, markersize=5, label=f"inadmissible ({len(bad)})")
        _legend(axes[0], 2)
        return figure


def _shown(traces: Sequence[ProfileTrace], joints: Sequence[int] | None) -> list[int]:
    if joints is not None:
        return list(joints)
    return list(range(np.shape(traces[0].q)[1])) if traces else []


def _legend(ax: Axes, columns: int) -> None:
    if not columns:
        return
    ax.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=columns,
        borderaxespad=0.1,
        handlelength=1.4,
        columnspacing=1.2,
    )
