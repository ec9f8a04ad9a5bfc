"""Poses to measure next: for a chain that was learned, or for an arm of which a file is known."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from isotorque.learning.files.saved_models import load_model
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.information import parameter_mask
from isotorque.learning.learners.rigid.planning.pose_plan import (
    PosePlan,
    plan_poses,
    plan_poses_within,
)
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import Robot

Array = NDArray[np.float64]

REGION = 400
"""Random poses that stand for the region."""
NOMINAL = 1e-3
"""Noise where none is known, relative to the largest torque: it scales what is expected."""


@dataclass(frozen=True, eq=False)
class ChainPlan:
    """A plan and what it is about.

    Attributes
    ----------
    plan : PosePlan
        The poses.
    joint_names : tuple of str
        Joints in the order of the poses.
    low, high : (n,) arrays
        Region in which the torque is to be known, and poses are chosen [rad].
    torque_noise : (n,) array
        What was reckoned with [N m].
    """

    plan: PosePlan
    joint_names: tuple[str, ...]
    low: Array
    high: Array
    torque_noise: Array

    def csv(self) -> str:
        """The poses as CSV, columns named as `learn --data` wants them; torques are missing."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([f"{name}.q" for name in self.joint_names])
        writer.writerows([[f"{x:.6f}" for x in pose] for pose in self.plan.poses])
        return text.getvalue()

    def document(self) -> dict[str, Any]:
        """Return all there is to tell, for JSON."""
        return {
            "joints": list(self.joint_names),
            "poses": self.plan.poses.tolist(),
            "expected_standard_error": self.plan.expected.tolist(),
            "standard_error_before": self.plan.before,
            "region": np.stack([self.low, self.high], axis=1).tolist(),
            "torque_noise": self.torque_noise.tolist(),
        }


def plan_for_model(
    path: Path, count: int, *, within: float = 0.0, choice: Array | None = None, seed: int = 0
) -> ChainPlan:
    """Poses that tell most beside those that a saved chain was learned from.

    The region is the range of the angles that were recorded.

    Raises
    ------
    InputError
        If the model is no rigid chain.
    """
    saved = load_model(path)
    learner = saved.learner
    if not isinstance(learner, RigidChain):
        raise InputError(path, "learner", type(learner).__name__, "a rigid chain")
    samples, chain = learner.fit_.samples, learner.chain_
    low, high = samples.q.min(axis=0), samples.q.max(axis=0)
    noise = samples.torque_noise
    if not noise.any() and not samples.angle_noise.any():
        noise = np.full(samples.n, NOMINAL * samples.largest_torque)
    region = np.random.default_rng(seed).uniform(low, high, (REGION, samples.n))
    known = chain, learner.fit_.model.free, samples.with_torque_noise(noise)
    if choice is None:
        plan = plan_poses_within(*known, low, high, region, count, within, random_state=seed)
    else:
        plan = plan_poses(*known, choice, region, count, within)
    return ChainPlan(plan, saved.joint_names, low, high, noise)


def plan_for_robot(
    robot: Robot, count: int, *, within: float = 0.0, choice: Array | None = None, seed: int = 0
) -> ChainPlan:
    """Poses within joint limits that tell most of an arm whose file serves as a first guess.

    Poses in which a torque would exceed the effort limit of its joint are left out.

    Raises
    ------
    InputError
        If no pose remains.
    """
    chain = chain_of_tree(robot.tree)
    low, high = (np.clip(x, -np.pi, np.pi) for x in np.array(robot.limits, dtype=float).T)
    region = np.random.default_rng(seed).uniform(low, high, (REGION, robot.n))
    effort = np.asarray(robot.model.effortLimit, dtype=float)
    effort = np.where(effort > 0, effort, np.inf)
    noise = np.full(robot.n, NOMINAL * float(np.abs(chain.torque(region)).max()))
    nothing = np.zeros((0, robot.n))
    seen = ChainSamples(nothing, nothing, noise, np.zeros(robot.n), np.zeros(0))
    known = chain, parameter_mask(robot.n), seen
    if choice is None:
        box = low, high, region
        plan = plan_poses_within(*known, *box, count, within, effort=effort, random_state=seed)
    else:
        held = choice[np.all(np.abs(chain.torque(choice)) <= effort, axis=1)]
        if not len(held):
            raise InputError(robot.name, "poses within effort limits", 0, "at least one")
        plan = plan_poses(*known, held, region, count, within)
    return ChainPlan(plan, robot.joint_names, low, high, noise)


def read_poses(path: Path, joint_names: tuple[str, ...]) -> Array:
    """Poses to choose from: a CSV with ``<joint>.q`` or ``q1,..,qn``; other columns are ignored.

    Raises
    ------
    InputError
        If the file cannot be read, or a column or a number is missing.
    """
    try:
        rows = [row for row in csv.reader(path.read_text("utf-8-sig").splitlines()) if any(row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(path, "file", f"not readable ({error})", "a CSV file of poses") from error
    header = [entry.strip() for entry in rows[0]] if rows else []
    for wanted in (
        [f"{name}.q" for name in joint_names],
        [f"q{k + 1}" for k in range(len(joint_names))],
    ):
        if set(wanted) <= set(header):
            places = [header.index(column) for column in wanted]
            break
    else:
        accepted = f"{','.join(f'{name}.q' for name in joint_names)}, or q1,..,q{len(joint_names)}"
        raise InputError(f"{path}, line 1", "header", ",".join(header), accepted)
    try:
        poses = np.array([[float(row[k]) for k in places] for row in rows[1:]], dtype=float)
    except (ValueError, IndexError) as error:
        raise InputError(path, "pose", str(error), "one number per joint [rad]") from error
    if not len(poses) or not np.isfinite(poses).all():
        raise InputError(path, "poses", "none, or not finite", "at least one line of finite angles")
    return poses


def chain_of_tree(tree: KinematicTree) -> ChainParameters:
    """The chain of an arm whose geometry and masses are known.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> chain = chain_of_tree(load_robot("2r").tree)
    >>> chain.torque([[0.0, 0.0]]).round(2).tolist()
    [[24.52, 6.13]]
    """
    n = tree.n
    gravity = np.asarray(tree.gravity, dtype=float)
    size = float(np.linalg.norm(gravity)) or 1.0
    upright = _turning_z_to(-gravity / size)
    aligned = [_turning_z_to(np.asarray(axis, dtype=float)) for axis in tree.axes]
    carried = np.array(tree.masses, dtype=float)
    moments = carried[:, None] * np.asarray(tree.levers, dtype=float)
    rotations = np.empty((n, 3, 3))
    for j in range(n - 1, -1, -1):
        p = tree.parents[j]
        before = upright if p < 0 else aligned[p]
        rotations[j] = before.T @ np.asarray(tree.rotations[j], dtype=float) @ aligned[j]
        if p >= 0:
            carried[p] += carried[j]
            moments[p] += carried[j] * np.asarray(tree.translations[j], dtype=float)
            moments[p] += np.asarray(tree.rotations[j], dtype=float) @ (
                aligned[j][:, 2] * (aligned[j][:, 2] @ moments[j])
            )
    levers = np.array([size * (a.T @ m)[:2] for a, m in zip(aligned, moments, strict=True)])
    return ChainParameters.of(rotations, levers, parents=[int(p) for p in tree.parents])


def _turning_z_to(direction: Array) -> Array:
    return np.asarray(Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])[0].as_matrix())
