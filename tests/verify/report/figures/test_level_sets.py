"""Fig. 2: every configuration is drawn where it is, numbered legibly."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.level_sets import level_set_map, planar_chain, stick_figure


@pytest.fixture
def configurations(two_link):
    q = two_link.group.orbit([-0.9, 0.4])
    return np.concatenate([q, two_link.group.orbit([-1.3, 0.5])]), np.repeat([0, 1], 8)


def test_planar_chains_reach_where_the_angles_say():
    q = np.random.default_rng(0).uniform(-3, 3, (20, 3))
    lengths = np.array([0.3, 0.2, 0.1])
    chains = planar_chain(q, lengths)
    assert chains.shape == (20, 4, 2)
    assert np.allclose(np.linalg.norm(np.diff(chains, axis=1), axis=-1), lengths)
    assert np.allclose(chains[:, -1, 0], np.cos(np.cumsum(q, axis=1)) @ lengths)


def test_one_panel_per_primary_set_with_all_tips(configurations):
    q, sets = configurations
    chains = planar_chain(q, [0.25, 0.25])
    stable = np.arange(16) % 2 == 0
    figure = stick_figure(chains, sets, stable=stable)
    assert len(figure.axes) == 2
    for index, axes in enumerate(figure.axes):
        tips = {
            tuple(np.round(line.get_xydata()[0], 9))
            for line in axes.lines
            if line.get_marker() == "o" and len(line.get_xydata()) == 1
        }
        assert {tuple(np.round(tip, 9)) for tip in chains[sets == index, -1]} <= tips
        hollow = [
            line
            for line in axes.lines
            if line.get_marker() == "o" and line.get_markerfacecolor() == "#fdfefc"
        ]
        assert len(hollow) == 4
        assert "8 configurations" in axes.get_title(loc="left")


def test_numbers_do_not_cover_each_other():
    tips = np.array([[0.1, 0.4], [0.101, 0.4], [0.1, 0.401], [-0.3, 0.1]])
    chains = np.stack([np.zeros((4, 2)), 0.5 * tips, tips], axis=1)
    figure = stick_figure(chains, np.zeros(4), labels=["1", "2", "3", "4"])
    figure.canvas.draw()
    boxes = [
        text.get_window_extent()
        for text in figure.axes[0].texts
        if text.get_text() in {"1", "2", "3", "4"}
    ]
    assert len(boxes) == 4
    centres = np.array([[(b.x0 + b.x1) / 2, (b.y0 + b.y1) / 2] for b in boxes])
    gap = np.linalg.norm(centres[:, None] - centres[None], axis=-1) + 1e9 * np.eye(4)
    assert gap.min() > 5.0 * figure.dpi / 72


def test_the_map_draws_configurations_modulo_turns_and_breaks_curves(configurations):
    q, sets = configurations
    line = np.stack([np.linspace(-4, 4, 200), np.linspace(0, 9, 200)], axis=1)
    figure = level_set_map([(0, 1, line), (1, -1, line)], q + 2 * np.pi, sets)
    axes = figure.axes[0]
    curve = axes.lines[0].get_xydata()
    steps = np.abs(np.diff(curve, axis=0))
    assert np.nanmax(steps) < 1.0  # no stroke across the whole square
    assert np.isnan(curve).any()
    dots = np.array([p.get_xydata()[0] for p in axes.lines if p.get_marker() == "o"])
    assert np.allclose(np.exp(1j * dots), np.exp(1j * q))
    assert np.all(np.abs(dots) <= np.pi)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "+$\\tau_{1}$",
        "−$\\tau_{2}$",
    ]


def test_a_straight_curve_of_two_points_is_drawn_whole():
    line = np.array([[-np.pi, 2.0], [2.0, -np.pi]])
    figure = level_set_map([(1, 1, line)], np.zeros((0, 2)), np.zeros(0, dtype=int))
    drawn = figure.axes[0].lines[0].get_xydata()
    drawn = drawn[~np.isnan(drawn).any(axis=1)]
    assert np.allclose(np.cos(drawn.sum(axis=1)), np.cos(2 - np.pi))
    covered = np.unique(np.floor(drawn[:, 0] / 0.05))
    assert len(covered) >= 0.98 * (2.0 + np.pi) / 0.05


def test_the_map_is_for_two_joints():
    with pytest.raises(InputError, match="shape of q"):
        level_set_map([], np.zeros((4, 3)), np.zeros(4))
