"""Fig. 6, 10 and 11: what is drawn in the configuration plane is what was given, on the torus."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import same_color
from matplotlib.patches import Polygon

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.configurations import domain_map, explored_map
from isotorque.verify.report.figures.style import FAINT, GREEN

PARALLELOGRAM = np.array(
    [[0.0, 0.0], [np.pi / 2, np.pi / 2], [np.pi / 2, -np.pi / 2], [0.0, np.pi]]
)


def polygons(axes, colour):
    return [
        patch.get_xy()[:-1]
        for patch in axes.patches
        if isinstance(patch, Polygon) and same_color(patch.get_edgecolor(), colour)
    ]


def test_images_of_the_domain_tile_the_plane(two_link):
    images = two_link.group.orbit(PARALLELOGRAM)
    figure = domain_map(PARALLELOGRAM, images=images, center=[np.pi / 4, np.pi / 4])
    outlines = polygons(figure.axes[0], FAINT)
    rng = np.random.default_rng(0)
    for point in rng.uniform(-np.pi, np.pi, (200, 2)):
        assert sum(_inside(point, outline) for outline in outlines) == 1
    assert len(polygons(figure.axes[0], GREEN)) >= 1


def _inside(point, corners):
    edge = np.roll(corners, -1, axis=0) - corners
    side = edge[:, 0] * (point[1] - corners[:, 1]) - edge[:, 1] * (point[0] - corners[:, 0])
    return bool(np.all(side > 0) or np.all(side < 0))


def test_a_domain_across_the_edge_is_drawn_on_both_sides():
    figure = domain_map(PARALLELOGRAM + np.array([np.pi - 0.5, 0.0]))
    left = [p for p in polygons(figure.axes[0], GREEN) if p[:, 0].min() < -np.pi]
    right = [p for p in polygons(figure.axes[0], GREEN) if p[:, 0].max() > np.pi]
    assert left
    assert right


@pytest.mark.parametrize(("n", "panels"), [(2, 1), (3, 3), (5, 3)])
def test_explored_configurations_are_drawn_pair_by_pair(n, panels):
    rng = np.random.default_rng(0)
    red, blue = rng.uniform(-9, 9, (30, n)), rng.uniform(-9, 9, (50, n))
    figure = explored_map(red, blue)
    assert len(figure.axes) == panels
    learned, explored = (c.get_offsets() for c in figure.axes[0].collections)
    assert np.allclose(np.exp(1j * learned), np.exp(1j * blue[:, :2]))
    assert np.allclose(np.exp(1j * explored), np.exp(1j * red[:, :2]))
    assert np.abs(explored).max() <= np.pi
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert words == ["explored (30)", "learned (50)"]


def test_wrong_shapes_are_refused():
    with pytest.raises(InputError, match="shape of explored"):
        explored_map(np.zeros(3), np.zeros((1, 3)))
    with pytest.raises(InputError, match="shape of polygon"):
        domain_map(np.zeros((4, 3)))
