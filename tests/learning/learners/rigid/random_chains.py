"""Random rigid chains, and the chain behind a kinematic tree, for tests."""

import numpy as np
from scipy.spatial.transform import Rotation

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.structure.canonical_form import rotation

KINDS = ("random", "right angles", "parallel", "vertical", "few levers")


def random_chain(rng, joints, kind="random", parents=None):
    """A chain with the given number of joints.

    Axes in any direction; at right angles, offsets likewise; parallel and horizontal; the first
    one vertical; or some levers zero. Levers of some N m.
    """
    F = Rotation.random(joints, random_state=rng).as_matrix().reshape(joints, 3, 3)
    levers = 5.0 * rng.normal(size=(joints, 2))
    quarter = np.pi / 2
    if kind == "right angles":
        F = [rotation(quarter * rng.integers(4), quarter * rng.integers(3)) for _ in range(joints)]
    elif kind == "parallel":
        F = [rotation(0.0, quarter if j == 0 else 0.0) for j in range(joints)]
    elif kind == "vertical":
        F[0] = np.eye(3)
    elif kind == "few levers":
        levers[rng.random(levers.shape) < 0.4] = 0.0
    return ChainParameters.of(F, levers, parents=parents)


def random_poses(rng, count, joints):
    """Configurations uniform over the torus."""
    return rng.uniform(-np.pi, np.pi, (count, joints))


def chain_of_tree(tree):
    """The chain of a kinematic tree with numbers: geometry and masses lumped into levers."""
    n = tree.n
    size = float(np.linalg.norm(tree.gravity))
    upright = _turn_z_to(-tree.gravity / size)
    aligned = [_turn_z_to(axis) for axis in tree.axes]
    parents = np.array(tree.parents)
    F = np.empty((n, 3, 3))
    carried = np.array(tree.masses, dtype=float)
    moments = tree.masses[:, None] * tree.levers
    for j in range(n - 1, -1, -1):
        p = parents[j]
        F[j] = (upright if p < 0 else aligned[p]).T @ tree.rotations[j] @ aligned[j]
        if p >= 0:
            carried[p] += carried[j]
            moments[p] += carried[j] * tree.translations[j]
    levers = np.array([size * a.T @ m for a, m in zip(aligned, moments, strict=True)])
    for j in range(n - 1, -1, -1):
        if parents[j] >= 0:
            levers[parents[j]] += F[j][:, 2] * levers[j, 2]
    return ChainParameters.of(F, levers[:, :2], parents=parents)


def _turn_z_to(direction):
    """A rotation whose third column is a direction."""
    return Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])[0].as_matrix()
