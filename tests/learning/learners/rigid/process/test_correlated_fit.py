"""Generalised least squares of a chain against other ways to the same minimum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.fitting.chain_parameters import raw_directions
from isotorque.learning.learners.rigid.fitting.chain_search import stepped
from isotorque.learning.learners.rigid.planning.information import parameter_mask
from isotorque.learning.learners.rigid.process.correlated_fit import (
    CorrelatedSamples,
    correlated_fit,
)
from tests.learning.learners.rigid.random_chains import random_chain, random_poses


def correlated(seed, joints=3, count=15, noise=0.1):
    """A chain, and samples with errors that are correlated from pose to pose."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, joints)
    q = random_poses(rng, count, joints)
    mixed = rng.normal(size=(joints, count, count)) / np.sqrt(count) + np.eye(count)
    factor = np.linalg.cholesky(noise**2 * mixed @ mixed.transpose(0, 2, 1))
    error = np.einsum("jab,jb->aj", factor, rng.normal(size=(joints, count)))
    samples = CorrelatedSamples(q, chain.torque(q) + error, np.linalg.inv(factor))
    return chain, samples


def moved(chain, seed, size=0.03):
    """The chain after a small step along all parameters but gains."""
    step = size * np.random.default_rng(seed).normal(size=5 * chain.n)
    step[4 * chain.n :] = 0.0
    return stepped(chain, raw_directions(chain.n), step)


@given(st.integers(0, 10_000))
@settings(max_examples=10)
def test_it_ends_where_no_direction_lowers_the_cost(seed):
    chain, samples = correlated(seed)
    free = parameter_mask(3)
    found, cost = correlated_fit(samples, moved(chain, seed), free)
    assert cost == pytest.approx(samples.cost(found), rel=1e-9)
    assert cost < samples.cost(chain)
    rest = samples.whitened(samples.torque - found.torque(samples.q))
    slope = samples.design(found, free)
    size = np.linalg.norm(slope, axis=0) + 1e-12
    assert np.abs(slope.T @ rest / size).max() < 0.05 * np.sqrt(cost)


def test_the_cost_is_that_of_the_joint_covariance():
    """All errors of all joints in one vector, its covariance inverted as a whole."""
    chain, samples = correlated(1)
    error = (samples.torque - chain.torque(samples.q)).T.ravel()
    m, n = samples.q.shape
    covariance = np.zeros((m * n, m * n))
    for j, W in enumerate(samples.whitening):
        covariance[j * m : (j + 1) * m, j * m : (j + 1) * m] = np.linalg.inv(W.T @ W)
    assert samples.cost(chain) == pytest.approx(error @ np.linalg.solve(covariance, error))


def test_a_part_has_the_covariance_of_these_samples():
    _, samples = correlated(2)
    rows = np.arange(15) % 3 > 0
    part = samples.part(rows)
    whole = np.linalg.inv(samples.whitening.transpose(0, 2, 1) @ samples.whitening)
    here = np.linalg.inv(part.whitening.transpose(0, 2, 1) @ part.whitening)
    np.testing.assert_allclose(here, whole[:, rows][:, :, rows], rtol=1e-8)


def test_correlations_that_are_known_make_the_chain_better():
    """Errors common to all poses of a joint are told apart from its torque."""
    better = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        chain = random_chain(rng, 3)
        q = random_poses(rng, 20, 3)
        covariance = 0.01**2 * np.eye(20) + 0.5**2 * np.ones((20, 20))
        factor = np.linalg.cholesky(covariance)
        torque = chain.torque(q) + np.einsum("ab,bj->aj", factor, rng.normal(size=(20, 3)))
        known = CorrelatedSamples(q, torque, np.tile(np.linalg.inv(factor), (3, 1, 1)))
        ignored = CorrelatedSamples(q, torque, np.tile(np.eye(20), (3, 1, 1)))
        fresh = random_poses(rng, 200, 3)
        errors = []
        for samples in (known, ignored):
            found, _ = correlated_fit(samples, moved(chain, seed), parameter_mask(3))
            errors.append(np.sqrt(np.mean((found.torque(fresh) - chain.torque(fresh)) ** 2)))
        better += errors[0] < 0.5 * errors[1]
    assert better >= 7
