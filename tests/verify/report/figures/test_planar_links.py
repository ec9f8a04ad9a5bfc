"""Stick figures of planar arms stand where the joints are; other arms have none."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.report.figures.level_sets import planar_chain
from isotorque.verify.report.figures.planar_links import planar_links


@pytest.mark.parametrize(("name", "n"), [("2r", 2), ("4r-planar", 4)])
def test_planar_arms(name, n):
    robot = load_robot(name)
    q = np.random.default_rng(0).uniform(-3, 3, (20, n))
    links = planar_links(robot.model, q)
    assert links.shape == (20, n + 1, 2)
    lengths = np.linalg.norm(np.diff(links[0], axis=0), axis=1)
    assert np.allclose(links, planar_chain(q, lengths), atol=1e-12)


def test_a_pendulum_has_one_link():
    assert planar_links(load_robot("pendulum").model, [[0.3]]).shape == (1, 2, 2)


def test_arms_that_leave_the_plane_have_none():
    robot = load_robot("3r")
    assert planar_links(robot.model, np.zeros((1, 3))) is None
    assert planar_links(load_robot("ur5").model, np.zeros((1, 6))) is None


def test_without_gravity_there_is_no_up():
    model = load_robot("2r").model.copy()
    model.gravity = pin.Motion.Zero()
    assert planar_links(model, np.zeros((1, 2))) is None
