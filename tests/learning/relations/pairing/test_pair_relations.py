import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.learned_symmetries import Knowledge
from isotorque.learning.relations.pairing.pair_relations import pair_relations
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.verify.testing.strategies import known_arms
from tests.learning.static_data import (
    false_relations,
    known_potential,
    recording,
    same_group,
    stable_samples,
    with_angle_noise,
    worst_torque_error,
)


@given(known_arms(min_joints=2, max_joints=2), st.integers(0, 2**32 - 1), st.integers(1, 6))
@settings(max_examples=25)
def test_paired_relations_of_random_arms_are_true(arm, seed, torques):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    if len(arm.active) < 2:
        return
    q, tau = recording(potential, arm.group, rng, torques, smallest_share=0.0)
    learned = pair_relations(q, tau)
    scale = potential.gradient_bound().max()
    for relation in learned.group:
        assert worst_torque_error(relation, potential, rng).max() < 1e-5 * scale


@pytest.mark.parametrize(("name", "torques"), [("2r", 6), ("3r", 4), ("4r-planar", 3)])
def test_exact_recordings_give_the_whole_group(name, torques):
    potential, group = known_potential(name)
    for seed in range({"2r": 10, "3r": 2, "4r-planar": 1}[name]):
        q, tau = recording(potential, group, np.random.default_rng(seed), torques)
        learned = pair_relations(q, tau)
        assert learned.missing is None
        assert same_group(learned.group, group, 1e-9)
        for known in learned.relations:
            if known.relation.is_identity:
                continue
            assert known.known in (Knowledge.OBSERVED, Knowledge.IMPLIED)
            assert (known.known is Knowledge.OBSERVED) == (known.support >= 2)
            if known.regression is not None:
                np.testing.assert_allclose(known.regression.A, known.relation.A, atol=1e-6)
                assert np.abs(wrap(known.regression.d - known.relation.d)).max() < 1e-6


@pytest.mark.parametrize(("name", "torques"), [("2r", 12), ("3r", 8)])
def test_half_a_degree_of_noise(name, torques):
    potential, group = known_potential(name)
    noise = MeasurementNoise(np.deg2rad(0.5), 0.0)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        q, tau = recording(potential, group, rng, torques)
        learned = pair_relations(with_angle_noise(q, 0.5, rng), tau, noise=noise)
        assert same_group(learned.group, group, np.deg2rad(0.2))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "torques", "degrees", "seeds", "least"),
    [
        ("2r", 6, 0.0, 100, 98),
        ("3r", 4, 0.0, 100, 98),
        ("2r", 12, 0.5, 100, 95),
        ("3r", 8, 0.5, 100, 95),
    ],
)
def test_a_hundred_seeds(name, torques, degrees, seeds, least):
    potential, group = known_potential(name)
    right = false = claimed = 0
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        q, tau = recording(potential, group, rng, torques)
        learned = pair_relations(with_angle_noise(q, degrees, rng), tau)
        right += same_group(learned.group, group, np.deg2rad(0.2) if degrees else 1e-9)
        false += len(false_relations(learned.group, group, 0.05))
        claimed += learned.order
    assert right >= least
    assert false <= 0.01 * claimed


def test_stable_recordings_show_the_relations_between_stable_configurations():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = [], []
    for start, torque in zip(*stable_samples(potential, rng, 12), strict=True):
        images = group.orbit(start)
        stiffness = np.linalg.eigvalsh(potential.hessian(images)).min(axis=1)
        q.append(wrap(images[stiffness > 0]))
        tau.append(group.torques(torque)[stiffness > 0])
    learned = pair_relations(np.concatenate(q), np.concatenate(tau))
    assert learned.order == 2
    assert not false_relations(learned.group, group, 1e-9)


