"""Random arms with inertia, for tests of the dynamics."""

import numpy as np
import pinocchio as pin
from hypothesis import strategies as st

_UNALIGNED = {
    "revolute": pin.JointModelRevoluteUnaligned,
    "prismatic": pin.JointModelPrismaticUnaligned,
}
_ALIGNED = {
    "revolute": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
    "prismatic": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
}


@st.composite
def arm_models(
    draw,
    min_joints=1,
    max_joints=6,
    *,
    branched=None,
    prismatic=False,
    depth_first=True,
    armature=True,
):
    """Pinocchio models with full inertias; gravity of any direction, none in one of ten.

    Parents are drawn by Hypothesis, numbers from a generator that it seeds.
    """
    n = draw(st.integers(min_joints, max_joints))
    forks = draw(st.booleans()) if branched is None else branched
    parents = [0]
    for joint in range(1, n):
        allowed = list(range(joint + 1)) if forks else [joint]
        if forks and depth_first:
            allowed = [joint]
            while allowed[-1] > 0:
                allowed.append(parents[allowed[-1] - 1])
        parents.append(draw(st.sampled_from(allowed)))
    kinds = [
        draw(st.sampled_from(["revolute", "prismatic"])) if prismatic else "revolute"
        for _ in range(n)
    ]
    seed = draw(st.integers(0, 2**32 - 1))
    return build_arm(parents, kinds, np.random.default_rng(seed), armature)


def build_arm(parents, kinds, rng, armature=True):
    """Build a model with the given parents (0 is the base) and random numbers."""
    model = pin.Model()
    model.name = "random arm"
    model.gravity.linear = 9.81 * unit(rng) if rng.random() > 0.1 else np.zeros(3)
    for i, (parent, kind) in enumerate(zip(parents, kinds, strict=True)):
        aligned = rng.random() < 0.5
        joint = _ALIGNED[kind][rng.integers(3)]() if aligned else _UNALIGNED[kind](unit(rng))
        placement = pin.SE3(pin.Quaternion(unit(rng, 4)).matrix(), rng.normal(size=3) * 0.3)
        index = model.addJoint(parent, joint, placement, f"joint{i + 1}")
        points = rng.normal(size=(4, 3)) * rng.uniform(0.02, 0.2)
        weights = rng.uniform(0.1, 2.0, 4)
        inertia = sum(
            (pin.Inertia(w, p, np.zeros((3, 3))) for w, p in zip(weights, points, strict=True)),
            start=pin.Inertia(0.1, np.zeros(3), 1e-3 * np.eye(3)),
        )
        model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
    if armature:
        model.armature = rng.uniform(0.0, 0.1, model.nv)
    return model


def unit(rng, n=3):
    """Return a random unit vector."""
    x = rng.normal(size=n)
    return x / np.linalg.norm(x)
