"""Fig. 3, 4 and 7: profiles one after the other, endings marked, torques where they are."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.verify.report.figures.torques import (
    ProfileTrace,
    joint_trajectories,
    static_torque_map,
    torque_profiles,
)


def traces():
    times = np.linspace(0.0, 2.0, 50)
    torques = np.stack([np.sin(times), np.cos(times)], axis=1)
    ends = ("settled", "limit", "timeout")
    return [ProfileTrace(times, torques * k, torques + k, end) for k, end in enumerate(ends, 1)]


def test_profiles_follow_each_other_in_time():
    axes = torque_profiles(traces()).axes[0]
    curves = [line.get_xydata() for line in axes.lines if len(line.get_xdata()) == 50]
    assert len(curves) == 6
    assert [curve[0, 0] for curve in curves] == [0, 0, 2, 2, 4, 4]
    assert np.allclose(curves[4][:, 1], 3 * np.sin(np.linspace(0, 2, 50)))
    assert axes.get_xlim() == (0.0, 6.0)


def test_endings_are_marked_where_the_arm_ended():
    rested = traces()
    first = rested[0]
    final = np.array([9.0, 8.0])
    rested[0] = ProfileTrace(first.times, first.torques, first.q, "settled", final)
    axes = joint_trajectories(rested).axes[0]
    dots = [line.get_xydata() for line in axes.lines if line.get_marker() == "o"]
    crosses = [line.get_xydata() for line in axes.lines if line.get_marker() == "x"]
    assert len(dots) == 1
    assert len(crosses) == 2
    assert np.allclose(dots[0], [[2.0, 9.0], [2.0, 8.0]])
    assert np.allclose(crosses[1][:, 1], rested[2].q[-1])


def test_no_profiles_make_an_empty_picture():
    assert torque_profiles([]).axes
    assert joint_trajectories([]).axes


def test_traces_of_unequal_length_are_refused():
    with pytest.raises(InputError, match="shape of torques"):
        ProfileTrace(np.zeros(3), np.zeros((4, 2)), np.zeros((3, 2)), "settled")


@pytest.mark.parametrize(("n", "panels"), [(2, 1), (3, 3)])
def test_static_torques(n, panels):
    rng = np.random.default_rng(0)
    good, bad = rng.normal(size=(40, n)), rng.normal(size=(7, n))
    triangles = rng.normal(size=(5, 3, 2)) if n == 2 else None
    figure = static_torque_map(good, bad, triangles=triangles, boundary=good[:, :2])
    assert len(figure.axes) == panels
    axes = figure.axes[0]
    offsets = axes.collections[-1].get_offsets()
    assert np.allclose(offsets, good[:, :2])
    crosses = next(line for line in axes.lines if line.get_marker() == "x")
    assert np.allclose(crosses.get_xydata(), bad[:, :2])
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == ["settled (40)", "inadmissible (7)"]
    assert len(axes.collections) == (2 if n == 2 else 1)


def test_nothing_inadmissible_is_no_error():
    assert static_torque_map(np.zeros((3, 2)), np.zeros((0, 2))).axes
