"""Fig. 13: errors against samples or iterations, on the axes asked for."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.learning_curves import LearningCurve, learning_curves


def curve(**options):
    samples = np.arange(100, 10_000, 100)
    return LearningCurve("map", samples, 10.0 / samples, **options)


def test_curves_are_drawn_as_given():
    axes = learning_curves([curve(), curve()], goal=0.0053).axes[0]
    assert np.allclose(axes.lines[0].get_xydata()[:, 1], curve().rmse)
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert any(np.allclose(line.get_ydata(), 0.0053) for line in axes.lines)
    assert "0.0053" in axes.texts[0].get_text()


def test_the_papers_axes_are_linear_in_iterations():
    axes = learning_curves([curve()], logarithmic=False, iteration=100).axes[0]
    assert axes.get_xscale() == axes.get_yscale() == "linear"
    assert axes.get_ylim()[0] == 0.0
    assert np.allclose(axes.lines[0].get_xdata(), np.arange(1, 100))
    assert axes.get_xlabel() == "iterations of 100 samples"


def test_an_error_of_zero_keeps_the_axis_linear():
    axes = learning_curves([LearningCurve("x", np.array([1, 2]), np.array([1.0, 0.0]))]).axes[0]
    assert axes.get_yscale() == "linear"


def test_an_interval_is_shaded():
    figure = learning_curves([curve(low=curve().rmse / 2, high=curve().rmse * 2)])
    assert len(figure.axes[0].collections) == 1


def test_long_tick_labels_do_not_overlap():
    figure = learning_curves([LearningCurve("x", np.arange(15, 600, 15), np.linspace(4, 0.1, 39))])
    figure.canvas.draw()
    axes = figure.axes[0]
    low, high = axes.get_xlim()
    ticks = [
        label.get_window_extent()
        for label in axes.get_xticklabels(which="both")
        if label.get_text() and low <= label.get_position()[0] <= high
    ]
    ticks.sort(key=lambda box: box.x0)
    assert len(ticks) >= 3
    assert all(a.x1 < b.x0 for a, b in itertools.pairwise(ticks))


def test_no_curve_is_no_error():
    assert learning_curves([]).axes


def test_unequal_lengths_are_refused():
    with pytest.raises(InputError, match="shape of rmse"):
        LearningCurve("x", np.zeros(3), np.zeros(4))
