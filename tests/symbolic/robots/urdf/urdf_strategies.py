"""Hypothesis strategies for URDF files: serial and branched arms with fixed joints in between."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from isotorque.symbolic.robots.urdf.urdf_elements import UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf

angles = st.floats(-math.pi, math.pi)
right_angles = st.integers(-4, 4).map(lambda k: k * math.pi / 2)
rounded_right_angles = right_angles.map(lambda angle: float(f"{angle:.6g}"))
lengths = st.floats(-0.5, 0.5)
axes = st.sampled_from([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)])
skew_axes = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: max(map(abs, a)) > 0.1)


@st.composite
def links(draw: st.DrawFn, name: str, angle: st.SearchStrategy[float]) -> UrdfLink:
    """A link, massless now and then."""
    if draw(st.booleans()) and draw(st.booleans()):
        return UrdfLink(name)
    xx, yy = draw(st.floats(0.01, 0.1)), draw(st.floats(0.01, 0.1))
    return UrdfLink(
        name,
        mass=draw(st.floats(0.1, 10.0)),
        xyz=draw(st.tuples(lengths, lengths, lengths)),
        rpy=draw(st.tuples(angle, angle, angle)),
        products=(xx, 0.001, -0.002, yy, 0.003, (xx + yy) * 0.9),
    )


@st.composite
def urdfs(draw: st.DrawFn, angle: st.SearchStrategy[float] = angles, max_joints: int = 6) -> Urdf:
    """An arm of 1 to ``max_joints`` joints, some of them fixed, at least one moving."""
    count = draw(st.integers(1, max_joints))
    kind = st.sampled_from(["revolute", "continuous", "fixed"])
    kinds = draw(st.lists(kind, min_size=count, max_size=count))
    kinds[draw(st.integers(0, count - 1))] = draw(st.sampled_from(["revolute", "continuous"]))
    serial = draw(st.booleans())
    joints = []
    for i, kind in enumerate(kinds):
        parent = i if serial else draw(st.integers(0, i))
        numbers = {}
        if kind != "fixed":
            numbers = {
                "axis": draw(st.one_of(axes, skew_axes)),
                "lower": -1.0 if kind == "revolute" else None,
                "upper": 2.0 if kind == "revolute" else None,
                "effort": 10.0,
                "velocity": 3.0,
                "damping": draw(st.floats(0.0, 3.0)),
                "friction": draw(st.floats(0.0, 3.0)),
            }
        joints.append(
            UrdfJoint(
                # names in no particular order: Pinocchio sorts siblings by name
                name=f"{draw(st.sampled_from('abcxyz'))}{i}",
                kind=kind,
                parent=f"link{parent}",
                child=f"link{i + 1}",
                xyz=draw(st.tuples(lengths, lengths, lengths)),
                rpy=draw(st.tuples(angle, angle, angle)),
                **numbers,
            )
        )
    all_links = tuple(draw(links(f"link{i}", angle)) for i in range(count + 1))
    return Urdf("arm", "link0", all_links, tuple(joints))
