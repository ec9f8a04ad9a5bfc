"""The numbers of an arm as compiled code wants them: a few flat arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError

REVOLUTE = 0
PRISMATIC = 1

# Columns of ``Chain.links``.
ROTATION = 0  # 9: placement of the joint frame in its parent's, row by row
TRANSLATION = 9  # 3 [m]
MASS = 12  # [kg]
LEVER = 13  # 3: centre of mass in the joint frame [m]
MOMENTS = 16  # 6: second moments of mass about the centre of mass, xx xy xz yy yz zz [kg m^2]
ARMATURE = 22  # inertia of the motor as the joint feels it [kg m^2]
LINK_COLUMNS = 23


@dataclass(frozen=True, eq=False)
class Chain:
    """A serial or branched arm of joints with one axis each.

    Attributes
    ----------
    parents : (n,) int array
        One plus the index of the parent joint; 0 is the base. Parents come first.
    kinds : (n,) int array
        ``REVOLUTE`` or ``PRISMATIC``.
    links : (n, LINK_COLUMNS) array
        One row per joint and the link it carries, columns as named in this module.
    gravity : (3,) array
        Gravitational acceleration in the base frame [m/s^2].

    Notes
    -----
    Joint frames are turned such that the axis of every joint is its frame's z-axis; a joint's
    rotation then mixes two columns of a matrix and leaves the third alone. Links carry second
    moments ``integral of x x' dm`` instead of inertias: the equations get shorter.
    """

    parents: NDArray[np.int64]
    kinds: NDArray[np.int64]
    links: NDArray[np.float64]
    gravity: NDArray[np.float64]

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.parents)

    @property
    def arrays(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """The four arrays in the order in which compiled functions take them."""
        return self.parents, self.kinds, self.links, self.gravity

    @classmethod
    def from_model(cls, model: pin.Model) -> Chain:
        """Read the chain out of a Pinocchio model with one coordinate per joint.

        Parameters
        ----------
        model
            Model with nq = nv = number of joints.

        Raises
        ------
        InputError
            Naming the first joint that neither turns about nor slides along one axis.
        """
        n = model.njoints - 1
        chain = cls(
            parents=np.array([int(p) for p in model.parents[1:]], dtype=np.int64),
            kinds=np.empty(n, dtype=np.int64),
            links=np.empty((n, LINK_COLUMNS)),
            gravity=np.array(model.gravity.linear, dtype=float),
        )
        turns = [np.eye(3)]
        for i in range(n):
            kind, axis = _axis(model, i + 1)
            turn = _frame_along(axis)
            placement = model.jointPlacements[i + 1]
            parent_turn = turns[chain.parents[i]]
            inertia = model.inertias[i + 1]
            # trace(J)/2 E - J turns the rotational inertia J into second moments of mass.
            moments = turn.T @ (np.trace(inertia.inertia) / 2 * np.eye(3) - inertia.inertia) @ turn
            row = chain.links[i]
            row[ROTATION : ROTATION + 9] = (parent_turn.T @ placement.rotation @ turn).ravel()
            row[TRANSLATION : TRANSLATION + 3] = parent_turn.T @ placement.translation
            row[MASS] = inertia.mass
            row[LEVER : LEVER + 3] = turn.T @ inertia.lever
            row[MOMENTS : MOMENTS + 6] = moments[np.triu_indices(3)]
            row[ARMATURE] = model.armature[i]
            chain.kinds[i] = kind
            turns.append(turn)
        return chain


def _axis(model: pin.Model, joint: int) -> tuple[int, NDArray]:
    """Return the kind and the unit axis of a joint, read from its motion subspace."""
    joint_model = model.joints[joint]
    if joint_model.nq == 1 and joint_model.nv == 1 and joint_model.idx_v == joint - 1:
        data = joint_model.createData()
        joint_model.calc(data, np.zeros(model.nq))
        motion = np.asarray(data.S).reshape(6)
        if not motion[:3].any():
            return REVOLUTE, motion[3:]
        if not motion[3:].any():
            return PRISMATIC, motion[:3]
    raise InputError(
        model.name or "model",
        f"type of joint '{model.names[joint]}'",
        joint_model.shortname().removeprefix("JointModel"),
        "joints with one coordinate: revolute or prismatic",
    )


def _frame_along(axis: NDArray) -> NDArray:
    """Return a rotation whose third column is the unit vector ``axis``.

    It holds only zeros and ones where the axis lies along a coordinate, so nothing is rounded.
    """
    first = np.eye(3)[(int(np.argmax(abs(axis))) + 1) % 3]
    first = first - (first @ axis) * axis
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])
