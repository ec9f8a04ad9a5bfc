"""Fig. 13 of the paper: torque error against the number of samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.style import CYCLE, FAINT, INK, panels, settings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LearningCurve:
    """Torque error while learning.

    Attributes
    ----------
    name : str
        What was learned how, and on which test set the error is measured.
    samples : (c,) array
        Number of real samples so far, increasing.
    rmse : (c,) array
        Torque RMSE then [N m].
    low, high : (c,) arrays or None
        Interval over several runs [N m].
    """

    name: str
    samples: Array
    rmse: Array
    low: Array | None = None
    high: Array | None = None

    def __post_init__(self) -> None:
        for field in ("rmse", "low", "high"):
            values = getattr(self, field)
            if values is not None and np.shape(values) != np.shape(self.samples):
                raise InputError(
                    "learning curve",
                    f"shape of {field}",
                    np.shape(values),
                    f"{np.shape(self.samples)}, one error per number of samples",
                )


def learning_curves(
    curves: Sequence[LearningCurve],
    *,
    goal: float | None = None,
    logarithmic: bool = True,
    iteration: int | None = None,
    published: Sequence[tuple[float, float]] = (),
    top: float | None = None,
    known: int | None = None,
) -> Figure:
    """Draw torque RMSE against samples (Fig. 13).

    Parameters
    ----------
    curves
        One line each.
    goal
        A torque error to compare with [N m], drawn as a dashed line.
    logarithmic
        Whether both axes are logarithmic; the paper's are linear.
    iteration
        Samples per iteration: the lower axis then counts iterations, as the paper's does.
    published
        Samples and torque errors [N m] printed elsewhere, drawn as marks to compare with.
    top
        Upper end of a linear axis of errors [N m]; all errors by default.
    known
        Samples after which another learner knew everything, drawn as a dotted line.

    Returns
    -------
    Figure
    """
    with settings():
        figure, (ax,) = panels(1, width=5.2, height=3.1)
        _draw(ax, curves, 1 if iteration is None else iteration, published)
        if goal is not None:
            ax.axhline(goal, color=INK, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
            ax.annotate(
                f"{goal:g} N m",
                (1.0, goal),
                xycoords=("axes fraction", "data"),
                xytext=(-2, 3),
                textcoords="offset points",
                ha="right",
                fontsize=8,
                color=INK,
            )
        if known is not None:
            ax.axvline(known, color=INK, linewidth=0.9, linestyle=":", zorder=1)
            ax.annotate(
                f"rigid chain: {known}",
                (known, 0.0),
                xycoords=("data", "axes fraction"),
                xytext=(3, 4),
                textcoords="offset points",
                fontsize=8,
                color=INK,
            )
        if logarithmic:
            _logarithmic(ax, curves, known)
        else:
            ax.set_ylim(bottom=0.0, top=top)
        ax.set_xlabel("samples" if iteration is None else f"iterations of {iteration} samples")
        _finish(ax, bool(curves))
        return figure


def curve_panels(robots: Mapping[str, Sequence[LearningCurve]]) -> Figure:
    """Draw torque RMSE against samples, one panel per robot, logarithmic axes.

    Parameters
    ----------
    robots
        The curves of each.

    Returns
    -------
    Figure
    """
    with settings():
        figure, axes = panels(max(1, len(robots)), width=4.4, height=3.1)
        for ax, (name, curves) in zip(axes, robots.items(), strict=False):
            _draw(ax, curves, 1, ())
            _logarithmic(ax, curves)
            ax.set_title(name)
            ax.set_xlabel("samples")
            _finish(ax, bool(curves))
        return figure


def _draw(
    ax: Axes,
    curves: Sequence[LearningCurve],
    per_tick: int,
    published: Sequence[tuple[float, float]],
) -> None:
    for index, curve in enumerate(curves):
        colour = CYCLE[index % len(CYCLE)]
        x = np.asarray(curve.samples, dtype=float) / per_tick
        marker = "o" if len(x) <= 25 else None
        ax.plot(x, curve.rmse, color=colour, label=curve.name, marker=marker, markersize=3.0)
        if curve.low is not None and curve.high is not None:
            ax.fill_between(x, curve.low, curve.high, color=colour, alpha=0.18, linewidth=0)
    if published:
        x, y = np.array(published, dtype=float).T
        ax.plot(
            x / per_tick,
            y,
            "D",
            color=INK,
            markersize=4.5,
            markerfacecolor="none",
            label="printed in the paper",
            zorder=5,
        )


def _logarithmic(ax: Axes, curves: Sequence[LearningCurve], known: int | None = None) -> None:
    positive = [x for curve in curves for x in np.atleast_1d(curve.samples) if x > 0]
    positive += [] if known is None else [known]
    if positive and max(positive) / min(positive) > 20:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:,.6g}"))
        ax.xaxis.set_minor_formatter(NullFormatter())
    if all(np.all(np.asarray(curve.rmse) > 0) for curve in curves):
        ax.set_yscale("log")


def _finish(ax: Axes, named: bool) -> None:
    ax.set_ylabel("torque RMSE [N m]")
    ax.grid(True, which="major")
    ax.grid(True, which="minor", alpha=0.12)
    ax.tick_params(which="minor", color=FAINT)
    if named:
        ax.legend(loc="upper right")
