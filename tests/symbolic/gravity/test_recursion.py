import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.gravity.recursion import GravityChain
from isotorque.symbolic.robots.kinematic_tree import planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees


@given(kinematic_trees(max_joints=6), st.data())
@settings(max_examples=60)
def test_recursion_equals_the_normal_form(tree, data):
    q = data.draw(configurations(tree.n, turns=3.0))
    U, chain = derive_potential(tree), GravityChain.of(tree)
    scale = max(U.gradient_bound().max(initial=0.0), 1e-3)
    np.testing.assert_allclose(chain.torque(q), U.gradient(q), rtol=0, atol=1e-12 * scale)
    np.testing.assert_allclose(chain.stiffness(q), U.hessian(q), rtol=0, atol=1e-12 * scale)


@given(kinematic_trees(max_joints=5))
@settings(max_examples=40)
def test_frames_are_rotations_with_the_promised_zeros(tree):
    chain = GravityChain.of(tree)
    for rotation in chain.rotations:
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(rotation) > 0
    # nearly parallel axes take another x axis, all others lie across both
    across = np.hypot(chain.rotations[:, 0, 2], chain.rotations[:, 1, 2]) > 0.1
    assert np.all(chain.rotations[across, 2, 0] == 0)
    assert np.all(chain.moments[:, 2] == 0)


@given(kinematic_trees(max_joints=4, planted=True, branched=True))
@settings(max_examples=40)
def test_axis_aligned_arms_keep_exact_zeros_and_ones(tree):
    entries = np.abs(GravityChain.of(tree).rotations)
    assert np.all((entries == 0) | (entries == 1))


def test_axes_barely_apart_lose_no_accuracy():
    """A twist of 1e-9 rad is neither parallel nor a good plane."""
    tree = load_robot("2r").tree
    for angle in (1e-15, 1e-9, 1e-4, 0.0999, 0.1001):
        c, s = np.cos(angle), np.sin(angle)
        tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        tilted = dataclasses.replace(tree, rotations=np.array([np.eye(3), tilt]))
        q = np.random.default_rng(0).normal(size=(20, 2))
        expected = derive_potential(tilted).gradient(q)
        np.testing.assert_allclose(GravityChain.of(tilted).torque(q), expected, atol=1e-13)


def test_exact_rationals_and_numeric_sympy_entries_are_numbers():
    tree = load_robot("3r").tree
    q = [0.1, 0.2, 0.3]
    expected = GravityChain.of(tree).torque(q)
    np.testing.assert_array_equal(GravityChain.of(tree.exact()).torque(q), expected)
    values = {"m1": 5, "m2": 5, "l1": 0.25, "c1": 0.125, "c2": 0.125, "g": 9.81}
    planar = GravityChain.of(planar_arm(2).substitute(values))
    torque = GravityChain.of(load_robot("2r").tree).torque([0.4, 0.5])
    np.testing.assert_allclose(planar.torque([0.4, 0.5]), torque, rtol=1e-14)


def test_symbols_are_refused_by_name():
    with pytest.raises(InputError, match="an entry of translations is l1; accepted: a number"):
        GravityChain.of(planar_arm(2))
