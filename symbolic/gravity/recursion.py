"""Gravity torque and stiffness of numbers, by one pass out and one pass back along the chain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.kinematic_tree import KinematicTree

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GravityChain:
    """A tree reduced to what the gravity torque depends on, in frames whose z axis is the joint.

    Attributes
    ----------
    parents : (n,) int64 array
        Parent joint of each joint, -1 for the base.
    rotations : (n, 3, 3) array
        Fixed rotations from the parent's frame. The x axes are chosen perpendicular to both
        joint axes, which makes entry (2, 0) zero and, on axis-aligned arms, most others too.
    moments : (n, 3) array
        Constant first moments of mass of each link about its joint [kg m].
    gravity : (3,) array
        Gravitational acceleration in the base frame [m/s^2].

    Notes
    -----
    Lengths and masses have vanished into ``moments``: a child's mass acts as a point mass at its
    joint, and a moment along a joint's own axis is constant in the parent's frame, so both are
    added to the parent (regrouping to base parameters, Khalil and Dombre, Modeling,
    Identification and Control of Robots, 2002, section 9.4).

    With ``v_i`` the acceleration of gravity seen from link i and ``s_i`` the first moment of mass
    of everything it carries about its joint, ``g_i = -v_i . (z x s_i)``. Turning a joint i that
    carries joint j turns gravity seen from j by ``v_i x z``, hence
    ``dg_j/dq_i = -(v_i x z seen from j) . (z x s_j)``, and dg/dq is symmetric.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 5.

    Examples
    --------
    >>> from isotorque.symbolic.robots.kinematic_tree import planar_arm
    >>> values = {"m1": 5, "m2": 5, "l1": 0.25, "c1": 0.125, "c2": 0.125, "g": 9.81}
    >>> chain = GravityChain.of(planar_arm(2).substitute(values))
    >>> print(chain.torque([0.0, 0.0]))
    [24.525   6.13125]
    """

    parents: NDArray[np.int64]
    rotations: Floats
    moments: Floats
    gravity: Floats

    @classmethod
    def of(cls, tree: KinematicTree) -> GravityChain:
        """Reduce a tree whose entries are numbers.

        Raises
        ------
        InputError
            If an entry contains symbols.
        """
        links, offsets, axes, masses, levers, gravity = (
            _numbers(getattr(tree, field), field)
            for field in ("rotations", "translations", "axes", "masses", "levers", "gravity")
        )
        n = tree.n
        rotations = np.empty((n, 3, 3))
        frames = np.empty((n, 3, 3))  # columns: the new axes in the link's old frame
        for i, parent in enumerate(tree.parents):
            seen = links[i] if parent < 0 else frames[parent].T @ links[i]
            rotations[i] = _frame_with_axis(seen @ axes[i])
            frames[i] = seen.T @ rotations[i]
        carried = masses.copy()
        moments = np.array([m * (f.T @ c) for m, f, c in zip(masses, frames, levers, strict=True)])
        moments = moments.reshape(n, 3)
        for i in range(n - 1, -1, -1):
            parent = tree.parents[i]
            if parent >= 0:
                carried[parent] += carried[i]
                moments[parent] += carried[i] * (frames[parent].T @ offsets[i])
                moments[parent] += rotations[i][:, 2] * moments[i, 2]
            moments[i, 2] = 0.0
        return cls(np.array(tree.parents, dtype=np.int64), rotations, moments, gravity)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.parents)

    def torque(self, q: ArrayLike) -> Floats:
        """Return the gravity torque at ``q`` (..., n) [rad], of shape (..., n) [N m].

        Raises
        ------
        InputError
            If the last axis of ``q`` does not hold n angles.
        """
        points = self._points(q)
        flat = points if points.ndim == 1 else points.ravel()
        _kernels().torque(self.parents, self._table, flat, flat)  # angles become torques in place
        return points

    def stiffness(self, q: ArrayLike) -> Floats:
        """Return dg/dq at ``q`` (..., n) [rad], of shape (..., n, n) [N m/rad].

        Raises
        ------
        InputError
            If the last axis of ``q`` does not hold n angles.
        """
        points = self._points(q)
        matrices = np.zeros((*points.shape, self.n))
        flat = matrices.reshape(-1, self.n, self.n)
        _kernels().stiffness(self.parents, self._table, points.ravel(), flat)
        return matrices

    def _points(self, q: ArrayLike) -> Floats:
        # Always a copy: compiled code is specialised to writable arrays in C order.
        points = np.array(q, dtype=np.float64, order="C")
        if points.shape[-1:] != self.parents.shape:
            raise InputError("configuration", "shape", points.shape, f"(..., {self.n})")
        return points

    @cached_property
    def _table(self) -> Floats:
        """Return one row per joint, rotation by rows and moment, and gravity in the last row."""
        table = np.zeros((self.n + 1, 12))
        table[:-1, :9] = self.rotations.reshape(-1, 9)
        table[:-1, 9:] = self.moments
        table[-1, :3] = self.gravity
        return table


@cache
def _kernels() -> ModuleType:
    from isotorque.symbolic.gravity import recursion_kernels

    return recursion_kernels


def _numbers(values: NDArray, field: str) -> Floats:
    if values.dtype != object:
        return np.asarray(values, dtype=np.float64)
    out = np.empty(values.shape)
    for index, value in np.ndenumerate(values):
        try:
            out[index] = int(value.p) / int(value.q) if hasattr(value, "p") else float(value)
        except TypeError:
            raise InputError(
                "kinematic tree", f"an entry of {field}", value, "a number (substitute the symbols)"
            ) from None
    return out


def _frame_with_axis(z: Floats) -> Floats:
    """Return a rotation with third column ``z`` and, if it can, a first column without z part."""
    x = np.array([-z[1], z[0], 0.0])  # e_z x z
    if np.hypot(x[0], x[1]) < 0.1:  # nearly parallel: e_x, made perpendicular
        x = np.array([1.0, 0.0, 0.0]) - z[0] * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z]) + 0.0  # no negative zeros
