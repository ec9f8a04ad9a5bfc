"""Torque and derivatives against the definition, differences, and gravity of real trees."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
    torques_of,
)
from isotorque.learning.learners.rigid.fitting.compiled_fit import turn
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape, JointColumn
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import kinematic_trees
from tests.learning.learners.rigid.random_chains import KINDS, chain_of_tree, random_chain

STEP = 1e-6


@st.composite
def chains(draw, max_joints=5):
    """Chains and trees of every kind, with gains, offsets and springs."""
    n = draw(st.integers(1, max_joints))
    parents = [draw(st.integers(-1, j - 1)) for j in range(n)] if draw(st.booleans()) else None
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    chain = random_chain(rng, n, draw(st.sampled_from(KINDS)), parents)
    columns = (JointColumn(0, ColumnShape.OFFSET), JointColumn(n - 1, ColumnShape.SPRING))
    return replace(
        chain, gains=rng.uniform(0.5, 2, n), columns=columns, coefficients=rng.normal(size=2)
    ), rng


@given(tree=kinematic_trees(max_joints=6), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=60)
def test_every_tree_of_revolute_joints_is_a_chain(tree, seed):
    """The statement behind it all: geometry and masses matter through the levers alone."""
    gravity = GravityModel(tree)
    q = np.random.default_rng(seed).uniform(-4, 4, (5, tree.n))
    expected = gravity.torque(q)
    found = chain_of_tree(tree).torque(q)
    assert np.abs(found - expected).max() < 1e-11 * max(1.0, np.abs(expected).max())


def test_built_in_arms_are_chains():
    for name in ("2r", "3r", "4r-planar", "ur5", "panda"):
        robot = load_robot(name)
        q = np.random.default_rng(0).uniform(-4, 4, (20, robot.n))
        expected = GravityModel(robot).torque(q)
        assert np.abs(chain_of_tree(robot.tree).torque(q) - expected).max() < 1e-12 * 100


@given(chains(), st.integers(1, 4))
@settings(max_examples=30)
def test_torques_of_several_chains_are_those_of_each(case, count):
    chain, rng = case
    q = rng.uniform(-4, 4, (5, chain.n))
    several = []
    for _ in range(count):
        other = random_chain(rng, chain.n, "random", [int(p) for p in chain.parents])
        gains, coefficients = rng.uniform(0.5, 2, chain.n), rng.normal(size=2)
        several.append(
            replace(other, gains=gains, columns=chain.columns, coefficients=coefficients)
        )
    found = torques_of(several, q)
    assert found.shape == (count, 5, chain.n)
    for torque, one in zip(found, several, strict=True):
        np.testing.assert_allclose(torque, one.torque(q), rtol=1e-13, atol=1e-13)
        plain = replace(one, columns=(), coefficients=np.zeros(0), gains=np.ones(chain.n))
        own = one.gains * plain.torque(q)  # and what the columns add
        own[:, 0] += one.coefficients[0]
        own[:, -1] += one.coefficients[1] * q[:, -1]
        np.testing.assert_allclose(torque, own, atol=1e-12)


@given(chains())
@settings(max_examples=60)
def test_derivatives_are_those_of_differences(case):
    chain, rng = case
    n, q = chain.n, rng.uniform(-4, 4, (3, chain.n))
    directions = rng.normal(size=(n, 2, 3))
    slopes = chain.derivatives(q, directions)
    np.testing.assert_allclose(slopes.torque, chain.torque(q), atol=1e-12)

    def difference(change):
        return (change(STEP).torque(q) - change(-STEP).torque(q)) / (2 * STEP)

    for b in range(2 * n):
        unit = np.zeros(2 * n)
        unit[b] = 1.0
        turned = difference(
            lambda x, u=unit: replace(chain, rotations=turn(chain.rotations, directions, x * u))
        )
        leant = difference(lambda x, u=unit: chain.with_levers(chain.levers + x * u.reshape(n, 2)))
        assert np.abs(slopes.turned[:, :, b] - turned).max() < 1e-6
        assert np.abs(slopes.leant[:, :, b] - leant).max() < 1e-6
    for j in range(n):
        unit = np.eye(n)[j]
        gained = difference(lambda x, u=unit: replace(chain, gains=chain.gains + x * u))
        assert np.abs(slopes.gained[:, :, j] - gained).max() < 1e-6
        moved = (chain.torque(q + STEP * unit) - chain.torque(q - STEP * unit)) / (2 * STEP)
        assert np.abs(slopes.stiffness[:, :, j] - moved).max() < 1e-6
    for c in range(2):
        unit = np.eye(2)[c]
        added = difference(
            lambda x, u=unit: replace(chain, coefficients=chain.coefficients + x * u)
        )
        assert np.abs(slopes.added[:, :, c] - added).max() < 1e-6


@given(chains())
@settings(max_examples=30)
def test_true_stiffness_is_symmetric(case):
    """The torque of gravity has a potential."""
    chain, rng = case
    K = (
        chain.true_chain()
        .derivatives(rng.uniform(-4, 4, (3, chain.n)), raw_directions(chain.n))
        .stiffness
    )
    assert np.abs(K - K.transpose(0, 2, 1)).max() < 1e-12 * 1e3


def test_arrays_make_the_same_chain():
    rng = np.random.default_rng(0)
    chain = replace(
        random_chain(rng, 3),
        columns=(JointColumn(1, ColumnShape.SPRING),),
        coefficients=np.array([0.3]),
    )
    back = ChainParameters.from_arrays(chain.to_arrays())
    q = rng.normal(size=(4, 3))
    np.testing.assert_array_equal(back.torque(q), chain.torque(q))
