"""Stability is judged on what gravity acts on, and nowhere else."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.verify.models.stability import has_stable_image, is_stable


def test_a_pendulum_is_stable_below(arms):
    q = np.linspace(-3.0, 3.0, 61)[:, None]
    assert np.array_equal(is_stable(q, arms["pendulum"].gravity), np.sin(q[:, 0]) < 0)


def test_a_free_joint_needs_no_stiffness(upright):
    q = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    assert np.array_equal(is_stable(q, GravityModel(upright)), np.sin(q[:, 1]) < 0)


def test_only_the_combination_that_gravity_feels_counts():
    # two parallel joints on one axis: the torque depends on q1 + q2 alone
    tree = KinematicTree(
        joint_names=("a", "b"),
        parents=(-1, 0),
        rotations=np.array([np.eye(3)] * 2),
        translations=np.zeros((2, 3)),
        axes=np.array([[0.0, -1.0, 0.0]] * 2),
        masses=np.array([0.0, 1.0]),
        levers=np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]),
        gravity=np.array([0.0, 0.0, -9.81]),
    )
    q = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    assert np.array_equal(is_stable(q, GravityModel(tree)), np.sin(q.sum(axis=1)) < 0)


def test_without_gravity_every_configuration_holds(upright):
    level = KinematicTree(
        upright.joint_names,
        upright.parents,
        upright.rotations,
        upright.translations,
        np.array([[0.0, 0.0, 1.0]] * 2),
        upright.masses,
        upright.levers,
        upright.gravity,
    )
    assert is_stable(np.zeros((3, 2)), GravityModel(level)).all()


def test_an_orbit_with_a_stable_member_is_known_by_any_member(arms):
    arm = arms["3r"]
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (50, 3))
    found = has_stable_image(q, arm.gravity, arm.group)
    for relation in arm.group:
        image = has_stable_image(relation.configuration(q), arm.gravity, arm.group)
        assert np.array_equal(image, found)
    assert found.any()
    assert not found.all()
