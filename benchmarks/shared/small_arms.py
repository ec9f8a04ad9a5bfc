"""Arms with the features of well-known ones: axes, joint limits, torque limits, masses.

Not those robots: lengths and masses are rounded, from public data sheets where these have them and
plausible where not, and there are no meshes. What matters is what made real arms hard: limits that
exclude hanging down, an upright first axis, continuous joints, grippers, five to seven joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

INF = float("inf")
GYRATION = 0.06
"""Radius of gyration of every link [m]."""


@dataclass(frozen=True)
class SmallJoint:
    """A joint and the link it moves; all frames are parallel where every angle is 0.

    Attributes
    ----------
    axis : str
        ``x``, ``y``, ``z``, with a minus for the opposite direction.
    xyz : (float, float, float)
        Where it sits on the link before [m].
    limits : (float, float)
        Joint limits [rad]; infinite: a continuous joint.
    effort : float
        Largest torque [N m].
    mass : float
        Of the link [kg].
    center : (float, float, float)
        Its centre of mass [m].
    """

    axis: str
    xyz: tuple[float, float, float]
    limits: tuple[float, float]
    effort: float
    mass: float
    center: tuple[float, float, float]


@dataclass(frozen=True)
class SmallArm:
    """A small arm.

    Attributes
    ----------
    features : str
        What makes it hard, in a few words.
    joints : tuple of SmallJoint
        From the base on.
    gripper : bool
        Whether two fingers that slide, the second mimicking the first, sit at its end.
    """

    features: str
    joints: tuple[SmallJoint, ...]
    gripper: bool = False


def _j(axis, xyz, low, high, effort, mass, center):
    return SmallJoint(axis, xyz, (low, high), effort, mass, center)


SMALL_ARMS: dict[str, SmallArm] = {
    "so101-like": SmallArm(
        "hobby arm of 0.6 kg, 5 joints and a jaw that turns",
        (
            _j("z", (0, 0, 0.06), -1.92, 1.92, 3, 0.10, (0.02, 0, 0.02)),
            _j("y", (0.03, 0, 0.055), -1.75, 1.75, 3, 0.10, (0.02, 0, 0.07)),
            _j("y", (0.03, 0, 0.113), -1.69, 1.69, 3, 0.10, (0.08, 0, 0.01)),
            _j("y", (0.135, 0, 0.005), -1.66, 1.66, 3, 0.08, (0.035, 0, 0)),
            _j("x", (0.061, 0, 0), -2.74, 2.84, 3, 0.09, (0.04, 0, 0.005)),
            _j("z", (0.03, 0.02, 0), -0.17, 1.75, 3, 0.02, (0.04, 0, 0)),
        ),
    ),
    "m1013-like": SmallArm(
        "1.3 m cobot, joints of one turn each way, elbow of 160 degrees",
        (
            _j("z", (0, 0, 0.1525), -6.28, 6.28, 346, 7.0, (0, 0.03, 0)),
            _j("y", (0, 0.0345, 0), -6.28, 6.28, 346, 9.8, (0, 0.1, 0.3)),
            _j("y", (0, 0, 0.62), -2.79, 2.79, 163, 3.6, (0, 0.02, 0.02)),
            _j("z", (0, 0, 0.2), -6.28, 6.28, 50, 3.4, (0, -0.03, 0.2)),
            _j("y", (0, 0, 0.359), -6.28, 6.28, 50, 2.6, (0, 0.04, 0)),
            _j("z", (0, 0, 0.121), -6.28, 6.28, 50, 0.9, (0, 0, -0.03)),
        ),
    ),
    "p3020-like": SmallArm(
        "palletiser of 2 m, 5 joints, the elbow never straight",
        (
            _j("z", (0, 0, 0.2), -6.28, 6.28, 800, 20.0, (0.02, 0, 0)),
            _j("y", (0.1, 0, 0.1), -1.66, 1.66, 1200, 24.0, (0, 0.1, 0.45)),
            _j("y", (0, 0, 1.0), 0.3, 2.6, 600, 14.0, (0, 0, 0.35)),
            _j("y", (0, 0, 0.9), -2.2, 2.2, 150, 4.0, (0, 0, 0.06)),
            _j("z", (0, 0, 0.12), -6.28, 6.28, 80, 1.2, (0, 0, 0.01)),
        ),
    ),
    "xarm6-like": SmallArm(
        "cranked upper arm, limits to one side of the elbow",
        (
            _j("z", (0, 0, 0.267), -6.28, 6.28, 50, 2.4, (0, -0.01, -0.03)),
            _j("y", (0, 0, 0), -2.06, 2.09, 50, 1.9, (0.03, 0.03, 0.2)),
            _j("y", (0.053, 0, 0.2845), -3.93, 0.19, 32, 1.4, (0.05, 0.02, -0.06)),
            _j("x", (0.0775, 0, -0.3425), -6.28, 6.28, 32, 1.5, (0, 0, -0.05)),
            _j("y", (0, 0, 0), -1.69, 3.14, 32, 1.2, (0.05, 0, 0)),
            _j("z", (0.076, 0, -0.097), -6.28, 6.28, 20, 0.2, (0, 0, -0.02)),
        ),
    ),
    "xarm7-like": SmallArm(
        "7 joints, cranked, elbow and wrist limited to one side, fingers",
        (
            _j("z", (0, 0, 0.267), -6.28, 6.28, 50, 2.4, (0, -0.01, -0.03)),
            _j("y", (0, 0, 0), -2.06, 2.09, 50, 1.9, (0, 0.03, 0.15)),
            _j("z", (0, 0, 0.293), -6.28, 6.28, 30, 1.7, (0.04, 0.02, -0.01)),
            _j("-y", (0.0525, 0, 0), -0.19, 3.93, 30, 1.3, (0.05, 0.02, 0.1)),
            _j("z", (0.0775, 0, 0.3425), -6.28, 6.28, 30, 1.5, (0, 0.01, -0.03)),
            _j("-y", (0, 0, 0), -1.69, 3.14, 20, 1.2, (0.04, 0.04, 0.01)),
            _j("z", (0.076, 0, 0.097), -6.28, 6.28, 20, 0.2, (0, 0, -0.02)),
        ),
        gripper=True,
    ),
    "fr3-like": SmallArm(
        "7 joints, the elbow always bent, no hanging pose, fingers",
        (
            _j("z", (0, 0, 0.333), -2.74, 2.74, 87, 2.9, (0, -0.03, -0.07)),
            _j("y", (0, 0, 0), -1.78, 1.78, 87, 2.6, (0, 0.03, 0.1)),
            _j("z", (0, 0, 0.316), -2.90, 2.90, 87, 3.2, (0.045, 0.03, -0.03)),
            _j("-y", (0.0825, 0, 0), -3.04, -0.15, 87, 2.6, (-0.03, 0.03, 0.1)),
            _j("z", (-0.0825, 0, 0.384), -2.81, 2.81, 12, 2.1, (0, 0.04, -0.1)),
            _j("-y", (0, 0, 0), 0.54, 4.52, 12, 1.5, (0.05, 0, 0.01)),
            _j("-z", (0.088, 0, 0), -3.02, 3.02, 12, 0.7, (0.01, 0, -0.07)),
        ),
        gripper=True,
    ),
    "gen3-like": SmallArm(
        "7 joints, every other one continuous",
        (
            _j("z", (0, 0, 0.156), -INF, INF, 39, 1.38, (0, 0.01, 0.07)),
            _j("y", (0, 0, 0.128), -2.24, 2.24, 39, 1.16, (0, 0.04, 0.1)),
            _j("z", (0, 0, 0.21), -INF, INF, 39, 1.16, (0, 0.01, 0.12)),
            _j("y", (0, 0, 0.21), -2.57, 2.57, 39, 0.93, (0, 0.02, 0.08)),
            _j("z", (0, 0, 0.208), -INF, INF, 9, 0.68, (0, 0.01, 0.06)),
            _j("y", (0, 0, 0.106), -2.09, 2.09, 9, 0.68, (0, 0.01, 0.04)),
            _j("z", (0, 0, 0.106), -INF, INF, 9, 0.5, (0, 0.01, 0.03)),
        ),
    ),
    "jaco-like": SmallArm(
        "6 joints, angles counted about half a turn, four continuous",
        (
            _j("z", (0, 0, 0.157), -INF, INF, 40, 0.73, (0, 0, 0.05)),
            _j("y", (0, 0, 0.119), 0.82, 5.46, 80, 0.99, (0, 0, -0.21)),
            _j("y", (0, 0, -0.41), 0.33, 5.95, 40, 0.68, (0, 0, -0.07)),
            _j("z", (0, 0, -0.207), -INF, INF, 20, 0.43, (0, 0.02, -0.04)),
            _j("y", (0, 0, -0.074), -INF, INF, 20, 0.43, (0, 0.02, -0.04)),
            _j("z", (0, 0, -0.074), -INF, INF, 20, 0.73, (0, 0, -0.06)),
        ),
    ),
    "talos-arm-like": SmallArm(
        "arm of a humanoid, hanging at its side, shoulder limited inwards",
        (
            _j("z", (0, 0.16, 0.23), -1.57, 0.52, 100, 2.7, (0, 0.05, 0)),
            _j("x", (0, 0.15, 0), 0.0, 2.87, 100, 2.4, (0.02, 0.01, -0.05)),
            _j("z", (0, 0, 0), -2.43, 2.43, 70, 2.2, (0.01, 0, -0.19)),
            _j("y", (0.02, 0, -0.27), -2.23, 0.0, 70, 0.9, (-0.01, 0.01, -0.03)),
            _j("z", (-0.02, 0, -0.26), -2.51, 2.51, 20, 1.8, (0, 0, 0.06)),
            _j("x", (0, 0, 0), -1.37, 1.37, 8, 0.4, (0, 0, 0)),
            _j("y", (0, 0, 0), -0.68, 0.68, 8, 0.9, (0, 0, -0.08)),
        ),
    ),
    "iiwa14-like": SmallArm(
        "7 joints, alternating axes, one third of a turn each way",
        (
            _j("z", (0, 0, 0.1575), -2.97, 2.97, 320, 4.0, (0, -0.03, 0.12)),
            _j("y", (0, 0, 0.2025), -2.09, 2.09, 320, 4.0, (0, 0.04, 0.06)),
            _j("z", (0, 0, 0.2045), -2.97, 2.97, 176, 3.0, (0, 0.03, 0.13)),
            _j("-y", (0, 0, 0.2155), -2.09, 2.09, 176, 2.7, (0, 0.03, 0.07)),
            _j("z", (0, 0, 0.1845), -2.97, 2.97, 110, 1.7, (0, 0.02, 0.08)),
            _j("y", (0, 0, 0.2155), -2.09, 2.09, 40, 1.8, (0, 0, 0)),
            _j("z", (0, 0, 0.081), -3.05, 3.05, 40, 0.3, (0, 0, 0.02)),
        ),
    ),
    "irb120-like": SmallArm(
        "small industrial arm, spherical wrist, elbow limited to one side",
        (
            _j("z", (0, 0, 0.15), -2.88, 2.88, 60, 3.0, (0, 0, 0.09)),
            _j("y", (0, 0, 0.14), -1.92, 1.92, 60, 3.9, (0, 0, 0.1)),
            _j("y", (0, 0, 0.27), -1.92, 1.22, 40, 2.9, (0.02, 0, 0.06)),
            _j("x", (0, 0, 0.07), -2.79, 2.79, 15, 1.3, (0.22, 0, 0)),
            _j("y", (0.302, 0, 0), -2.09, 2.09, 10, 0.55, (0, 0, 0)),
            _j("x", (0.072, 0, 0), -6.98, 6.98, 5, 0.02, (0, 0, 0)),
        ),
    ),
    "kr16-like": SmallArm(
        "industrial arm of 235 kg, upper arm counted from the horizontal",
        (
            _j("-z", (0, 0, 0.4), -3.23, 3.23, 2000, 70.0, (0.1, 0, 0.1)),
            _j("y", (0.26, 0, 0.275), -2.70, 0.61, 3000, 48.0, (0.3, 0.1, 0)),
            _j("y", (0.68, 0, 0), -2.27, 2.69, 1500, 42.0, (0.15, 0, 0.03)),
            _j("-x", (0.67, 0, -0.035), -6.11, 6.11, 200, 10.0, (-0.1, 0, 0)),
            _j("y", (0, 0, 0), -2.27, 2.27, 200, 4.0, (0.03, 0, 0)),
            _j("-x", (0.158, 0, 0), -6.11, 6.11, 100, 0.6, (-0.02, 0, 0)),
        ),
    ),
    "z1-like": SmallArm(
        "folded at zero, limits to one side of shoulder and elbow",
        (
            _j("z", (0, 0, 0.0585), -2.62, 2.62, 30, 0.67, (0, 0, 0.02)),
            _j("y", (0, 0, 0.045), 0.0, 2.97, 60, 1.19, (-0.11, 0, 0)),
            _j("y", (-0.35, 0, 0), -2.88, 0.0, 30, 0.84, (0.11, 0, 0.02)),
            _j("y", (0.218, 0, 0.057), -1.52, 1.52, 30, 0.56, (0.04, 0, 0)),
            _j("z", (0.07, 0, 0), -1.34, 1.34, 30, 0.39, (0.03, 0, 0)),
            _j("x", (0.049, 0, 0), -2.79, 2.79, 30, 0.29, (0.02, 0, 0)),
        ),
    ),
    "hanging-7": SmallArm(
        "7 joints, hanging, free to turn almost all around",
        (
            _j("x", (0, 0, -0.1), -6.28, 6.28, 200, 3.0, (0.02, 0.01, -0.12)),
            _j("y", (0.03, 0, -0.1), -6.28, 6.28, 200, 2.5, (0.01, -0.02, -0.15)),
            _j("z", (0, 0.02, -0.2), -6.28, 6.28, 100, 2.0, (0.04, 0.02, -0.08)),
            _j("y", (0.02, 0, -0.15), -6.28, 6.28, 100, 1.6, (0.02, 0.01, -0.12)),
            _j("z", (0, 0, -0.15), -6.28, 6.28, 50, 1.1, (-0.03, 0.02, -0.06)),
            _j("x", (0, 0.03, -0.1), -6.28, 6.28, 50, 0.8, (0.01, 0.02, -0.08)),
            _j("y", (0, 0, -0.08), -6.28, 6.28, 20, 0.5, (0.03, 0, -0.06)),
        ),
    ),
    "short-stop": SmallArm(
        "one joint, limits above the horizontal alone: no pose it can hold by itself",
        (_j("-y", (0, 0, 0.1), 0.3, 1.2, 10, 1.0, (0.1, 0, 0)),),
    ),
}


def write_arm(name: str, folder: Path) -> Path:
    """Write the URDF of a small arm; return its path."""
    path = folder / f"{name}.urdf"
    path.write_text(arm_text(name, SMALL_ARMS[name]), encoding="utf-8")
    return path


def arm_text(name: str, arm: SmallArm) -> str:
    """Return the URDF of a small arm."""
    lines = [f"<robot name={quoteattr(name)}>", '<link name="base"/>']
    parent = "base"
    for number, joint in enumerate(arm.joints, 1):
        link, end = f"link{number}", joint.limits
        continuous = end == (-INF, INF)
        kind = "continuous" if continuous else "revolute"
        ends = "" if continuous else f' lower="{end[0]}" upper="{end[1]}"'
        lines += [
            _link(link, joint.mass, joint.center),
            f'<joint name="joint{number}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{link}"/><origin xyz="{_triple(joint.xyz)}"/>'
            f'<axis xyz="{_axis(joint.axis)}"/>'
            f'<limit{ends} effort="{joint.effort}" velocity="3"/></joint>',
        ]
        parent = link
    if arm.gripper:
        for side, mimic in (("left", ""), ("right", '<mimic joint="finger_left"/>')):
            lines += [
                _link(f"pad_{side}", 0.05, (0, 0, 0.02)),
                f'<joint name="finger_{side}" type="prismatic"><parent link="{parent}"/>'
                f'<child link="pad_{side}"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>'
                f'<limit lower="0" upper="0.04" effort="20" velocity="0.2"/>{mimic}</joint>',
            ]
    return "\n".join([*lines, "</robot>", ""])


def _link(name: str, mass: float, center: tuple[float, float, float]) -> str:
    inertia = f"{mass * GYRATION**2:.6g}"
    return (
        f'<link name="{name}"><inertial><origin xyz="{_triple(center)}"/><mass value="{mass}"/>'
        f'<inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/>'
        "</inertial></link>"
    )


def _axis(name: str) -> str:
    sign = "-1" if name.startswith("-") else "1"
    return " ".join(sign if letter == name[-1] else "0" for letter in "xyz")


def _triple(xyz: tuple[float, float, float]) -> str:
    return " ".join(f"{x:g}" for x in xyz)
