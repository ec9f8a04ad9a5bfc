"""Lattices within limits: inside, evenly, one configuration per orbit, exact in number."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import Settled
from isotorque.learning.sampling.reachable_lattice import (
    reachable_lattice,
    turned_into,
    visit,
    within,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import close
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

ARM = close(
    [
        SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1]),
        SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1]),
    ]
)


@st.composite
def boxes(draw):
    low = draw(st.tuples(*[st.floats(-6.0, 2.0)] * 2))
    width = draw(st.tuples(*[st.floats(1.0, 8.0)] * 2))
    return np.array([[a, a + w] for a, w in zip(low, width, strict=True)])


@given(boxes(), st.integers(1, 60), st.integers(0, 10**6), st.sampled_from([None, ARM]))
@settings(max_examples=40, deadline=None)
def test_all_points_lie_within_limits(limits, count, seed, group):
    home = limits.mean(axis=1)
    found = reachable_lattice(group, limits, count, home, np.random.default_rng(seed))
    assert len(found.q) == count
    assert ((found.q > limits[:, 0]) & (found.q < limits[:, 1])).all()
    assert 0 < found.reachable <= 1
    again = reachable_lattice(group, limits, count, home, np.random.default_rng(seed))
    np.testing.assert_array_equal(found.q, again.q)
    if group is not None and count > 1:  # no two points of one orbit
        found = FundamentalDomain(group).representatives(found.q).q
        gaps = np.linalg.norm(found[:, None] - found[None], axis=2)
        assert gaps[~np.eye(count, dtype=bool)].min() > 1e-9


@given(boxes())
@settings(max_examples=30, deadline=None)
def test_the_reachable_share_is_that_of_random_orbits(limits):
    found = reachable_lattice(ARM, limits, 5, limits.mean(axis=1), np.random.default_rng(0))
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (4000, 2))
    reached = np.zeros(len(q), dtype=bool)
    for relation in ARM:
        image = relation.configuration(q)
        for turns in np.ndindex(7, 7):  # by brute force
            moved = image + 2 * np.pi * (np.array(turns) - 3)
            reached |= ((moved > limits[:, 0]) & (moved < limits[:, 1])).all(axis=1)
    assert found.reachable == pytest.approx(reached.mean(), abs=0.05)


def test_a_full_turn_of_limits_reaches_everything():
    limits = np.tile([-np.pi, np.pi], (2, 1)) * 1.001
    found = reachable_lattice(ARM, limits, 16, [0.1, 0.2], np.random.default_rng(0))
    assert found.reachable == 1.0


def test_what_comes_first_is_spread_evenly_too():
    found = reachable_lattice(None, [[-3.0, 3.0]] * 2, 400, [0, 0], np.random.default_rng(0))
    quadrant = (found.q[:100] > 0) @ [1, 2]
    assert np.bincount(quadrant.astype(int), minlength=4).min() > 12


def test_angles_are_turned_into_their_limits():
    limits = np.array([[0.0, 3.7]])
    assert turned_into(np.array([[3.5 - 2 * np.pi]]), limits) == pytest.approx(3.5)
    assert within(np.array([[3.5 - 2 * np.pi], [-1.0]]), limits).tolist() == [True, False]


def test_nothing_within_limits_is_refused():
    slit = np.array([[0.5, 0.5 + 3e-6], [0.5, 0.5 + 3e-6]])
    with pytest.raises(InputError, match="admissible"):
        reachable_lattice(ARM, slit, 5, [0.5, 0.5], np.random.default_rng(0))


def test_an_arm_without_gravity_is_refused():
    still = close([SymmetryRelation(np.eye(1), [0.0], [1], np.zeros((0, 1), dtype=int))])
    with pytest.raises(InputError, match="depends on"):
        reachable_lattice(still, [[-1, 1]], 5, [0.0], np.random.default_rng(0))


def test_every_place_is_visited_before_the_next():
    class Arm:
        log = ()

        def place(self, q):
            self.q = q
            self.log += (("place", *q),)

        def hold(self):
            self.log += (("hold",),)
            return Settled(self.q, 2 * self.q, 0.0)

    arm = Arm()
    held = [outcome.torque.tolist() for outcome in visit(arm, np.array([[1.0], [2.0]]))]
    assert held == [[2.0], [4.0]]
    assert arm.log == (("place", 1.0), ("hold",), ("place", 2.0), ("hold",))
