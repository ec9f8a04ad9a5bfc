"""Tests of the choice among equivalent domains."""

import numpy as np
import pytest

from isotorque.learning.exploration.central_domain import central_domain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


@pytest.fixture(scope="module")
def planar():
    gravity = GravityModel(load_robot("2r"))
    return gravity, primary_symmetries(gravity.potential)


def stable(gravity, count, seed):
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 2))
    return q[np.linalg.eigvalsh(gravity.stiffness(q)).min(axis=1) > 0]


@pytest.mark.parametrize("seed", range(5))
def test_takes_the_stable_cell_away_from_the_limits(planar, seed):
    """Two cells of the 2R arm are stable; one of them borders on q1 = -pi."""
    gravity, group = planar
    settled = stable(gravity, 300, seed)
    seen = np.vstack([settled, [[-np.pi, 0.0], [np.pi, 0.0], [0.0, np.pi], [0.0, -np.pi]]])
    domain = central_domain(group, settled, seen)
    assert np.abs(domain.center - [-np.pi / 4, -np.pi / 4]).max() < 0.3
    inside = domain.sample(np.random.default_rng(seed), 100)
    assert (np.linalg.eigvalsh(gravity.stiffness(inside)).min(axis=1) > -1e-6).all()


def test_full_turns_of_what_was_seen_are_followed(planar):
    """An arm with angles around 2 pi explores there."""
    gravity, group = planar
    settled = stable(gravity, 300, 0) + np.array([2 * np.pi, 0.0])
    domain = central_domain(group, settled, settled)
    assert settled[:, 0].min() < domain.center[0] < settled[:, 0].max()


def test_prefers_a_cell_where_the_arm_settles(planar):
    """Samples in one cell only: that one, however near its limits."""
    gravity, group = planar
    settled = stable(gravity, 600, 1)
    settled = settled[settled[:, 0] < -np.pi / 2]
    seen = np.vstack([settled, [[np.pi, np.pi], [-np.pi, -np.pi]]])
    domain = central_domain(group, settled, seen)
    assert domain.contains(settled).mean() > 0.9
