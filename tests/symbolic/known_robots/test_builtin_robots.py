"""The built-in robots: the paper's two arms and a few known ones."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.robots.test_load_robot import FILES, error_beyond_bound, gravity
from tests.symbolic.robots.urdf.urdf_strategies import angles

NAMES = [robot.name for robot in builtin_robots()]


@pytest.mark.parametrize("name", NAMES)
def test_built_in_robots_need_no_snapping_and_equal_their_files(name):
    robot = load_robot(name)
    assert (robot.name, robot.model.name, robot.snaps) == (name, name, ())
    assert error_beyond_bound(robot, np.random.default_rng(0)) < 1e-14
    assert load_robot(FILES / f"{name}.urdf").digest == robot.digest
    theirs = pin.buildModelFromUrdf(str(FILES / f"{name}.urdf"))
    assert robot.source_model.nq == theirs.nq == robot.n
    assert next(row for row in builtin_robots() if row.name == name).joints == robot.n
    assert not np.any(robot.damping)


@pytest.mark.parametrize("name", NAMES)
def test_built_in_robots_can_be_simulated_anywhere(name):
    robot = load_robot(name)
    data = robot.model.createData()
    for q in np.random.default_rng(0).uniform(-np.pi, np.pi, (200, robot.n)):
        mass_matrix = pin.crba(robot.model, data, q)
        mass_matrix = np.triu(mass_matrix) + np.triu(mass_matrix, 1).T
        assert np.linalg.eigvalsh(mass_matrix)[0] > 1e-4


@pytest.mark.parametrize(
    ("name", "order", "rank", "terms"),
    [
        ("pendulum", 4, 1, 1),
        ("2r", 8, 2, 2),
        ("3r", 16, 3, 4),
        ("4r-planar", 32, 4, 4),
        ("ur5", 16, 3, 3),
        ("panda", 2, 6, 189),
    ],
)
def test_symmetries_of_the_built_in_robots(name, order, rank, terms):
    potential = derive_potential(load_robot(name).tree)
    group = primary_symmetries(potential)
    assert (group.order, group.rank, len(potential.frequencies)) == (order, rank, terms)


@given(st.tuples(angles, angles))
def test_the_2r_is_the_papers(q):
    a, b = 5 * 9.81 * 0.375, 5 * 9.81 * 0.125  # 18.39 and 6.13 Nm
    expected = [a * np.cos(q[0]) + b * np.cos(q[0] + q[1]), b * np.cos(q[0] + q[1])]
    np.testing.assert_allclose(gravity(load_robot("2r").model, np.array(q)), expected, atol=1e-13)


@given(st.tuples(angles, angles, angles))
def test_the_3r_is_the_papers(q):
    a = 5 * 9.81 * 0.25  # 12.26 Nm, for upper arm and forearm alike
    c1, s1, s2, s23 = np.cos(q[0]), np.sin(q[0]), np.sin(q[1]), np.sin(q[1] + q[2])
    c2, c23 = np.cos(q[1]), np.cos(q[1] + q[2])
    expected = a * np.array([-s1 * (s2 + s23), c1 * (c2 + c23), c1 * c23])
    np.testing.assert_allclose(gravity(load_robot("3r").model, np.array(q)), expected, atol=1e-13)


def test_the_largest_torques_are_the_papers():
    """24.5 and 6.2 Nm for the 2R; 24.4, 24.2 and 12.4 Nm for the 3R, read off its figures."""
    q = np.linspace(-np.pi, np.pi, 73)
    for name, published in (("2r", (24.5, 6.2)), ("3r", (24.4, 24.2, 12.4))):
        model = load_robot(name).model
        data = model.createData()
        grid = np.stack(np.meshgrid(*[q[:: len(published)]] * model.nq), -1).reshape(-1, model.nq)
        torques = [np.abs(pin.computeGeneralizedGravity(model, data, row)).copy() for row in grid]
        np.testing.assert_allclose(np.max(torques, axis=0), published, rtol=0.015)


def test_limits_of_the_panda_are_the_manufacturers():
    np.testing.assert_array_equal(load_robot("panda").limits[3], [-3.0718, -0.0698])
