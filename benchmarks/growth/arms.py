"""Arms of any number of joints: random ones, and chains of equal links in a plane."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from isotorque.symbolic.robots.load_robot import Robot, load_robot

LENGTH, MASS = 0.25, 2.0
"""Of each link [m], [kg]; each is a uniform rod."""


def random_arm(joints: int, seed: int = 0) -> Robot:
    """A serial arm whose axes and links point anywhere: its torque has no symmetry.

    Its gravity potential has all (3^n - 1) / 2 frequencies, up to sign, that n joints can give.
    """
    rng = np.random.default_rng([joints, seed])
    model = _empty(f"random arm of {joints} joints", joints)
    for i in range(joints):
        place = pin.SE3(pin.Quaternion(_unit(rng, 4)).matrix(), LENGTH * _unit(rng, 3))
        joint = pin.JointModelRevoluteUnaligned(_unit(rng, 3))
        _add_link(model, i, joint, place, _unit(rng, 3))
    return _loaded(model)


def planar_chain(joints: int) -> Robot:
    """Equal rods with parallel horizontal axes; its symmetry group has order 2^(n + 1)."""
    model = _empty(f"planar chain of {joints} joints", joints)
    for i in range(joints):
        place = pin.SE3(np.eye(3), np.array([LENGTH if i else 0.0, 0.0, 0.0]))
        _add_link(model, i, pin.JointModelRY(), place, np.array([1.0, 0.0, 0.0]))
    return _loaded(model)


def _empty(name: str, joints: int) -> pin.Model:
    model = pin.Model()
    model.name = name
    model.gravity.linear = np.array([0.0, 0.0, -9.81])
    return model


def _add_link(
    model: pin.Model, parent: int, joint: pin.JointModel, place: pin.SE3, along: np.ndarray
) -> None:
    """Add a rod that points along a unit vector of its joint's frame."""
    centre = pin.SE3(np.eye(3), 0.5 * LENGTH * along)
    crosswise = np.eye(3) - np.outer(along, along)
    rod = pin.Inertia(MASS, np.zeros(3), MASS * LENGTH**2 / 12 * (crosswise + 1e-2 * np.eye(3)))
    index = model.addJoint(parent, joint, place, f"joint{parent + 1}")
    model.appendBodyToJoint(index, rod, centre)


def _loaded(model: pin.Model) -> Robot:
    model.lowerPositionLimit = np.full(model.nq, -np.pi)
    model.upperPositionLimit = np.full(model.nq, np.pi)
    return load_robot(model)


def _unit(rng: np.random.Generator, n: int) -> np.ndarray:
    x = rng.normal(size=n)
    return x / np.linalg.norm(x)
