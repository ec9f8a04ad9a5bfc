"""Gravity torque and stiffness of numbers, by one pass out and one pass back along the chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.kinematic_tree import KinematicTree

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
    >>> from symbolic.kinematic_tree import planar_arm
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
        """Return the gravity torque at ``q`` (..., n) [rad], of shape (..., n) [N m]."""
        points = np.ascontiguousarray(q, dtype=np.float64)
        torques = np.empty(points.shape)
        if points.ndim == 1:
            _torque(*self._arrays, points[None], torques[None])
        else:
            _torque(*self._arrays, points.reshape(-1, self.n), torques.reshape(-1, self.n))
        return torques

    def stiffness(self, q: ArrayLike) -> Floats:
        """Return dg/dq at ``q`` (..., n) [rad], of shape (..., n, n) [N m/rad]."""
        points = np.ascontiguousarray(q, dtype=np.float64)
        n = self.n
        out = np.zeros((*points.shape, n))
        _stiffness(*self._arrays, points.reshape(-1, n), out.reshape(-1, n, n))
        return out

    @property
    def _arrays(self) -> tuple[NDArray[np.int64], Floats, Floats, Floats]:
        return self.parents, self.rotations, self.moments, self.gravity


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


@njit(cache=True)
def _passes(parents, rotations, moments, gravity, q, cos, sin, before, after, carried, turned):
    """Fill, for one configuration, gravity before/after each joint and the moments it carries."""
    n = len(parents)
    for i in range(n):
        cos[i], sin[i] = np.cos(q[i]), np.sin(q[i])
        seen = gravity if parents[i] < 0 else after[parents[i]]
        for j in range(3):
            before[i, j] = (
                rotations[i, 0, j] * seen[0]
                + rotations[i, 1, j] * seen[1]
                + rotations[i, 2, j] * seen[2]
            )
            carried[i, j] = moments[i, j]
        after[i, 0] = cos[i] * before[i, 0] + sin[i] * before[i, 1]
        after[i, 1] = cos[i] * before[i, 1] - sin[i] * before[i, 0]
        after[i, 2] = before[i, 2]
    for i in range(n - 1, -1, -1):
        turned[i, 0] = cos[i] * carried[i, 0] - sin[i] * carried[i, 1]
        turned[i, 1] = sin[i] * carried[i, 0] + cos[i] * carried[i, 1]
        if parents[i] >= 0:
            for j in range(3):
                carried[parents[i], j] += (
                    rotations[i, j, 0] * turned[i, 0]
                    + rotations[i, j, 1] * turned[i, 1]
                    + rotations[i, j, 2] * carried[i, 2]
                )


@njit(cache=True)
def _torque(parents, rotations, moments, gravity, q, out):
    n = len(parents)
    cos, sin = np.empty(n), np.empty(n)
    before, after = np.empty((n, 3)), np.empty((n, 3))
    carried, turned = np.empty((n, 3)), np.empty((n, 2))
    for b in range(len(q)):
        _passes(
            parents, rotations, moments, gravity, q[b],
            cos, sin, before, after, carried, turned,
        )  # fmt: skip
        for i in range(n):
            out[b, i] = turned[i, 1] * before[i, 0] - turned[i, 0] * before[i, 1]


@njit(cache=True)
def _stiffness(parents, rotations, moments, gravity, q, out):
    n = len(parents)
    cos, sin = np.empty(n), np.empty(n)
    before, after = np.empty((n, 3)), np.empty((n, 3))
    carried, turned = np.empty((n, 3)), np.empty((n, 2))
    push, seen = np.empty((n, 3)), np.empty(3)
    for b in range(len(q)):
        _passes(
            parents, rotations, moments, gravity, q[b],
            cos, sin, before, after, carried, turned,
        )  # fmt: skip
        for i in range(n):
            push[i, 0], push[i, 1], push[i, 2] = after[i, 1], -after[i, 0], 0.0
            out[b, i, i] = push[i, 0] * carried[i, 1] - push[i, 1] * carried[i, 0]
            above = np.zeros(n, dtype=np.bool_)
            above[i] = True
            for j in range(i + 1, n):
                p = parents[j]
                if p < 0 or not above[p]:
                    continue
                above[j] = True
                for a in range(3):
                    seen[a] = (
                        rotations[j, 0, a] * push[p, 0]
                        + rotations[j, 1, a] * push[p, 1]
                        + rotations[j, 2, a] * push[p, 2]
                    )
                push[j, 0] = cos[j] * seen[0] + sin[j] * seen[1]
                push[j, 1] = cos[j] * seen[1] - sin[j] * seen[0]
                push[j, 2] = seen[2]
                out[b, i, j] = push[j, 0] * carried[j, 1] - push[j, 1] * carried[j, 0]
                out[b, j, i] = out[b, i, j]
