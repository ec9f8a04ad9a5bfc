import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.pairing.a_contrario_test import accepted_relations
from isotorque.learning.relations.pairing.hough_transform import (
    Tolerance,
    _windows,
    voted_relations,
)
from isotorque.learning.relations.pairing.torque_pairs import Pairs
from isotorque.symbolic.common.angles import wrap


def planted_pairs(rng, A, d, *, torques, true_pairs, random_pairs, sigma):
    """Pairs of which some obey q_s = A q_r + d and the others are random."""
    n = len(d)
    count = torques * (true_pairs + random_pairs)
    q_r = rng.uniform(-np.pi, np.pi, (count, n))
    q_s = rng.uniform(-np.pi, np.pi, (count, n))
    torque = np.repeat(np.arange(torques), true_pairs + random_pairs)
    true = np.arange(count) % (true_pairs + random_pairs) < true_pairs
    q_s[true] = wrap(q_r[true] @ A.T + d + sigma * rng.normal(size=(true.sum(), n)))
    q_r = wrap(q_r + sigma * rng.normal(size=q_r.shape))
    index = np.arange(count)
    return Pairs(np.ones(n), index, index + count, q_r, q_s, torque), true


integer_maps = st.sampled_from(
    [
        np.array(m).reshape(2, 2)
        for m in itertools.product(range(-2, 3), repeat=4)
        if abs(m[0] * m[3] - m[1] * m[2]) == 1
    ]
)


@given(integer_maps, st.integers(0, 2**32 - 1), st.sampled_from([1e-8, 2e-3, 9e-3]))
@settings(max_examples=40)
def test_a_planted_relation_is_voted_for_and_accepted(A, seed, sigma):
    rng = np.random.default_rng(seed)
    d = rng.uniform(-np.pi, np.pi, 2)
    pairs, true = planted_pairs(rng, A, d, torques=10, true_pairs=2, random_pairs=8, sigma=sigma)
    tolerance = Tolerance(sigma)
    voted = voted_relations(pairs, 10, tolerance, 3, 2)
    accepted = accepted_relations(pairs, voted, 10, tolerance, 3, 24)
    assert len(accepted) == 1
    assert (accepted[0].A == A).all()
    assert np.abs(wrap(accepted[0].d - d)).max() < 3.0 * sigma * np.sqrt(1 + (A**2).sum())
    assert accepted[0].torques >= 9
    best = voted[0]
    assert (best.inliers & true).sum() >= 0.9 * true.sum()


@pytest.mark.parametrize("sigma", [1e-6, 2e-3, 9e-3, 2e-2])
def test_random_pairs_show_nothing(sigma):
    tolerance = Tolerance(sigma)
    for seed in range(15):
        pairs, _ = planted_pairs(
            np.random.default_rng(seed),
            np.eye(2),
            np.zeros(2),
            torques=12,
            true_pairs=0,
            random_pairs=12,
            sigma=sigma,
        )
        voted = voted_relations(pairs, 12, tolerance, 3, 2)
        assert accepted_relations(pairs, voted, 12, tolerance, 3, 24) == []


def test_a_pair_that_drifts_with_the_torque_is_not_a_relation():
    # a secondary pair: nearly linear, but its offset moves by some degrees from torque to torque
    rng = np.random.default_rng(0)
    sigma = np.deg2rad(0.5)
    pairs, _ = planted_pairs(
        rng, -np.eye(2), np.zeros(2), torques=12, true_pairs=3, random_pairs=6, sigma=sigma
    )
    drift = np.deg2rad(rng.uniform(-12.0, 12.0, (12, 2)))
    pairs = Pairs(
        pairs.Y, pairs.r, pairs.s, pairs.q_r, pairs.q_s + drift[pairs.torque], pairs.torque
    )
    tolerance = Tolerance(sigma)
    voted = voted_relations(pairs, 12, tolerance, 3, 2)
    assert accepted_relations(pairs, voted, 12, tolerance, 3, 24) == []


def test_one_torque_alone_never_makes_a_relation():
    pairs, _ = planted_pairs(
        np.random.default_rng(1),
        -np.eye(2),
        np.ones(2),
        torques=1,
        true_pairs=40,
        random_pairs=0,
        sigma=1e-8,
    )
    assert voted_relations(pairs, 1, Tolerance(1e-8), 2, 2) == []


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.floats(0.01, 3.0))
def test_windows_count_what_brute_force_counts(seed, count, width):
    rng = np.random.default_rng(seed)
    q_r, q_s = rng.uniform(-9, 9, (count, 1)), rng.uniform(-9, 9, count)
    torque = rng.integers(0, 4, count)
    rows = np.array([[1]])
    _, centre, votes = _windows(q_r, q_s, torque, 4, rows, np.array([width]), 2, 1)
    phase = (q_s - q_r[:, 0]) % (2 * np.pi)
    best = 0
    for start in phase:
        inside = (phase - start) % (2 * np.pi) <= 2 * width
        if len(np.unique(torque[inside])) >= 2:
            best = max(best, int(inside.sum()))
    if best == 0:
        assert len(votes) == 0
    else:
        assert abs(votes[0] - best) <= 1  # rounding at a window's edge
        near = np.abs(wrap(phase - centre[0])) <= 2 * width + 1e-9
        assert near.sum() >= votes[0]
