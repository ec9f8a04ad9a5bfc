"""Tests of the picture of targets and the configurations that learned torques hold."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from isotorque.paper.figures.maintained import maintained_map
from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.style import BLUE, to_svg

SQUARE = np.array([[0, 0], [0, 2], [2, 2], [2, 0]])


def test_targets_and_observed_configurations():
    rng = np.random.default_rng(0)
    targets = rng.uniform(-3, 3, (66, 2))
    held = rng.random(66) < 0.4
    figure = maintained_map(targets, targets + 0.01, held, domain=SQUARE)
    lines = figure.axes[0].lines
    crosses = next(line for line in lines if line.get_marker() == "x")
    assert np.allclose(crosses.get_xydata(), targets)
    filled, hollow = (line for line in lines if line.get_marker() == "o")
    assert np.allclose(filled.get_xydata(), targets[held] + 0.01)
    assert np.allclose(hollow.get_xydata(), targets[~held] + 0.01)
    assert to_rgba(filled.get_markerfacecolor()) == to_rgba(BLUE)
    assert to_rgba(hollow.get_markerfacecolor()) != to_rgba(BLUE)
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert f"held ({held.sum()})" in words
    assert to_svg(figure, "x").startswith("<svg")


def test_angles_beyond_a_turn_and_three_joints():
    targets = np.random.default_rng(1).uniform(-9, 9, (5, 3))
    figure = maintained_map(targets, targets, np.ones(5, dtype=bool))
    assert len(figure.axes) == 3
    for axes in figure.axes:
        for line in axes.lines:
            assert np.abs(line.get_xydata()).max(initial=0.0) <= np.pi


def test_arrays_of_other_lengths_are_refused():
    with pytest.raises(InputError, match="rows of targets, observed, held"):
        maintained_map(np.zeros((3, 2)), np.zeros((3, 2)), np.zeros(2, dtype=bool))
