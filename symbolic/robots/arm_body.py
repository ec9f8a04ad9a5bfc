"""The body of an arm with revolute joints as plain arrays, to and from a Pinocchio model."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import read_limits
from isotorque.symbolic.robots.kinematic_tree import KinematicTree

Array = NDArray[np.float64]

_BOUNDED = frozenset(
    {"JointModelRX", "JointModelRY", "JointModelRZ", "JointModelRevoluteUnaligned"}
)
_CONTINUOUS = frozenset(
    {"JointModelRUBX", "JointModelRUBY", "JointModelRUBZ", "JointModelRevoluteUnboundedUnaligned"}
)


@dataclass(frozen=True, eq=False)
class ArmBody:
    """Joints, links, limits and damping of an arm; one angle per joint.

    Attributes
    ----------
    joint_names : tuple of str
        One name per joint, in Pinocchio's order.
    parents : tuple of int
        Parent joint of each joint, -1 for the base; always smaller than the joint's own index.
    rotations : (n, 3, 3) array
        Fixed rotations of the joints in their parents' frames.
    translations : (n, 3) array
        Fixed translations of the joints in their parents' frames [m].
    axes : (n, 3) array
        Unit joint axes in the joints' frames.
    masses : (n,) array
        Link masses, with everything that is fixed to the link [kg].
    levers : (n, 3) array
        Centres of mass in the joints' frames [m].
    inertias : (n, 3, 3) array
        Rotational inertias about the centres of mass, in the joints' frames [kg m^2].
    limits : (n, 2) array
        Joint limits [rad], infinite where there is none.
    efforts, velocities : (n,) arrays
        Largest torques [N m] and speeds [rad/s]; infinite where there is no limit.
    damping, friction : (n,) arrays
        Viscous damping [N m s/rad] and Coulomb friction [N m].
    armature : (n,) array
        Inertia of the motor seen from the joint [kg m^2].
    gravity : (3,) array
        Gravitational acceleration in the base frame [m/s^2].
    """

    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    rotations: Array
    translations: Array
    axes: Array
    masses: Array
    levers: Array
    inertias: Array
    limits: Array
    efforts: Array
    velocities: Array
    damping: Array
    friction: Array
    armature: Array
    gravity: Array

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @classmethod
    def from_model(cls, model: pin.Model, where: str) -> ArmBody:
        """Read the body out of a Pinocchio model.

        Parameters
        ----------
        model
            Any model whose joints are all revolute, with or without limits.
        where
            What to call the model in an error.

        Raises
        ------
        InputError
            For a model without joints, or naming the first joint that is not revolute.
        """
        if model.njoints < 2:
            raise InputError(where, "number of moving joints", 0, "at least one revolute joint")
        joints = range(1, model.njoints)
        for j in joints:
            kind = model.joints[j].shortname()
            if kind not in _BOUNDED | _CONTINUOUS:
                raise InputError(
                    where,
                    f"type of joint '{model.names[j]}'",
                    kind.removeprefix("JointModel"),
                    "revolute or continuous joints",
                )
        row = {j: model.joints[j].idx_v for j in joints}
        return cls(
            joint_names=tuple(model.names[j] for j in joints),
            parents=tuple(int(model.parents[j]) - 1 for j in joints),
            rotations=np.array([model.jointPlacements[j].rotation for j in joints]),
            translations=np.array([model.jointPlacements[j].translation for j in joints]),
            axes=np.array([_axis(model, j) for j in joints]),
            masses=np.array([model.inertias[j].mass for j in joints]),
            levers=np.array([model.inertias[j].lever for j in joints]),
            inertias=np.array([model.inertias[j].inertia for j in joints]),
            limits=np.array([_limits(model, j) for j in joints]),
            efforts=np.array([positive_or_none(model.upperEffortLimit[row[j]]) for j in joints]),
            velocities=np.array(
                [positive_or_none(model.upperVelocityLimit[row[j]]) for j in joints]
            ),
            damping=np.array([model.damping[row[j]] for j in joints]),
            friction=np.array([model.upperDryFrictionLimit[row[j]] for j in joints]),
            armature=np.array([model.armature[row[j]] for j in joints]),
            gravity=np.array(model.gravity.linear),
        )

    def to_model(self, name: str) -> pin.Model:
        """Build the Pinocchio model of this body; nq = nv = n, joints in the same order."""
        model = pin.Model()
        model.name = name
        model.gravity.linear = self.gravity
        for i, joint_name in enumerate(self.joint_names):
            index = model.addJoint(
                self.parents[i] + 1,
                _joint_model(self.axes[i]),
                pin.SE3(self.rotations[i], self.translations[i]),
                joint_name,
                np.array([-self.efforts[i]]),
                np.array([self.efforts[i]]),
                np.array([-self.velocities[i]]),
                np.array([self.velocities[i]]),
                self.limits[i, :1],
                self.limits[i, 1:],
                np.array([-self.friction[i]]),
                np.array([self.friction[i]]),
                self.damping[i : i + 1],
            )
            model.addJointFrame(index)
            # not appendBodyToJoint, which divides by the mass, and so rounds the lever; nor the
            # constructor, which refuses the unphysical rotational inertias of some published arms
            inertia = pin.Inertia.Zero()
            inertia.mass = float(self.masses[i])
            inertia.lever = self.levers[i]
            inertia.inertia = self.inertias[i]
            model.inertias[index] = inertia
        model.armature = self.armature
        return model

    def tree(self) -> KinematicTree:
        """Return the part of the body that gravity sees."""
        return KinematicTree(
            self.joint_names,
            self.parents,
            self.rotations,
            self.translations,
            self.axes,
            self.masses,
            self.levers,
            self.gravity,
        )

    def digest(self) -> str:
        """Return a fingerprint of joints, kinematics, inertias, limits and damping (sha256, hex).

        Notes
        -----
        Numbers enter with twelve digits: the last ones differ between machines, whose sines and
        cosines are not all rounded alike.
        """
        sha = hashlib.sha256()
        for name, parent in zip(self.joint_names, self.parents, strict=True):
            sha.update(f"{name!r}<{parent};".encode())
        numbers = (
            self.rotations,
            self.translations,
            self.axes,
            self.masses,
            self.levers,
            self.inertias,
            self.limits,
            self.damping,
            self.gravity,
        )
        for values in numbers:
            text = ",".join(f"{x:.12g}" for x in np.where(abs(values) < 1e-13, 0.0, values).ravel())
            sha.update(f"|{text}".encode())
        return sha.hexdigest()


def _axis(model: pin.Model, joint: int) -> Array:
    """Return the axis of a revolute joint, read from its motion subspace."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, pin.neutral(model))
    return np.array(np.asarray(data.S).reshape(6)[3:])


def _joint_model(axis: Array) -> pin.JointModel:
    """Return the revolute joint about an axis."""
    coordinate = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)
    for unit, kind in zip(np.eye(3), coordinate, strict=True):
        if np.array_equal(axis, unit):
            return kind()
    return pin.JointModelRevoluteUnaligned(axis)


def _limits(model: pin.Model, joint: int) -> tuple[float, float]:
    """Return a joint's limits [rad], infinite where it has none."""
    kind = model.joints[joint]
    if kind.shortname() in _CONTINUOUS:
        return -math.inf, math.inf
    return read_limits(model.lowerPositionLimit[kind.idx_q], model.upperPositionLimit[kind.idx_q])


def positive_or_none(limit: float) -> float:
    """Return a limit of torque or speed; 0 and -1 mean that there is none: infinity.

    Examples
    --------
    >>> positive_or_none(87.0), positive_or_none(0.0), positive_or_none(-1.0)
    (87.0, inf, inf)
    """
    return float(limit) if limit > 0 else math.inf
