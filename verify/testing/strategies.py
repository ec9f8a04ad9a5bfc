"""Hypothesis strategies: random arms, configurations, relations and lies about relations."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from hypothesis import strategies as st
from numpy.typing import NDArray

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.pinocchio_models import pinocchio_model

Array = NDArray[np.float64]

AXES = tuple(np.array(v, dtype=float) for v in itertools.chain(np.eye(3), -np.eye(3)))
"""The six directions of a frame."""

SNAP_MARGIN = 1e-3
"""Generic angles keep this distance from multiples of pi/2: loading a robot snaps nearer ones."""


def quarter_turns() -> st.SearchStrategy[Array]:
    """Rotations (3, 3) by multiples of pi/2: the 24 of a cube, entries exactly 0 and +-1."""
    return st.sampled_from(_CUBE).map(np.array)


def generic_rotations() -> st.SearchStrategy[Array]:
    """Rotations (3, 3) by roll, pitch and yaw of any size, away from multiples of pi/2."""
    return st.tuples(*[_generic_angles()] * 3).map(lambda rpy: pin.rpy.rpyToMatrix(*rpy))


def configurations(n: int, *, turns: float = 1.0) -> st.SearchStrategy[Array]:
    """Configurations (n,) [rad]: multiples of pi/4 and generic angles in ``turns`` turns."""
    special = st.integers(-4, 4).map(lambda i: i * np.pi / 4)
    generic = st.floats(-turns * np.pi, turns * np.pi, allow_nan=False)
    return st.lists(special | generic, min_size=n, max_size=n).map(np.array)


@st.composite
def kinematic_trees(
    draw: st.DrawFn,
    min_joints: int = 1,
    max_joints: int = 4,
    *,
    branched: bool | None = None,
    planted: bool | None = None,
    massless: bool = True,
) -> KinematicTree:
    """Draw trees of revolute joints.

    Parameters
    ----------
    draw
        Given by Hypothesis.
    min_joints, max_joints
        Number of joints.
    branched
        Whether joints may hang on any earlier joint or the base (True), form one chain (False),
        or either (None).
    planted
        True: rotations by multiples of pi/2, axes, offsets and centres of mass along frame
        directions, so that symmetries abound. False: any rotation and direction, now and then
        one of those. None: drawn anew for every link.
    massless
        Whether a link may weigh nothing (legal for statics; its mass matrix may be singular).

    Returns
    -------
    SearchStrategy of KinematicTree
        Entries are floats; gravity is 9.81 m/s^2 along -z or, tilted, elsewhere. Trees
        shrink to short chains of planar, axis-aligned links.
    """
    n = draw(st.integers(min_joints, max_joints))
    tree_like = draw(st.booleans()) if branched is None else branched
    links = [
        draw(_links(draw(st.booleans()) if planted is None else not planted, massless))
        for _ in range(n)
    ]
    parents = [draw(st.integers(-1, i - 1)) if tree_like and i else i - 1 for i in range(n)]
    tilted = draw(st.booleans()) if planted is None else not planted
    down = draw(_directions()) if tilted else np.array([0.0, 0.0, -1.0])
    return KinematicTree(
        joint_names=tuple(f"joint{i + 1}" for i in range(n)),
        parents=tuple(parents),
        rotations=np.array([link.rotation for link in links]),
        translations=np.array([link.translation for link in links]),
        axes=np.array([link.axis for link in links]),
        masses=np.array([link.mass for link in links]),
        levers=np.array([link.lever for link in links]),
        gravity=9.81 * down,
    )


def models(
    min_joints: int = 1,
    max_joints: int = 4,
    *,
    branched: bool | None = None,
    planted: bool | None = None,
    massless: bool = False,
    continuous: bool | None = None,
) -> st.SearchStrategy[pin.Model]:
    """Pinocchio models of `kinematic_trees`, with limited or continuous joints (None: either)."""
    trees = kinematic_trees(
        min_joints, max_joints, branched=branched, planted=planted, massless=massless
    )
    unbounded = st.booleans() if continuous is None else st.just(continuous)
    return st.builds(lambda tree, free: pinocchio_model(tree, continuous=free), trees, unbounded)


def robots(
    min_joints: int = 1,
    max_joints: int = 4,
    *,
    branched: bool | None = None,
    planted: bool | None = None,
    massless: bool = False,
    continuous: bool | None = None,
) -> st.SearchStrategy[Robot]:
    """Robots loaded from `models`."""
    return models(
        min_joints,
        max_joints,
        branched=branched,
        planted=planted,
        massless=massless,
        continuous=continuous,
    ).map(lambda model: load_robot(model, allow_massless=True))


@dataclass(frozen=True, eq=False)
class KnownArm:
    """An arm, its gravity and its complete symmetry group.

    Attributes
    ----------
    gravity : GravityModel
    group : SymmetryGroup
    active : (a,) int array
        Joints that gravity torque depends on.
    """

    gravity: GravityModel
    group: SymmetryGroup
    active: NDArray[np.int64]

    @classmethod
    def of(cls, source: Robot | KinematicTree) -> KnownArm:
        """Derive gravity and group."""
        gravity = GravityModel(source)
        return cls(gravity, primary_symmetries(gravity.potential), _active(gravity))


def known_arms(
    min_joints: int = 1,
    max_joints: int = 3,
    *,
    branched: bool | None = None,
    planted: bool | None = True,
) -> st.SearchStrategy[KnownArm]:
    """Arms of `kinematic_trees` that feel gravity, with their groups."""
    trees = kinematic_trees(
        min_joints, max_joints, branched=branched, planted=planted, massless=False
    )
    weighty = trees.filter(lambda tree: _active(GravityModel(tree)).size > 0)
    return weighty.map(KnownArm.of)


def relations(group: SymmetryGroup) -> st.SearchStrategy[SymmetryRelation]:
    """Relations of a group, the identity first."""
    return st.sampled_from(list(group))


@st.composite
def lies(
    draw: st.DrawFn,
    group: SymmetryGroup,
    active: NDArray[np.int64],
    *,
    smallest: float = 1e-6,
) -> SymmetryRelation:
    """Draw relations that are false in one place, and certainly false.

    Parameters
    ----------
    draw
        Given by Hypothesis.
    group
        The arm's exact relations.
    active
        Indices of the joints that its gravity torque depends on (at least one).
    smallest
        Smallest error of an offset [rad].

    Returns
    -------
    SearchStrategy of SymmetryRelation
        A relation of the group with a sign of Y turned, an entry of A changed by one, or an
        entry of d moved by ``smallest`` to 0.1 rad.

    Notes
    -----
    Why each is a lie. *Y*: g_i would have to equal -g_i everywhere, but joint i is active. *A*,
    entry (i, j): some frequency has k_i = +-1, and (A^T k)_j, which must be +-k_j, changes by
    one, hence its parity. *d*, entry i: the phase k.d of that k moves by less than a turn.
    """
    true = draw(relations(group))
    A, d, Y = true.A.copy(), true.d.copy(), true.Y.copy()
    i = int(draw(st.sampled_from(active.tolist())))
    place = draw(st.sampled_from(["Y", "A", "d"]))
    if place == "Y":
        Y[i] = -Y[i]
    elif place == "A":
        A[i, draw(st.integers(0, len(d) - 1))] += draw(st.sampled_from([1.0, -1.0]))
    else:
        size = draw(st.floats(smallest, 0.1) | st.just(smallest))
        d[i] += draw(st.sampled_from([1.0, -1.0])) * size
    return SymmetryRelation(A, d, Y)


def _active(gravity: GravityModel) -> NDArray[np.int64]:
    return np.flatnonzero(np.any(gravity.potential.frequencies != 0, axis=0))


@dataclass(frozen=True, eq=False)
class _Link:
    rotation: Array
    translation: Array
    axis: Array
    mass: float
    lever: Array


@st.composite
def _links(draw: st.DrawFn, generic: bool, massless: bool) -> _Link:
    lengths = st.integers(1, 8).map(lambda i: i / 16)  # exact in binary, as in a drawn robot
    masses = st.integers(0 if massless else 1, 6).map(float)
    if not generic:
        along = st.sampled_from(AXES).map(np.array)
        reach, centre = draw(along), draw(along)
        return _Link(
            draw(quarter_turns()),
            reach * draw(lengths),
            draw(along),
            draw(masses),
            centre * draw(lengths | st.just(0.0)),
        )
    return _Link(
        draw(quarter_turns() | generic_rotations()),
        draw(_directions()) * draw(st.floats(0.05, 0.5)),
        draw(_directions()),
        draw(st.floats(0.1, 10.0) | (st.just(0.0) if massless else st.just(1.0))),
        draw(_directions()) * draw(st.just(0.0) | st.floats(0.001, 0.5)),
    )


def _generic_angles() -> st.SearchStrategy[float]:
    within = st.floats(SNAP_MARGIN, np.pi / 2 - SNAP_MARGIN)
    return st.builds(lambda quarter, rest: quarter * np.pi / 2 + rest, st.integers(-2, 1), within)


def _directions() -> st.SearchStrategy[Array]:
    """Unit vectors, generic ones well away from the frame's directions."""
    generic = st.tuples(_generic_angles(), st.floats(0.05, 1.5)).map(
        lambda a: np.array([np.sin(a[1]) * np.cos(a[0]), np.sin(a[1]) * np.sin(a[0]), np.cos(a[1])])
    )
    return st.sampled_from(AXES).map(np.array) | generic


def _cube_rotations() -> tuple[Array, ...]:
    signed = (
        np.eye(3)[list(order)] * np.array(signs)
        for order in itertools.permutations(range(3))
        for signs in itertools.product([1.0, -1.0], repeat=3)
    )
    proper = [matrix + 0.0 for matrix in signed if np.linalg.det(matrix) > 0]
    return tuple(sorted(proper, key=lambda matrix: -np.trace(matrix)))


_CUBE = _cube_rotations()
