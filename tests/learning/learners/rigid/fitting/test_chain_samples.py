"""Samples as the search wants them."""

import numpy as np

from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.compiled_fit import levenberg_marquardt
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from tests.learning.learners.rigid.random_chains import random_poses


def test_rows_of_any_layout_become_rows_one_after_the_other():
    q, none = np.asfortranarray(np.arange(6.0).reshape(3, 2)), np.zeros(2)
    samples = ChainSamples(q, 2.0 * q, none, none, np.ones(3))
    for one in (samples, samples.part([0, 2])):
        assert one.q.flags.c_contiguous
        assert one.torque.flags.c_contiguous
        np.testing.assert_array_equal(one.torque, 2.0 * one.q)


def test_the_search_is_compiled_once_whatever_the_layout():
    q = random_poses(np.random.default_rng(0), 8, 2)
    lower = 6.0 * np.cos(q.sum(axis=1))
    torque = np.stack([18.0 * np.cos(q[:, 0]) + lower, lower], axis=1)
    one = RigidChain().fit(q, torque)
    compiled = len(levenberg_marquardt.signatures)
    two = RigidChain().fit(np.asfortranarray(q), np.asfortranarray(torque))
    assert len(levenberg_marquardt.signatures) == compiled
    np.testing.assert_array_equal(one.predict(q), two.predict(q))
