"""A rigid chain: the numbers that its static torque depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.compiled_torque import chain_jacobian, chain_torques
from isotorque.learning.learners.rigid.fitting.joint_columns import (
    ColumnShape,
    JointColumn,
    features,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ChainParameters:
    """The statics of an arm of rigid links with revolute joints, of whatever geometry and masses.

    Attributes
    ----------
    parents : (n,) int array
        Joint that carries each joint, -1 for the base; always smaller than the joint's own index.
    rotations : (n, 3, 3) array
        F_j: from the frame of the parent link (upward is z at the base) to one whose z is the
        joint's axis.
    levers : (n, 2) array
        s_j [N m]: weight times lever of all that link j carries, along x and y of its frame.
    gains : (n,) array
        Measured torque over true torque, of every joint.
    columns : tuple of JointColumn
        What the measured torque contains beside the chain's.
    coefficients : (p,) array
        Of the columns.

    Notes
    -----
    With v the upward direction in the frame of a link and h what the link carries, levers seen
    from its joint, the walk outwards and back

        v_j = Rz(q_j)^T F_j^T v_parent,      h_j = s_j + sum over children c of F_c Rz(q_c) h_c

    gives the potential ``sum over first joints of v.h`` and the torques
    ``g_j = h_jx v_jy - h_jy v_jx``. *Proof*: write the position of every mass as a product of
    homogeneous transforms; the translation of joint c in link j is the same whatever q beyond j,
    so all mass carried by c, times that translation, adds a constant to s_j; nothing else of it
    matters. The part of s_j along the joint's own axis does not move in the parent's frame: it is
    a part of the parent's lever, or of nothing for a first joint, and is left out here.
    A zero of the angle q_j moves into F_j, so zeros need not be known.

    Lengths do not occur. At most 4 n - 1 of these numbers can be told apart by torques for
    a serial arm: one for the tilt of the first axis, two for each further axis, two per lever.
    With offsets there are n more, with gains as many as there are ratios of gains of coupled
    joints.

    Examples
    --------
    A pendulum about a horizontal axis, its mass on the x axis of the link:

    >>> sideways = [[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]]
    >>> pendulum = ChainParameters.of(sideways, [[6.13, 0.0]])
    >>> pendulum.torque([[0.0], [np.pi / 2]]).round(9).tolist()
    [[6.13], [0.0]]
    """

    parents: Integers
    rotations: Array
    levers: Array
    gains: Array
    columns: tuple[JointColumn, ...]
    coefficients: Array

    @classmethod
    def of(
        cls,
        rotations: ArrayLike,
        levers: ArrayLike,
        *,
        parents: Sequence[int] | Integers | None = None,
        gains: ArrayLike | None = None,
        columns: Sequence[JointColumn] = (),
        coefficients: ArrayLike = (),
    ) -> ChainParameters:
        """Make a chain; by default serial, measured torques being true torques."""
        F = np.ascontiguousarray(rotations, dtype=float)
        n = len(F)
        return cls(
            serial(n) if parents is None else checked_parents(parents, n),
            F,
            np.ascontiguousarray(levers, dtype=float).reshape(n, 2),
            np.ones(n) if gains is None else np.array(gains, dtype=float),
            tuple(columns),
            np.array(coefficients, dtype=float),
        )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.parents)

    @property
    def offsets(self) -> Array:
        """Constant part of the measured torque of every joint, (n,) [N m]."""
        return self.coefficient(ColumnShape.OFFSET)

    @property
    def correction(self) -> Correction:
        """Constants and springs of the joints: what may be taken off the measured torques."""
        return Correction(self.offsets, self.coefficient(ColumnShape.SPRING))

    def coefficient(self, shape: ColumnShape) -> Array:
        """What multiplies a shape in the measured torque of every joint, (n,); 0 without."""
        result = np.zeros(self.n)
        for column, x in zip(self.columns, self.coefficients, strict=True):
            if column.shape is shape:
                result[column.joint] += x
        return result

    def torque(self, q: ArrayLike) -> Array:
        """Measured torque (m, n) [N m] at configurations (m, n) [rad]."""
        return torques_of([self], q)[0]

    def stiffness(self, q: ArrayLike) -> Array:
        """Derivatives of the measured torque by q, (m, n, n) [N m/rad]."""
        return self.derivatives(q, raw_directions(self.n)).stiffness

    def derivatives(self, q: ArrayLike, directions: Array) -> ChainDerivatives:
        """Torques and their derivatives by q and by every parameter.

        Parameters
        ----------
        q : (m, n) array_like
            Configurations [rad].
        directions : (n, 2, 3) array
            Two tangent vectors t of every rotation: ``F exp(x t)``.
        """
        points = np.ascontiguousarray(q, dtype=float)
        m, n = points.shape
        true, turned = np.empty((m, n)), np.empty((m, n, 2 * n))
        leant, stiffness = np.empty((m, n, 2 * n)), np.empty((m, n, n))
        chain_jacobian(
            self.parents,
            self.rotations,
            self.levers,
            np.ascontiguousarray(directions, dtype=float),
            points,
            true,
            turned,
            leant,
            stiffness,
        )
        gains = self.gains[:, None]
        stiffness *= gains
        for column, x in zip(self.columns, self.coefficients, strict=True):
            stiffness[:, column.joint, column.joint] += x * column.slope(points)
        extra = features(self.columns, points)
        return ChainDerivatives(
            true * self.gains + extra @ self.coefficients,
            turned * gains,
            leant * gains,
            true[:, :, None] * np.eye(n),
            extra,
            stiffness,
        )

    def with_levers(self, levers: Array) -> ChainParameters:
        """The same chain with other levers."""
        return replace(self, levers=np.ascontiguousarray(levers, dtype=float))

    def true_chain(self) -> ChainParameters:
        """The chain without gains and columns: the torque of gravity alone."""
        return replace(self, gains=np.ones(self.n), columns=(), coefficients=np.zeros(0))

    def to_arrays(self) -> dict[str, NDArray]:
        """Everything, as arrays of numbers."""
        return {
            "parents": self.parents,
            "rotations": self.rotations,
            "levers": self.levers,
            "gains": self.gains,
            "column_joints": np.array([c.joint for c in self.columns], dtype=np.int64),
            "column_shapes": np.array(
                [list(ColumnShape).index(c.shape) for c in self.columns], int
            ),
            "coefficients": self.coefficients,
        }

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any]) -> ChainParameters:
        """Inverse of `to_arrays`."""
        shapes = list(ColumnShape)
        columns = [
            JointColumn(int(j), shapes[int(s)])
            for j, s in zip(arrays["column_joints"], arrays["column_shapes"], strict=True)
        ]
        return cls.of(
            arrays["rotations"],
            arrays["levers"],
            parents=np.rint(arrays["parents"]).astype(np.int64),
            gains=arrays["gains"],
            columns=columns,
            coefficients=arrays["coefficients"],
        )


@dataclass(frozen=True, eq=False)
class ChainDerivatives:
    """Measured torques of a chain and their derivatives, at m configurations.

    Attributes
    ----------
    torque : (m, n) array
        [N m].
    turned, leant : (m, n, 2 n) arrays
        By the tangents of the rotations and by the levers, columns ``2 j`` and ``2 j + 1``.
    gained : (m, n, n) array
        By the gains.
    added : (m, n, p) array
        By the coefficients of the columns.
    stiffness : (m, n, n) array
        By q [N m/rad].
    """

    torque: Array
    turned: Array
    leant: Array
    gained: Array
    added: Array
    stiffness: Array

    def by_parameters(self) -> Array:
        """Derivatives by rotations, levers, gains and coefficients, (m, n, 5 n + p)."""
        return np.concatenate([self.turned, self.leant, self.gained, self.added], axis=2)


def torques_of(chains: Sequence[ChainParameters], q: ArrayLike) -> Array:
    """Measured torques (r, m, n) [N m] of chains of one tree, with the same columns.

    Three times as fast as one after the other: sines and cosines of the angles are shared.
    """
    points, one = np.ascontiguousarray(q, dtype=float), chains[0]
    rotations, levers, gains, coefficients = (
        np.stack([getattr(chain, name) for chain in chains])
        for name in ("rotations", "levers", "gains", "coefficients")
    )
    result = np.empty((len(chains), *points.shape))
    chain_torques(one.parents, rotations, levers, points, result)
    result *= gains[:, None]
    if one.columns:
        added = features(one.columns, points) @ coefficients.T
        result += np.moveaxis(added, 2, 0)
    return result


def serial(joints: int) -> Integers:
    """Parents of joints in series."""
    return np.arange(-1, joints - 1, dtype=np.int64)


def checked_parents(parents: Sequence[int] | Integers, joints: int) -> Integers:
    """Parents as an array.

    Raises
    ------
    InputError
        If there is not one per joint, each smaller than the joint's own index.
    """
    result = np.asarray(parents)
    good = result.shape == (joints,) and np.issubdtype(result.dtype, np.integer)
    if not (good and np.all(result >= -1) and np.all(result < np.arange(joints))):
        accepted = f"{joints} whole numbers, each -1 (base) or the number of an earlier joint"
        raise InputError("rigid chain", "parents", list(parents), accepted)
    return result.astype(np.int64)


def raw_directions(joints: int) -> Array:
    """Tangents that turn the axes and leave the angles' zeros alone: about y, then x."""
    return np.tile([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], (joints, 1, 1))
