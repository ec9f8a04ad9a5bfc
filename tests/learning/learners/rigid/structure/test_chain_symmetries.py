"""The group of a fitted chain equals the derived one; bounds hold for the measured arm."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.strategies import kinematic_trees
from tests.learning.learners.rigid.random_chains import chain_of_tree, random_poses


def same_group(one, two):
    return one.order == two.order and all(relation in two for relation in one)


@given(tree=kinematic_trees(max_joints=5), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_the_group_from_exact_samples_is_the_derived_one(tree, seed):
    """Any tree: symmetries follow from a handful of poses, the kinematics unknown."""
    gravity = GravityModel(tree)
    q = random_poses(np.random.default_rng(seed), 4 * tree.n // tree.n + 6, tree.n)
    torque = gravity.torque(q)
    learner = RigidChain(parents=[int(p) for p in tree.parents]).fit(q, torque)
    assert learner.verdict_.accepted
    if np.abs(torque).max() < 1e-9:
        return
    found = learner.symmetries().group
    assert same_group(found, primary_symmetries(gravity.potential))
    for relation in found:
        error = gravity.torque(relation.configuration(q)) - relation.Y * torque
        assert np.all(np.abs(error).max(axis=0) <= relation.bound + 1e-12)


@pytest.mark.parametrize("name", ["2r", "3r", "ur5", "panda"])
def test_bounds_hold_in_noise(name):
    gravity = GravityModel(load_robot(name))
    exact = primary_symmetries(gravity.potential).order
    orders, claims, false = [], 0, 0
    test = random_poses(np.random.default_rng(99), 300, gravity.n)
    truth = gravity.torque(test)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        q = random_poses(rng, 30, gravity.n)
        torque = gravity.torque(q) + 0.05 * rng.normal(size=q.shape)
        found = RigidChain(torque_noise=0.05).fit(q, torque).symmetries()
        orders.append(found.group.order)
        assert "do not contradict" in found.statement
        for relation in found.group:
            error = np.abs(gravity.torque(relation.configuration(test)) - relation.Y * truth)
            claims += 1
            false += bool(np.any(error.max(axis=0) > relation.bound + 1e-12))
    assert false == 0
    assert claims > len(orders)
    assert sum(order >= exact for order in orders) >= 5


def test_relations_of_a_biased_sensor_carry_a_correction():
    """The constants of its joints: found, and right of the torque that it shows."""
    gravity = GravityModel(load_robot("3r"))
    offsets = np.array([1.0, -0.5, 0.2])
    q = random_poses(np.random.default_rng(0), 12, 3)
    learner = RigidChain(unknown_offsets=True).fit(q, gravity.torque(q) + offsets)
    found = learner.symmetries()
    assert found.group.order == 16
    np.testing.assert_allclose(found.correction.constant, offsets, atol=1e-8)
    for relation in found.group:
        measured = gravity.torque(relation.configuration(q)) + offsets
        corrected = relation.of_measured(found.correction)
        expected = corrected.torque(gravity.torque(q) + offsets, q)
        np.testing.assert_allclose(measured, expected, atol=1e-7)
    assert RigidChain().fit(q, gravity.torque(q)).symmetries().correction is None


def test_a_tolerance_adds_relations_that_nearly_hold():
    """The panda: order 2 exactly, 4 within a tenth of a newton metre, still bounded."""
    gravity = GravityModel(load_robot("panda"))
    q = random_poses(np.random.default_rng(0), 12, 7)
    learner = RigidChain().fit(q, gravity.torque(q))
    assert learner.symmetries().group.order == 2
    near = learner.symmetries(tolerance=0.1).group
    assert near.order == 4
    test = random_poses(np.random.default_rng(1), 300, 7)
    for relation in near:
        error = gravity.torque(relation.configuration(test)) - relation.Y * gravity.torque(test)
        assert np.all(np.abs(error).max(axis=0) <= relation.bound + 1e-9)
        assert relation.bound.max() < 0.1


def test_bounds_hold_for_arms_that_are_not_as_special_as_they_look():
    """A lever hidden in the noise is set to zero: relations are false of the arm by twice that."""
    plain = chain_of_tree(load_robot("2r").tree)
    small = int(np.argmin(np.abs(plain.levers[1])))
    test = random_poses(np.random.default_rng(99), 300, 2)
    claims, false, wrong, exceeded = 0, 0, 0, 0
    for seed in range(14):
        rng = np.random.default_rng(seed)
        levers = plain.levers.copy()
        levers[1, small] += 0.03 * rng.choice([-1, 1])  # two standard errors
        arm = plain.with_levers(levers)
        q = random_poses(rng, 25, 2)
        torque = arm.torque(q) + 0.05 * rng.normal(size=q.shape)
        found = RigidChain(torque_noise=0.05).fit(q, torque).symmetries()
        here = arm.torque(test)
        for relation, of_gravity in zip(found.group, found.gravity_bounds, strict=True):
            error = np.abs(arm.torque(relation.configuration(test)) - relation.Y * here)
            claims += 1
            wrong += bool(error.max() > 0.05)
            exceeded += bool(np.any(error.max(axis=0) > of_gravity + 1e-12))
            false += bool(np.any(error.max(axis=0) > relation.bound + 1e-12))
    assert claims > 50
    assert wrong > 10  # and these are claims that are off
    assert false <= 0.01 * claims
    assert exceeded <= 0.01 * claims  # the arm is rigid
