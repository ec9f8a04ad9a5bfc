"""Pictures are valid, deterministic, themed vector graphics in colours all can tell apart."""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures import style

# Machado, Oliveira and Fernandes (2009): full protanopia, deuteranopia and tritanopia
DEFICIENCIES = {
    "protan": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "deutan": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
    "tritan": [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]],
}


def linear(colour):
    value = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    x, y, z = np.cbrt(np.clip(to_xyz @ rgb, 1e-6, None) / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("deficiency", sorted(DEFICIENCIES))
def test_colours_that_stand_side_by_side_differ_for_everyone(deficiency):
    seen = np.array(DEFICIENCIES[deficiency])
    side_by_side = [
        (style.BLUE, style.RED),  # explored and learned, primary sets, settled and inadmissible
        (style.GREEN, style.ORANGE),  # level sets of tau_1 and tau_2
        *itertools.combinations(style.JOINTS[:3], 2),
    ]
    for one, other in side_by_side:
        distance = np.linalg.norm(lab(seen @ linear(one)) - lab(seen @ linear(other)))
        assert distance > 20.0, (one, other)


def picture():
    with style.settings():
        figure, (axes,) = style.panels(1)
        style.angle_plane(axes, ("a", "b"))
        axes.plot([0, 1], [0, 1], color=style.BLUE, label="line")
        style.points(axes, np.zeros(2), np.ones(2), color=style.RED)
        axes.legend()
    return figure


def test_svg_is_well_formed_and_says_what_it_shows():
    root = ET.fromstring(style.to_svg(picture(), 'a "line" & <more>'))
    assert root.tag.endswith("svg")
    assert root.get("role") == "img"
    assert root.get("aria-label") == 'a "line" & <more>'


def test_the_same_picture_is_the_same_text():
    assert style.to_svg(picture(), "x") == style.to_svg(picture(), "x")


def test_every_colour_follows_the_page():
    text = style.to_svg(picture(), "x")
    assert f"var(--blue, {style.BLUE})" in text
    assert f"var(--red, {style.RED})" in text
    assert f"var(--ink, {style.INK})" in text
    assert set(re.findall(r"(?<!, )#[0-9a-f]{6}\b", text)) <= {"#000000", "#ffffff"}


def test_ids_of_two_pictures_do_not_meet():
    first, second = (style.to_svg(picture(), "x", prefix=name) for name in ("one", "two"))
    ids = [set(re.findall(r'\bid="([^"]+)"', text)) for text in (first, second)]
    assert not ids[0] & ids[1]
    for text, known in zip((first, second), ids, strict=True):
        used = set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text))
        assert used <= known


def test_many_points_become_pixels():
    with style.settings():
        figure, (axes,) = style.panels(1)
        style.points(axes, np.zeros(style.MANY_POINTS + 1), np.zeros(style.MANY_POINTS + 1))
    text = style.to_svg(figure, "x")
    assert "data:image/png;base64" in text
    assert len(text) < 100_000


def test_angles_are_written_in_pi():
    figure = picture()
    labels = [tick.get_text() for tick in figure.axes[0].get_xticklabels()]
    assert labels == ["−π", "−π/2", "0", "π/2", "π"]
    assert style._pi_text(3 * np.pi / 2) == "3π/2"
    assert style._pi_text(-2 * np.pi) == "−2π"


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_files_are_written_and_equal_each_time(tmp_path, ending):
    paths = [tmp_path / f"{i}.{ending}" for i in range(2)]
    for path in paths:
        style.save_figure(picture(), path)
    first, second = (path.read_bytes() for path in paths)
    assert first == second
    assert first[:4] in (b"<?xm", b"%PDF", b"\x89PNG")


def test_files_that_cannot_be_written_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"ending is .gif; accepted: .svg, .pdf or .png"):
        style.save_figure(picture(), tmp_path / "a.gif")
    with pytest.raises(InputError, match="No such file or directory"):
        style.save_figure(picture(), tmp_path / "no" / "a.svg")


def test_arrays_of_wrong_shape_are_refused():
    with pytest.raises(InputError, match=r"shape of x is \(3,\)"):
        style.rows(np.zeros(3), what="x")
    with pytest.raises(InputError, match=r"accepted: \(m, 2\)"):
        style.rows(np.zeros((3, 3)), 2, what="x")
