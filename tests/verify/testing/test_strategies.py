"""The strategies draw what they promise: legal robots, true relations, certain lies."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from isotorque.verify.relations.exact_proof import prove_relation
from isotorque.verify.testing import strategies
from isotorque.verify.testing.pinocchio_models import pinocchio_model

FEW = settings(
    max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


@FEW
@given(strategies.quarter_turns() | strategies.generic_rotations())
def test_rotations_are_rotations(rotation):
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(rotation) > 0


def test_quarter_turns_are_the_24_of_a_cube():
    found = {tuple(matrix.ravel().tolist()) for matrix in strategies._CUBE}
    assert len(found) == 24
    assert np.array_equal(strategies._CUBE[0], np.eye(3))


@FEW
@given(strategies.kinematic_trees(1, 5))
def test_trees_are_trees(tree):
    assert 1 <= tree.n <= 5
    assert all(-1 <= parent < i for i, parent in enumerate(tree.parents))
    assert np.allclose(np.linalg.norm(tree.axes, axis=1), 1.0)
    assert np.all(tree.masses >= 0)
    assert np.linalg.norm(tree.gravity) == pytest.approx(9.81)


@FEW
@given(st.data())
def test_a_model_has_the_gravity_torque_of_its_tree(data):
    """Virtual work: g_i is minus the power of the weights per unit of joint speed."""
    tree = data.draw(strategies.kinematic_trees(1, 4))
    model = pinocchio_model(tree)
    q = data.draw(strategies.configurations(tree.n))
    expected = pin.computeGeneralizedGravity(model, model.createData(), q)
    turning = pinocchio_model(tree, continuous=True)
    pairs = np.ravel(np.column_stack([np.cos(q), np.sin(q)]))
    again = pin.computeGeneralizedGravity(turning, turning.createData(), pairs)
    assert np.allclose(again, expected, atol=1e-11)
    places: list[tuple[np.ndarray, np.ndarray]] = []
    for i in range(tree.n):
        parent = tree.parents[i]
        rotation, origin = places[parent] if parent >= 0 else (np.eye(3), np.zeros(3))
        origin = origin + rotation @ tree.translations[i]
        turn = pin.exp3(tree.axes[i] * q[i])
        places.append((rotation @ tree.rotations[i] @ turn, origin))
    torque = np.zeros(tree.n)
    for link in range(tree.n):
        rotation, origin = places[link]
        centre = origin + rotation @ tree.levers[link]
        joint = link
        while joint >= 0:
            axis = places[joint][0] @ tree.axes[joint]
            motion = np.cross(axis, centre - places[joint][1])
            torque[joint] -= tree.masses[link] * tree.gravity @ motion
            joint = tree.parents[joint]
    assert np.allclose(torque, expected, atol=1e-11)


@FEW
@given(strategies.robots(1, 3))
def test_robots_have_one_angle_per_joint(robot):
    assert robot.model.nq == robot.model.nv == robot.n
    assert robot.limits.shape == (robot.n, 2)


def test_joints_are_limited_or_continuous_as_asked():
    for continuous, size in ((True, 4), (False, 2)):
        models = drawn(strategies.models(2, 2, continuous=continuous), 5)
        assert {model.nq for model in models} == {size}
        assert {model.nv for model in models} == {2}


@FEW
@given(st.data())
def test_relations_are_true_and_lies_are_lies(data):
    arm = data.draw(strategies.known_arms(1, 3))
    true = data.draw(strategies.relations(arm.group))
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, arm.gravity.n))
    size = np.abs(arm.gravity.torque(q)).max() + 1e-300
    assert np.allclose(
        arm.gravity.torque(true.configuration(q)),
        true.torque(arm.gravity.torque(q)),
        atol=1e-12 * max(size, 1.0),
    )
    lie = data.draw(strategies.lies(arm.group, arm.active))
    assert not prove_relation(lie.A, lie.d, lie.Y, arm.gravity.potential).holds


def test_every_planted_arm_has_a_symmetry_and_some_generic_arm_has_none():
    # axes along frame directions: the first active ones are level, and half a turn of them flips g
    planted, generic = (
        [arm.group.order for arm in drawn(strategies.known_arms(2, 3, planted=kind), 25)]
        for kind in (True, False)
    )
    assert min(planted) >= 2
    assert min(generic) == 1


def drawn(strategy, count):
    """Return drawn values, the same each time."""
    found = []

    @settings(FEW, max_examples=count, phases=[Phase.generate], database=None)
    @given(strategy)
    def collect(value):
        found.append(value)

    collect()
    return found
