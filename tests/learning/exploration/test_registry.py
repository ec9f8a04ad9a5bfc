"""Explorations by name, and the arm that is guided within its limits."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.exploration.exploration import Exploration
from isotorque.learning.exploration.guided_arm import LimitedGuidedArm
from isotorque.learning.exploration.registry import (
    EXPLORATIONS,
    GUIDED_DIRECTIONS,
    exploration_by_name,
)
from isotorque.learning.exploration.strategies import GuidedDirectionSampling
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import close
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

GROUP = close([SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1])])


@pytest.mark.parametrize("name", [*EXPLORATIONS, GUIDED_DIRECTIONS])
@pytest.mark.parametrize("domain", [None, FundamentalDomain(GROUP)], ids=["anywhere", "domain"])
def test_every_name_makes_another_exploration(name, domain):
    made = exploration_by_name(
        name,
        None,
        None,
        np.random.default_rng(0),
        domain=domain,
        seen=np.array([[-1.0, 0.5], [1.0, 2.0]]),
        torque_range=[1.0, 2.0],
        static_torques=None,
    )
    assert isinstance(made, Exploration)
    assert isinstance(made, GuidedDirectionSampling) == (name == GUIDED_DIRECTIONS)
    if name == "goal-babbling":
        goals = made._goals
        assert len(np.unique(goals, axis=0)) == len(goals) == 64
        if domain is None:
            assert goals.min(axis=0) == pytest.approx([-1.0, 0.5], abs=0.3)
            assert (goals >= [-1.0, 0.5]).all()
            assert (goals <= [1.0, 2.0]).all()
        else:
            assert domain.contains(goals).all()


def test_another_name_is_refused():
    with pytest.raises(InputError, match="motor-babbling"):
        exploration_by_name(
            "parrot", None, None, np.random.default_rng(0), domain=None, seen=np.zeros((1, 2))
        )


@given(
    st.lists(st.floats(-20, 20), min_size=3, max_size=3),
    st.lists(st.tuples(st.floats(-6, 3), st.floats(0.1, 12)), min_size=3, max_size=3),
)
def test_an_arm_is_guided_to_the_nearest_place_within_limits(q, sides):
    limits = np.array([[low, low + width] for low, width in sides])
    places = []
    LimitedGuidedArm(SimpleNamespace(place=places.append), limits).place(q)
    (place,) = places
    assert ((place > limits[:, 0]) & (place < limits[:, 1])).all()
    for angle, asked, (low, high) in zip(place, q, limits, strict=True):
        grid = np.linspace(low, high, 2001)  # by brute force, on the circle
        nearest = np.abs(wrap(grid - asked)).min()
        assert abs(wrap(angle - asked)) <= nearest + 1e-2