@pytest.mark.parametrize("jitter", [0.0, 2e-5])
def test_a_pose_that_was_recorded_often_is_one_configuration(jitter):
    potential, group = known_potential("2r")
    rng = np.random.default_rng(6)
    q, tau = recording(potential, group, rng, 6)
    order = rng.permutation(np.repeat(np.arange(len(q)), 12))
    rows, torques = q[order] + jitter * rng.uniform(-1.0, 1.0, (len(order), 2)), tau[order]
    noise = MeasurementNoise(2e-5, 0.0) if jitter else None
    once, often = pair_relations(q, tau, noise=noise), pair_relations(rows, torques, noise=noise)
    assert same_group(often.group, once.group, 1e-3)
    evidence = {r.relation.Y.tobytes() + r.relation.A.tobytes(): r for r in once.relations}
    for relation in often.relations:
        known = evidence[relation.relation.Y.tobytes() + relation.relation.A.tobytes()]
        assert relation.support == known.support
    # and two configurations are two, however often they were seen
    few = pair_relations(np.repeat(q[:2], 50, axis=0), np.repeat(tau[:2], 50, axis=0))
    assert few.missing == pair_relations(q[:2], tau[:2]).missing


def test_secondary_pairs_are_rejected_and_reported():
    potential, group = known_potential("2r")
    q, tau = recording(potential, group, np.random.default_rng(3), 8, kept=(0.9, 0.9))
    learned = pair_relations(q, tau)
    assert same_group(learned.group, group, 1e-9)
    assert learned.rejected
    for kind in learned.rejected:
        images = np.array([learned.group.orbit(x) for x in kind.q_r])
        signs = (learned.group.Y == kind.Y).all(axis=1)
        off = np.abs(wrap(images[:, signs] - kind.q_s[:, None])).max(axis=2, initial=0.0)
        assert (off > 1e-6).all()


def test_free_joints_are_left_out():
    potential, group = known_potential("ur5")
    q, tau = recording(potential, group, np.random.default_rng(4), 4, smallest_share=0.0)
    learned = pair_relations(q, tau)
    assert learned.group.rank == 3
    assert same_group(learned.group, group, 1e-9)


def test_a_joint_that_only_hung_is_not_called_free():
    first = np.random.default_rng(5).uniform(-1.4, 1.4, 10)
    first = np.concatenate([first, -first, np.pi - first])
    q = np.stack([first, -np.pi / 2 - first], axis=1)
    tau = np.stack([18.0 * np.cos(first), np.zeros(30)], axis=1)
    learned = pair_relations(q, tau)
    assert learned.order == 1
    assert "joint 2" in learned.missing


def test_what_is_missing_is_said():
    potential, group = known_potential("2r")
    q, tau = recording(potential, group, np.random.default_rng(6), 2, kept=(0.9, 0.9))
    assert pair_relations(q, tau).missing.startswith("1 more torques")
    one = np.abs(tau) == np.abs(tau[0])
    assert pair_relations(q[one.all(axis=1)], tau[one.all(axis=1)]).missing.startswith("2 more")
    assert "all given torques are zero" in pair_relations(q, 0.0 * tau).missing
    spread, loads = stable_samples(potential, np.random.default_rng(7), 30)
    assert pair_relations(spread, loads).missing.startswith("more configurations")
    zero = np.where(np.arange(len(tau))[:, None] % 2 == 0, tau, tau * [1.0, 0.0])
    assert "too near to zero" in pair_relations(q, zero).missing
    same = pair_relations(np.tile(q[0], (9, 1)), np.tile(tau[0], (9, 1)))
    assert same.order == 1
    assert same.missing is not None


def test_random_configurations_show_no_relation():
    rng = np.random.default_rng(8)
    for seed in range(5):
        tau = np.repeat(rng.uniform(1.0, 2.0, (8, 2)), 8, axis=0)
        tau *= rng.choice([-1.0, 1.0], tau.shape)
        learned = pair_relations(rng.uniform(-np.pi, np.pi, tau.shape), tau)
        assert learned.order == 1, seed
        assert "chance" in learned.missing


def test_bad_arrays_are_refused():
    with pytest.raises(InputError, match="shape of tau"):
        pair_relations(np.zeros((3, 2)), np.zeros((2, 2)))
