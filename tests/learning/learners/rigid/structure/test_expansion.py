"""The expanded potential has the chain's torque as its gradient, and gravity's terms."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.structure.expansion import expanded
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import (
    KINDS,
    chain_of_tree,
    random_chain,
    random_poses,
)


@given(
    n=st.integers(1, 6),
    kind=st.sampled_from(KINDS),
    forks=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=40)
def test_its_gradient_is_the_torque(n, kind, forks, seed):
    rng = np.random.default_rng(seed)
    parents = [int(rng.integers(-1, j)) for j in range(n)] if forks else None
    chain = random_chain(rng, n, kind, parents)
    q = random_poses(rng, 6, n)
    assert np.abs(expanded(chain).gradient(q) - chain.torque(q)).max() < 1e-11 * 50


def test_terms_are_those_of_the_derived_potential():
    for name in ("2r", "3r", "ur5", "panda"):
        robot = load_robot(name)
        derived = GravityModel(robot).potential.to_float().significant(1e-11)
        found = expanded(chain_of_tree(robot.tree)).significant(1e-11)
        assert {tuple(k) for k in found.frequencies} == {tuple(k) for k in derived.frequencies}
        np.testing.assert_allclose(
            np.sort(found.amplitudes()), np.sort(derived.amplitudes()), atol=1e-11
        )
