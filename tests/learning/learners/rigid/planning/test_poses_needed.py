"""As many poses as determine a chain of any kind, and one equation more, to check it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape, columns_of
from isotorque.learning.learners.rigid.planning.information import (
    identifiable_count,
    parameter_mask,
)
from isotorque.learning.learners.rigid.planning.poses_needed import most_parameters, poses_needed
from tests.learning.learners.rigid.random_chains import random_chain


@given(st.integers(1, 8), st.booleans(), st.booleans())
def test_equations_exceed_parameters_and_one_pose_less_leaves_nothing_to_check(n, gains, offsets):
    columns = columns_of(n, ColumnShape.OFFSET) if offsets else ()
    model = ChainModel(np.arange(-1, n - 1), np.ones(n), np.full(n, gains), columns)
    poses = poses_needed(model)
    assert n * poses > most_parameters(model)
    assert n * (poses - 1) <= most_parameters(model)


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_no_chain_has_more_parameters(n, seed):
    model = ChainModel(np.arange(-1, n - 1), np.ones(n), np.zeros(n, bool), ())
    chain = random_chain(np.random.default_rng(seed), n)
    assert identifiable_count(chain, parameter_mask(n)) <= most_parameters(model)
