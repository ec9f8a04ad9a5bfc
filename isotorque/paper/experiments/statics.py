"""Sections 3 and 4: symmetric configurations, the printed maps, the BCTS, torque ranges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.published import BCTS_CENTER, BCTS_CORNERS, PRINTED_MAPS
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.level_sets.level_curves import level_curves
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.models.stability import has_stable_image
from isotorque.verify.models.target_sets import dense_targets
from isotorque.verify.relations.verify_relation import verify_relation
from isotorque.verify.report.figures.planar_links import planar_links
from isotorque.verify.report.summaries import summarise_domain
from isotorque.verify.testing.counterexamples import largest_value

Array = NDArray[np.float64]

FIGURE_SHARE = 0.4
"""The torque of Fig. 1 and 2, as a share of the torque range: far from folds, easy to read."""
TORQUES_TRIED = 200
POSTURE = (0.0, 0.35, 0.75)
"""The arm is drawn like this in Fig. 9: bent, so that its axes can be told apart [rad]."""
CURVE_TOLERANCE = 0.01


def measure_symmetries(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Count configurations and primary sets; judge each printed map (Eq. 8-11).

    Parameters
    ----------
    robot
        The 2R arm, or one with other masses.
    seed
        Of the torques drawn.
    effort
        Share of `TORQUES_TRIED`.
    """
    gravity = GravityModel(robot)
    potential = gravity.potential.to_float()
    group = primary_symmetries(gravity.potential)
    _, high = torque_range(robot, gravity)
    torque = FIGURE_SHARE * high
    found = level_set(potential, torque, group=group)
    signs = [np.array([a, b]) for a in (1, -1) for b in (1, -1)]
    per_torque = [len(found.with_torque(sign * torque)) for sign in signs]
    drawn = np.random.default_rng(seed).uniform(
        -np.pi, np.pi, (effort.of(TORQUES_TRIED, 10), robot.n)
    )
    counts = np.array([len(level_set(potential, t, group=group)) for t in gravity.torque(drawn)])
    maps = [_judge_map(rows, gravity) for rows in PRINTED_MAPS]
    numbers = {
        "order": group.order,
        "configurations": len(found),
        "primary_sets": found.primary_set_count,
        "per_set": np.bincount(found.primary_sets),
        "per_torque": per_torque,
        "most_configurations": counts.max(),
        "share_of_most": float(np.mean(counts == counts.max())),
        "most_in_domain": counts.max() / group.order,
        "map_errors": [error for error, _ in maps],
        "map_signs": [sign for _, sign in maps],
        "stable": int(found.stable.sum()),
    }
    curves = []
    for joint in range(robot.n):
        lines = level_curves(potential, joint, float(torque[joint]), tolerance=CURVE_TOLERANCE)
        curves += [
            {"joint": joint, "sign": float(np.sign(t)), "points": c}
            for c, t in zip(lines.curves, lines.torques, strict=True)
        ]
    pictures = {
        "torque": torque,
        "q": found.configurations,
        "torques": found.torques,
        "sets": found.primary_sets,
        "stable": found.stable,
        "curves": curves,
        "links": planar_links(robot.model, found.configurations),
        "posture": planar_links(robot.model, [[0.6, 0.5]]),
    }
    return Measured(numbers, pictures)


def _judge_map(rows: tuple[tuple[int, ...], ...], gravity: GravityModel) -> tuple[float, list[int]]:
    """Return the torque error of a printed map [N m], and the signs under which it is least.

    The paper prints configurations, not the signs of their torques.
    """
    table = np.array(rows)
    tries = []
    for signs in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
        relation = SymmetryRelation(table[:, :2], np.pi * table[:, 2], signs)
        verdict = verify_relation(relation, gravity)
        tries.append((float(verdict.worst_error), list(signs)))
        if verdict.passed:
            break
    return min(tries)


def measure_domain(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Compare the fundamental domain with the paper's parallelogram (Fig. 6)."""
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    domain = FundamentalDomain(group, BCTS_CENTER)
    summary = summarise_domain(domain)
    assert summary.polygon is not None
    assert summary.images is not None
    gap = np.abs(summary.polygon[:, None] - np.array(BCTS_CORNERS)[None]).max(axis=-1)
    order = np.argmin(gap, axis=0)
    numbers = {
        "corners": summary.polygon[order],
        "corner_count": len(summary.polygon),
        "corner_error": float(max(gap.min(axis=0).max(), gap.min(axis=1).max())),
        "reduction": float((2 * np.pi) ** domain.group.rank / domain.volume),
    }
    pictures = {
        "polygon": summary.polygon,
        "images": summary.images,
        "center": domain.center,
    }
    return Measured(numbers, pictures)


def measure_ranges(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Search the smallest and largest static torque of each joint; count the group."""
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    low, high = torque_range(robot, gravity)
    dense = dense_targets([[-np.pi, np.pi]] * robot.n).q
    return Measured(
        {
            "order": group.order,
            "lowest": low,
            "highest": high,
            "stable_orbits": float(has_stable_image(dense, gravity, group).mean()),
            "negating": _negating(group),
        },
        {"skeleton": skeleton(robot)},
    )


def _negating(group: SymmetryGroup) -> int:
    """Return how many relations negate every torque: one is enough for symmetric ranges."""
    return sum(bool(np.all(np.array(relation.Y) == -1)) for relation in group)


def torque_range(robot: Robot, gravity: GravityModel) -> tuple[Array, Array]:
    """Return the smallest and largest static torque of each joint (n,) [N m], by search."""

    def extreme(joint: int, sign: float) -> float:
        value, _ = largest_value(
            lambda q: sign * np.asarray(gravity.torque(q))[..., joint] + gravity_bound, robot.n
        )
        return sign * (value - gravity_bound)

    gravity_bound = float(gravity.potential.to_float().gradient_bound().max())
    low = np.array([extreme(joint, -1.0) for joint in range(robot.n)])
    high = np.array([extreme(joint, 1.0) for joint in range(robot.n)])
    return low, high


def skeleton(robot: Robot) -> dict[str, Array]:
    """Return joint positions, axes and centres of mass at `POSTURE`, in the world frame [m]."""
    import pinocchio as pin

    data = robot.model.createData()
    posture = np.resize(POSTURE, robot.n)
    pin.forwardKinematics(robot.model, data, posture)
    frames = list(data.oMi)[1:]
    axes = pin.computeJointJacobians(robot.model, data, posture)
    levers = [inertia.lever for inertia in list(robot.model.inertias)[1:]]
    return {
        "joints": np.array([frame.translation for frame in frames]),
        "axes": np.array(axes).reshape(6, -1)[3:].T,
        "masses": np.array([inertia.mass for inertia in list(robot.model.inertias)[1:]]),
        "centres": np.array([f.act(c) for f, c in zip(frames, levers, strict=True)]),
    }
