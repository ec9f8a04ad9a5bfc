"""Identifiability counts, and standard errors where samples leave torques open."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape, columns_of
from isotorque.learning.learners.rigid.planning.information import (
    Information,
    identifiable_count,
    parameter_mask,
    probe_poses,
)
from tests.learning.learners.rigid.random_chains import random_chain, random_poses

COUNTS = {
    "random": lambda n: 4 * n - 1,
    "all parallel": lambda n: 4 * n - 2,
    "vertical": lambda n: 4 * n - 3,
    "parallel": lambda n: 2 * n,
}


def brute_rank(chain, q):
    """Rank of the derivatives by all nine numbers of every rotation and all three of levers."""
    n, step = chain.n, 1e-6
    columns = []
    directions = np.tile(np.eye(3)[None], (n, 1, 1))
    for pair in ((0, 1), (1, 2)):
        slopes = chain.derivatives(q, np.ascontiguousarray(directions[:, pair, :]))
        columns += [slopes.turned, slopes.leant]
    del step
    return np.linalg.matrix_rank(np.concatenate(columns, 2).reshape(q.size, -1), tol=1e-9)


@given(n=st.integers(3, 8), kind=st.sampled_from(sorted(COUNTS)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_counts_are_those_of_the_theory(n, kind, seed):
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n, "random" if kind == "all parallel" else kind)
    if kind == "all parallel":  # in a direction that is not horizontal
        rotations = np.tile(np.eye(3), (n, 1, 1))
        rotations[0] = chain.rotations[0]
        chain = type(chain).of(rotations, chain.levers)
    count = identifiable_count(chain, parameter_mask(n))
    assert count == COUNTS[kind](n)
    assert count == brute_rank(chain, random_poses(rng, 40, n))


@pytest.mark.parametrize("n", range(2, 9))
def test_gains_and_offsets_add_their_numbers(n):
    chain = random_chain(np.random.default_rng(n), n)
    offsets = type(chain).of(
        chain.rotations,
        chain.levers,
        columns=columns_of(n, ColumnShape.OFFSET),
        coefficients=np.zeros(n),
    )
    assert identifiable_count(offsets, parameter_mask(n, columns=n)) == 5 * n - 1
    mask = parameter_mask(n, free_gains=np.ones(n, bool), columns=n)
    assert identifiable_count(offsets, mask) == 6 * n - 2


@given(n=st.integers(1, 6), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_torques_that_samples_leave_open_have_infinite_errors(n, seed):
    """One pose tells nothing elsewhere; forty tell everything, to some multiple of the noise."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n)
    whitening = np.tile(np.eye(n), (40, 1, 1))
    q = random_poses(rng, 40, n)
    everything = Information.of(chain, q, whitening, parameter_mask(n))
    assert np.all(everything.standard_error(chain, probe_poses(n)) < 5.0)
    same = np.repeat(q[:1], 40, axis=0)
    one = Information.of(chain, same, whitening, parameter_mask(n))
    assert one.rank <= n
    assert np.isinf(one.standard_error(chain, q[1:])).mean() > 0.5
    assert np.isfinite(one.standard_error(chain, same)).all()
    assert (
        np.abs(
            one.null_space
            @ chain.derivatives(same, np.tile([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], (n, 1, 1)))
            .by_parameters()[:, :, parameter_mask(n)]
            .reshape(-1, 4 * n)
            .T
        ).max()
        < 1e-6
    )


def test_linear_errors_are_those_of_least_squares():
    """Against the textbook formula on a design of full rank."""
    rng = np.random.default_rng(3)
    chain = random_chain(rng, 1)
    q = random_poses(rng, 9, 1)
    mask = np.array([False, False, True, True, False])  # the levers of one joint: linear
    found = Information.of(chain, q, np.tile(2.0 * np.eye(1), (9, 1, 1)), mask)
    design = chain.derivatives(q, np.tile([[0.0, 1, 0], [1, 0, 0]], (1, 1, 1))).leant[:, 0]
    covariance = np.linalg.inv(design.T @ design) / 4.0
    expected = np.sqrt(np.einsum("ki,ij,kj->k", design, covariance, design))
    np.testing.assert_allclose(found.standard_error(chain, q)[:, 0], expected, rtol=1e-9)
