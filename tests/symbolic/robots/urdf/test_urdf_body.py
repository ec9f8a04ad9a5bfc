"""Merging links that are fixed to each other: nothing is lost, right angles are exact."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.urdf.urdf_body import body_from_urdf
from isotorque.symbolic.robots.urdf.urdf_elements import UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf, urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import lengths, right_angles, urdfs

FIELDS = (
    "rotations",
    "translations",
    "axes",
    "masses",
    "inertias",
    "limits",
    "efforts",
    "velocities",
    "damping",
    "friction",
    "armature",
    "gravity",
)


@given(urdfs())
def test_the_merged_body_is_pinocchios(urdf):
    theirs = ArmBody.from_model(pin.buildModelFromXML(urdf_text(urdf)), "arm")
    mine = body_from_urdf(urdf, theirs.joint_names)
    assert mine.parents == theirs.parents
    for field in FIELDS:
        np.testing.assert_allclose(
            getattr(mine, field), getattr(theirs, field), rtol=1e-12, atol=1e-12, err_msg=field
        )
    heavy = mine.masses > 0
    np.testing.assert_allclose(mine.levers[heavy], theirs.levers[heavy], atol=1e-12)


@given(urdfs())
def test_no_mass_behind_a_joint_is_lost(urdf):
    """Against a sum over links of our own: who is behind which joint, by climbing."""
    model = pin.buildModelFromXML(urdf_text(urdf))
    body = body_from_urdf(urdf, tuple(model.names)[1:])
    above = {joint.child: joint for joint in urdf.joints}
    carried = dict.fromkeys(body.joint_names, 0.0)
    for link in urdf.links:
        climber = link.name
        while climber in above and above[climber].kind == "fixed":
            climber = above[climber].parent
        if climber in above:
            carried[above[climber].name] += link.mass
    np.testing.assert_allclose(body.masses, list(carried.values()), rtol=1e-14)


@given(urdfs(angle=right_angles))
def test_right_angles_stay_exact_through_any_number_of_fixed_joints(urdf):
    model = pin.buildModelFromXML(urdf_text(urdf))
    body = body_from_urdf(urdf, tuple(model.names)[1:])
    assert set(body.rotations.ravel()) <= {-1.0, 0.0, 1.0}


def test_a_tool_beyond_the_last_joint_is_carried_by_it():
    links = (UrdfLink("base", 9.0), UrdfLink("arm"), UrdfLink("tool", 2.0, (0.1, 0.0, 0.0)))
    joints = (
        UrdfJoint("joint", "continuous", "base", "arm"),
        UrdfJoint("mount", "fixed", "arm", "tool", (0.5, 0.0, 0.0), (0.0, 0.0, np.pi / 2)),
    )
    body = body_from_urdf(Urdf("arm", "base", links, joints), ("joint",))
    assert body.masses.tolist() == [2.0]
    assert body.levers.tolist() == [[0.5, 0.1, 0.0]]


@given(st.floats(0.1, 10.0), st.tuples(lengths, lengths, lengths))
def test_the_only_mass_of_a_body_keeps_its_centre_to_the_last_bit(mass, centre):
    links = (UrdfLink("base"), UrdfLink("arm", mass, centre), UrdfLink("frame"))
    joints = (
        UrdfJoint("joint", "continuous", "base", "arm"),
        UrdfJoint("mount", "fixed", "arm", "frame"),
    )
    body = body_from_urdf(Urdf("arm", "base", links, joints), ("joint",))
    assert body.levers[0].tolist() == list(centre)
