"""Snapping whole arms: bounds hold, what is snapped is listed, what is not is untouched."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
from hypothesis import assume, given
from hypothesis import strategies as st

from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.snapped_bodies import snap_body, snap_urdf
from isotorque.symbolic.robots.urdf.urdf_body import body_from_urdf
from isotorque.symbolic.robots.urdf.urdf_elements import UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf, urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import (
    angles,
    right_angles,
    rounded_right_angles,
    urdfs,
)

KINEMATICS = ("rotations", "translations", "axes", "masses", "levers", "inertias")


def rounded(value: float) -> float:
    return float(f"{value:.6g}")


def straight(urdf: Urdf) -> Urdf:
    """The file that its author meant: rounded right angles are right."""

    def right(angle: float) -> float:
        nearest = round(angle / (math.pi / 2)) * math.pi / 2
        return nearest if rounded(nearest) == angle else angle

    return replace(
        urdf,
        links=tuple(replace(link, rpy=tuple(map(right, link.rpy))) for link in urdf.links),
        joints=tuple(replace(joint, rpy=tuple(map(right, joint.rpy))) for joint in urdf.joints),
    )


def names(urdf: Urdf) -> tuple[str, ...]:
    return tuple(pin.buildModelFromXML(urdf_text(urdf)).names)[1:]


def gravity(body: ArmBody, q: np.ndarray) -> np.ndarray:
    model = body.to_model("arm")
    data = model.createData()
    return np.array([pin.computeGeneralizedGravity(model, data, row).copy() for row in q])


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)), st.integers(0, 2**32))
def test_the_effects_of_all_snaps_bound_what_snapping_does(urdf, seed):
    order = names(urdf)
    before = body_from_urdf(urdf, order)
    after, snaps = snap_urdf(urdf, order)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (20, after.n))
    change = np.abs(gravity(before, q) - gravity(after, q)).max(axis=0)
    assert np.all(change <= sum((snap.effect for snap in snaps), np.zeros(after.n)) + 1e-11)


@given(urdfs(angle=rounded_right_angles))
def test_rounded_right_angles_become_right_and_are_listed(urdf):
    order = names(urdf)
    body, snaps = snap_urdf(urdf, order)
    assert set(body.rotations.ravel()) <= {-1.0, 0.0, 1.0}
    meant = body_from_urdf(straight(urdf), order)
    for field in KINEMATICS:
        tolerance = 2e-5 if field == "axes" else 1e-12  # axes of the file may be close to straight
        np.testing.assert_allclose(getattr(body, field), getattr(meant, field), atol=tolerance)
    crooked = {
        mine.name
        for mine, right in zip(urdf.joints, straight(urdf).joints, strict=True)
        if mine.rpy != right.rpy
    }
    assert {snap.joint for snap in snaps if snap.what == "origin rpy"} == crooked


@given(urdfs(angle=st.one_of(right_angles, st.floats(0.1, 1.4))))
def test_nothing_to_snap_nothing_changed(urdf):
    order = names(urdf)
    before = body_from_urdf(urdf, order)
    after, snaps = snap_urdf(urdf, order)
    assume(not snaps)  # an axis that happens to be close, right angles that crooked ones add up to
    for field in KINEMATICS:
        np.testing.assert_allclose(getattr(after, field), getattr(before, field), atol=1e-12)


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)))
def test_snapping_a_snapped_arm_changes_no_bit(urdf):
    body, _ = snap_urdf(urdf, names(urdf))
    again, snaps = snap_body(body)
    assert snaps == ()
    for field in KINEMATICS:
        np.testing.assert_array_equal(getattr(again, field), getattr(body, field), err_msg=field)


def arm(*rpys: float, axis=(0.0, 1.0, 0.0)) -> Urdf:
    """A joint, fixed joints turned about z by given angles, and a second joint."""
    links = [UrdfLink("base"), UrdfLink("upper", 2.0, (0.2, 0.0, 0.0))]
    joints = [UrdfJoint("first", "continuous", "base", "upper", axis=(0.0, 1.0, 0.0))]
    for i, angle in enumerate(rpys):
        links.append(UrdfLink(f"bend{i}"))
        joints.append(
            UrdfJoint(f"fix{i}", "fixed", links[-2].name, links[-1].name, rpy=(0.0, 0.0, angle))
        )
    links.append(UrdfLink("hand", 1.0, (0.3, 0.0, 0.0)))
    joints.append(UrdfJoint("second", "continuous", links[-2].name, "hand", axis=axis))
    return Urdf("arm", "base", tuple(links), tuple(joints))


def test_two_rounded_halves_make_a_right_angle():
    body, snaps = snap_urdf(arm(0.785398, 0.785398), ("first", "second"))
    assert set(body.rotations[1].ravel()) <= {-1.0, 0.0, 1.0}
    assert [(snap.joint, snap.what) for snap in snaps] == [("second", "placement rpy")]


def test_a_bend_and_its_opposite_leave_no_noise():
    urdf = arm(0.3, 0.4, -0.7)
    raw = body_from_urdf(urdf, ("first", "second"))
    assert np.any(raw.rotations[1] != np.eye(3))  # the noise is there to be removed
    body, snaps = snap_urdf(urdf, ("first", "second"))
    np.testing.assert_array_equal(body.rotations[1], np.eye(3))
    assert snaps == ()


def test_lengths_beyond_a_bend_and_its_opposite_leave_no_noise():
    urdf = arm(0.3, 0.4, -0.7)
    straight = tuple(
        replace(joint, xyz=(0.1, 0.0, 0.0)) if joint.name == "second" else joint
        for joint in urdf.joints
    )
    tool = UrdfLink("tool", 1.0, (0.2, 0.0, 0.0))
    carried = UrdfJoint("tool_mount", "fixed", "bend2", "tool", xyz=(0.1, 0.0, 0.0))
    urdf = replace(urdf, links=(*urdf.links, tool), joints=(*straight, carried))
    raw = body_from_urdf(urdf, ("first", "second"))
    assert raw.translations[1, 1] != 0  # the noise is there to be removed
    assert raw.levers[0, 1] != 0
    body, snaps = snap_urdf(urdf, ("first", "second"))
    assert snaps == ()
    np.testing.assert_array_equal(body.translations[1, 1:], [0.0, 0.0])
    np.testing.assert_array_equal(body.levers[0, 1:], [0.0, 0.0])


def test_an_axis_is_snapped_and_listed_with_its_effect():
    body, snaps = snap_urdf(arm(axis=(5e-6, 1.0, 0.0)), ("first", "second"))
    np.testing.assert_array_equal(body.axes[1], [0.0, 1.0, 0.0])
    (snap,) = snaps
    assert (snap.joint, snap.what, snap.after) == ("second", "axis", (0.0, 1.0, 0.0))
    assert 0 < snap.effect[1] < 1.0 * 9.81 * 0.3 * 5e-6 * 3


def test_an_axis_further_away_is_not():
    body, snaps = snap_urdf(arm(axis=(2e-5, 1.0, 0.0)), ("first", "second"))
    assert snaps == ()
    assert body.axes[1, 0] > 1.9e-5


def test_an_inertial_frame_is_snapped_without_effect_on_gravity():
    urdf = arm()
    hand = replace(urdf.links[-1], rpy=(0.0, 1.5708, 0.0), products=(1.0, 0, 0, 2.0, 0, 3.0))
    body, snaps = snap_urdf(replace(urdf, links=(*urdf.links[:-1], hand)), ("first", "second"))
    (snap,) = snaps
    assert (snap.joint, snap.what) == ("hand", "inertial rpy")
    assert not np.any(snap.effect)
    np.testing.assert_array_equal(body.inertias[1], np.diag([3.0, 2.0, 1.0]))
