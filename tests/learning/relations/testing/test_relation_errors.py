"""Errors of given relations are at least and at most what is said; nothing is said without data."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.testing.relation_errors import relation_errors
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

ROUNDING = 1e-6
FLIP = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
TURN = SymmetryRelation([[1, 0], [0, 1]], [np.pi, 0], [-1, -1])
WRONG = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
EVERYWHERE = np.random.default_rng(99).uniform(-np.pi, np.pi, (4000, 2))


def torque(q, lever=0.0):
    """A 2R, with a lever across its second link that breaks its symmetries."""
    lower = 6.1 * np.cos(q[:, 0] + q[:, 1]) + lever * np.sin(q[:, 0] + q[:, 1])
    return np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)


def missed(relation, lever, constant=0.0):
    """Largest error of each joint over (nearly) all configurations."""
    there = torque(relation.configuration(EVERYWHERE), lever) + constant
    return np.abs(there - relation.Y * (torque(EVERYWHERE, lever) + constant)).max(axis=0)


def samples(seed, count, noise, lever=0.0, constant=0.0):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.5, 2.5, (count, 2))
    return q, torque(q, lever) + constant + noise * rng.normal(size=q.shape)


@settings(max_examples=25)
@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.02, 0.1]),
    st.integers(15, 40),
    st.sampled_from([0.0, 0.3, 2.0]),
    st.sampled_from([FLIP, TURN, WRONG]),
)
def test_the_true_error_lies_between_least_and_most(seed, noise, count, lever, relation):
    (found,) = relation_errors([relation], *samples(seed, count, noise, lever))
    true = missed(relation, lever)
    assert found[0].means
    for errors in found:
        assert (errors.least <= true + ROUNDING).all()
        assert (errors.seen <= true + ROUNDING).all()
        assert (errors.beside >= 0.97 * true - ROUNDING).all()  # 4000 places do not hold the worst
        assert (errors.most >= 0.9 * true - ROUNDING).all()


@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_a_relation_that_is_wrong_by_far_is_so_at_the_place_given(seed):
    (found,) = relation_errors([WRONG], *samples(seed, 25, 0.02))
    for errors in found:
        joint = int(np.argmax(errors.least))
        assert errors.least[joint] > 5.0
        q = errors.where[joint][None]
        miss = torque(WRONG.configuration(q)) - WRONG.Y * torque(q)
        assert abs(miss[0, joint]) >= errors.least[joint]


@settings(max_examples=4)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.02]))
def test_constants_count_unless_the_claim_corrects_them(seed, noise):
    constant = np.array([0.0, 0.8])
    data = samples(seed, 30, noise, constant=constant)
    (plain,) = relation_errors([TURN], *data)
    found = relation_errors([TURN.of_measured(Correction(c)) for c in (constant, -constant)], *data)
    corrected, opposite = found
    true = missed(TURN, 0.0, constant)[1]
    assert true == pytest.approx(1.6)
    for errors in plain:
        assert errors.seen[1] <= true + ROUNDING
        assert errors.most[1] >= true - ROUNDING
        assert errors.estimate[1] == pytest.approx(true, rel=0.1)
    for errors in corrected:
        assert errors.most[1] < 0.4
        assert errors.estimate[1] < 0.2
    for errors in opposite:
        assert errors.estimate[1] == pytest.approx(3.2, rel=0.1)
        assert errors.most[1] >= 3.2 - 0.05


def test_many_joints_are_told_by_a_chain():
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (15, 4))
    angles = np.cumsum(q, axis=1)
    parts = np.cos(angles) * [20.0, 12.0, 6.0, 2.0]
    tau = np.cumsum(parts[:, ::-1], axis=1)[:, ::-1]
    turn = SymmetryRelation(np.eye(4), [np.pi, 0, 0, 0], -np.ones(4))
    wrong = SymmetryRelation(np.eye(4), [0, np.pi, 0, 0], -np.ones(4))
    good, bad = relation_errors([turn, wrong], q, tau)
    assert [errors.means for errors in good] == ["a rigid chain"]
    assert good[0].most.max() < 1e-5
    assert bad[0].least.max() > 10.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda q, tau: (q[:3], tau[:3]), "more"),
        (lambda q, tau: (q, tau + 3.0 * np.sin(2.0 * q)), "a cable"),
        (lambda q, tau: (np.rad2deg(q), tau), "if the angles are in degrees"),
        (lambda q, tau: (q * [1.0, 0.0], torque(q * [1.0, 0.0])), "joint 2 moved"),
    ],
)
def test_nothing_is_said_without_samples_that_tell(change, words):
    q, tau = change(*samples(0, 30, 0.0))
    (found,) = relation_errors([FLIP], q, tau)
    assert len(found) == 1
    assert found[0].means == ""
    assert words in found[0].missing
    assert np.isnan(found[0].most).all()


def test_springs_break_relations_unless_they_are_taken_off():
    q, tau = samples(0, 30, 0.02)
    spring = Correction([0.0, 0.0], [0.0, 3.0])
    plain, corrected = relation_errors([FLIP, FLIP.of_measured(spring)], q, tau + spring.at(q))
    (by_chain,) = plain  # waves have no term for it
    assert by_chain.means == "a rigid chain"
    assert by_chain.least[1] > 5.0
    assert by_chain.most[1] > by_chain.estimate[1] > 5.0
    for errors in corrected:
        assert errors.most.max() < 0.5


def test_relations_of_other_arms_are_refused():
    q, tau = samples(0, 10, 0.0)
    with pytest.raises(InputError, match="number of joints"):
        relation_errors([SymmetryRelation(np.eye(3), np.zeros(3), np.ones(3))], q, tau)
