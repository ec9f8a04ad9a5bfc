import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.learned_symmetries import Knowledge
from isotorque.symbolic.common.angles import wrap
from isotorque.verify.testing.strategies import known_arms
from tests.learning.static_data import (
    known_potential,
    recording,
    same_group,
    stable_samples,
    with_angle_noise,
    worst_torque_error,
)


@given(
    known_arms(min_joints=2, max_joints=4, planted=None),
    st.integers(0, 2**32 - 1),
    st.integers(1, 5),
    st.booleans(),
)
@settings(max_examples=30)
def test_learned_relations_are_a_subgroup_of_the_true_group(arm, seed, torques, scattered):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    if scattered:
        q = rng.uniform(-np.pi, np.pi, (int(rng.integers(1, 40)), potential.n))
        tau = potential.gradient(q)
    else:
        q, tau = recording(potential, arm.group, rng, torques, smallest_share=0.0)
    learned = learn_relations(q, tau)
    scale = potential.gradient_bound().max()
    assert learned.group.is_closed
    assert arm.group.order % learned.order == 0 or learned.group.rank < arm.group.rank
    for relation in learned.group:
        assert worst_torque_error(relation, potential, rng).max() < 1e-5 * scale


@pytest.mark.parametrize(("name", "torques"), [("2r", 6), ("3r", 4), ("ur5", 4)])
def test_every_relation_says_how_it_is_known(name, torques):
    potential, group = known_potential(name)
    rng = np.random.default_rng(1)
    q, tau = recording(potential, group, rng, torques, smallest_share=0.0)
    learned = learn_relations(q, tau)
    assert same_group(learned.group, group, 1e-9)
    assert learned.missing is None
    assert learned.contradicted == ()
    known = [r.known for r in learned.relations]
    assert known.count(Knowledge.OBSERVED) >= group.order // 2
    for relation in learned.relations:
        if relation.known is Knowledge.OBSERVED:
            assert relation.support >= 2
            assert relation.p_value > 1e-4
        assert np.isfinite(relation.relation.bound).all()


def test_half_a_degree_of_noise_with_unknown_level():
    for name, torques in (("2r", 12), ("3r", 8)):
        potential, group = known_potential(name)
        for seed in range(3):
            rng = np.random.default_rng(seed)
            q, tau = recording(potential, group, rng, torques)
            learned = learn_relations(with_angle_noise(q, 0.5, rng), tau)
            assert same_group(learned.group, group, np.deg2rad(0.2))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "torques", "degrees", "least"),
    [("2r", 6, 0.0, 100), ("3r", 4, 0.0, 100), ("2r", 12, 0.5, 95), ("3r", 8, 0.5, 95)],
)
def test_a_hundred_seeds(name, torques, degrees, least):
    potential, group = known_potential(name)
    right = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        q, tau = recording(potential, group, rng, torques)
        learned = learn_relations(with_angle_noise(q, degrees, rng), tau)
        right += same_group(learned.group, group, np.deg2rad(0.2) if degrees else 1e-9)
    assert right >= least


def test_stable_data_show_some_relations_and_identify_the_others():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(2)
    q, tau = [], []
    for start, torque in zip(*stable_samples(potential, rng, 8), strict=True):
        images = group.orbit(start)
        stiffness = np.linalg.eigvalsh(potential.hessian(images)).min(axis=1)
        q.append(wrap(images[stiffness > 0]))
        tau.append(group.torques(torque)[stiffness > 0])
    learned = learn_relations(np.concatenate(q), np.concatenate(tau))
    known = [r.known for r in learned.relations if not r.relation.is_identity]
    assert same_group(learned.group, group, 1e-9)
    assert known.count(Knowledge.OBSERVED) == 1
    assert known.count(Knowledge.IDENTIFIED) == 6


def test_pairs_alone_speak_where_no_potential_can_be_fitted():
    # torques of a spring-loaded arm: odd and even symmetries hold, gravity explains nothing
    rng = np.random.default_rng(3)
    base = rng.uniform(-1.5, 1.5, (30, 1))
    q = np.concatenate([base, -base])
    learned = learn_relations(q, np.concatenate([base**3 + 1.0, base**3 + 1.0]))
    assert learned.order == 2
    pair = next(r for r in learned.relations if not r.relation.is_identity)
    assert pair.known is Knowledge.OBSERVED
    assert np.isnan(pair.relation.bound).all()
    assert learned.missing is not None


def test_a_recording_of_another_robot_gives_that_robots_relations():
    potential, group = known_potential("2r")
    tilted = potential + type(potential)([[1, 0], [1, 1]], [4.0, -2.0], [0.0, 0.0])
    rng = np.random.default_rng(4)
    q, tau = stable_samples(tilted, rng, 20)
    learned = learn_relations(q, tau)
    for relation in learned.group:
        assert worst_torque_error(relation, tilted, rng).max() < 1e-6
    assert not same_group(learned.group, group, 1e-3)


def test_nothing_is_claimed_from_nothing():
    potential, _group = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(5), 3)
    learned = learn_relations(q, tau)
    assert learned.order == 1
    assert "3 more samples" in learned.missing
    assert "for pairing" in learned.missing
