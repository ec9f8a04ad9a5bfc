import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.identification.chain_identification import identify_by_chain
from isotorque.learning.relations.identification.identify import identify
from isotorque.learning.relations.identification.wave_identification import identify_by_waves
from isotorque.learning.relations.learned_symmetries import Knowledge
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
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

seeds = st.integers(0, 2**32 - 1)


@given(known_arms(min_joints=1, max_joints=3, planted=None), seeds, st.integers(1, 45))
@settings(max_examples=60)
def test_identified_relations_of_random_arms_are_true(arm, seed, count):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, potential.n))
    learned = identify(q, potential.gradient(q))
    scale = potential.gradient_bound().max()
    for relation in learned.group:
        assert worst_torque_error(relation, potential, rng).max() < 1e-6 * scale
    assert learned.group.is_closed
    if learned.missing is None:
        assert learned.order == arm.group.order
        assert learned.group.rank == arm.group.rank


@given(known_arms(min_joints=1, max_joints=3, planted=None), seeds, st.floats(0.01, 1.0))
@settings(max_examples=30)
def test_with_noise_the_stated_bounds_hold(arm, seed, degrees):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (int(rng.integers(10, 60)), potential.n))
    learned = identify(with_angle_noise(q, degrees, rng), potential.gradient(q))
    scale = potential.gradient_bound().max()
    for relation in learned.group:
        error = worst_torque_error(relation, potential, rng)
        assert (error <= 1.3 * relation.bound + 1e-6 * scale).all()


@pytest.mark.parametrize("by", [identify, identify_by_waves])
@pytest.mark.parametrize(("name", "count"), [("pendulum", 4), ("2r", 6), ("3r", 10)])
def test_few_stable_samples_give_the_whole_group(name, count, by):
    potential, group = known_potential(name)
    for seed in range(10):
        learned = by(*stable_samples(potential, np.random.default_rng(seed), count))
        assert learned.missing is None
        assert same_group(learned.group, group, 1e-9)
        assert all(r.known is Knowledge.IDENTIFIED for r in learned.relations)


@pytest.mark.parametrize(("name", "count"), [("4r-planar", 22), ("ur5", 10)])
def test_larger_arms_need_more_samples(name, count):
    potential, group = known_potential(name)
    for seed in range(2):
        q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, potential.n))
        assert same_group(identify(q, potential.gradient(q)).group, group, 1e-9)


@pytest.mark.parametrize(("name", "count"), [("2r", 20), ("3r", 60)])
def test_noise_of_a_tenth_degree(name, count):
    potential, group = known_potential(name)
    for seed in range(8):  # a hundred in the slow run
        rng = np.random.default_rng(seed)
        q, tau = stable_samples(potential, rng, count)
        learned = identify(with_angle_noise(q, 0.1, rng), tau)
        assert same_group(learned.group, group, np.deg2rad(0.2))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count", "degrees", "least"),
    [("2r", 6, 0.0, 100), ("3r", 10, 0.0, 100), ("2r", 20, 0.1, 98), ("3r", 60, 0.1, 98)],
)
def test_a_hundred_seeds_without_a_false_relation(name, count, degrees, least):
    potential, group = known_potential(name)
    whole = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        q, tau = stable_samples(potential, rng, count)
        learned = identify(with_angle_noise(q, degrees, rng), tau)
        assert not false_relations(learned.group, group, np.deg2rad(0.5))
        whole += learned.order == group.order
    assert whole >= least


def test_measured_offsets_stay_where_rounding_is_not_wanted():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = stable_samples(potential, rng, 20)
    noisy = with_angle_noise(q, 0.1, rng)
    rounded, measured = identify(noisy, tau), identify(noisy, tau, snap=False)
    assert all(r.snapped for r in rounded.relations)
    assert not any(r.snapped for r in measured.relations)
    assert same_group(rounded.group, group, 1e-12)
    assert not same_group(measured.group, group, 1e-9)
    assert measured.group.is_closed
    for learned in measured.relations:
        off = min(
            np.abs(np.angle(np.exp(1j * (learned.relation.d_sat - true.d_sat)))).max()
            for true in group
        )
        assert off <= 5.0 * learned.standard_error.max() + 1e-12


def test_an_arm_with_offset_masses_gets_its_own_smaller_group():
    tilted = TrigonometricPolynomial([[1, 0], [1, 1], [0, 1]], [3.0, 1.0, 0.5], [18.0, 6.0, 0.7])
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (8, 2))
    learned = identify(q, tilted.gradient(q))
    assert learned.missing is None
    assert learned.order < 8
    for relation in learned.group:
        assert worst_torque_error(relation, tilted, np.random.default_rng(0)).max() < 1e-9


def test_where_motions_ended_is_not_noise():
    # settled samples are off by next to nothing, but where the arm is soft, and all one way
    potential, _ = known_potential("2r")
    for seed in range(20):
        phase = np.random.default_rng(seed).uniform(-np.pi / 2 - 1.4, -np.pi / 2 + 1.4, (100, 2))
        q = np.stack([phase[:, 0], phase[:, 1] - phase[:, 0]], axis=1)
        tau = potential.gradient(q)
        tau[np.argsort(q[:, 0])[:8]] += 5e-10
        assert identify(q, tau).order == 8


def test_a_slightly_broken_symmetry_is_not_claimed_when_the_data_show_it():
    potential, _ = known_potential("2r")
    broken = potential + TrigonometricPolynomial([[0, 1]], [0.2], [0.0])
    rng = np.random.default_rng(2)
    q, tau = stable_samples(broken, rng, 60)
    learned = identify(with_angle_noise(q, 0.05, rng), tau)
    assert learned.order < 8


def test_free_joints_are_left_alone():
    potential, _group = known_potential("ur5")
    q = np.random.default_rng(3).uniform(-np.pi, np.pi, (12, 6))
    learned = identify(q, potential.gradient(q))
    assert learned.group.rank == 3
    for relation in learned.group:
        assert (relation.A[[0, 4, 5]] == np.eye(6)[[0, 4, 5]]).all()
        assert (relation.d[[0, 4, 5]] == 0.0).all()


def test_a_joint_that_never_moved_is_reported_with_the_relations():
    potential, group = known_potential("ur5")
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (12, 6))
    q[:, 5] = 0.3
    learned = identify_by_waves(q, potential.gradient(q))
    assert learned.order == group.order
    assert "joint 6" in learned.missing
    # a chain needs no motion of it: a lever would have been felt while others turned it about
    by_chain = identify(q, potential.gradient(q))
    assert same_group(by_chain.group, group, 1e-9)
    assert by_chain.missing is None


def test_known_noise_is_used():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(5)
    q, tau = stable_samples(potential, rng, 12)
    noise = MeasurementNoise(np.deg2rad(0.1), 0.0)
    learned = identify(with_angle_noise(q, 0.1, rng), tau, noise=noise)
    assert same_group(learned.group, group, 0.01)
    far_too_much = identify(q, tau, noise=MeasurementNoise(0.5, 0.0))
    assert far_too_much.order == 1
    assert "more samples" in far_too_much.missing


def test_what_is_missing_is_said():
    potential, _ = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(0), 6)
    cases = {
        "3 more samples: 3 different": (q[:3], tau[:3]),
        "5 more samples: 1 different": (np.tile(q[0], (9, 1)), np.tile(tau[0], (9, 1))),
        "samples with a torque": (q[:0], tau[:0]),
        "all given torques are zero": (q, 0.0 * tau),
    }
    for words, (angles, torques) in cases.items():
        learned = identify(angles, torques)
        assert words in learned.missing
        assert learned.order == 1


def test_torques_that_gravity_cannot_explain_are_not_symmetric():
    rng = np.random.default_rng(6)
    q = rng.uniform(-np.pi, np.pi, (60, 2))
    learned = identify(q, 5.0 * q + rng.normal(size=q.shape))
    assert learned.order == 1
    assert learned.missing is not None


def test_bad_arrays_are_refused():
    with pytest.raises(InputError, match="shape of q"):
        identify(np.zeros(3), np.zeros(3))
    with pytest.raises(InputError, match="shape of tau"):
        identify(np.zeros((3, 2)), np.zeros((2, 2)))
    with pytest.raises(InputError, match="tau of sample 1"):
        identify(np.zeros((3, 2)), [[0, 0], [0, np.nan], [0, 0]])


def test_joints_that_no_static_torque_drives_do_not_keep_relations_from_being_decided():
    """The vertical first axis of an arm stands still: what the others showed is claimed."""
    potential, _ = known_potential("ur5")
    q = np.random.default_rng(6).uniform(-np.pi, np.pi, (40, 6))
    q[:, [0, 4, 5]] = 0.2
    found = identify(q, potential.gradient(q))
    assert found.order == 16
    assert found.decided
    assert found.unmoved == (0, 4, 5)
    assert found.missing is not None
    assert "joint 1, 5, 6 moves" in found.missing


@pytest.mark.parametrize(
    ("name", "count", "by"),
    [
        ("pendulum", 3, identify),
        ("2r", 4, identify),
        ("3r", 4, identify),
        ("2r", 5, identify_by_waves),
        ("3r", 9, identify_by_waves),
    ],
)
def test_exact_samples_suffice_that_determine_a_potential_and_check_it(name, count, by):
    """Constants cost no sample where there are none: more equations than coefficients are met."""
    potential, group = known_potential(name)
    unit = np.eye(potential.n)
    for seed in range(5):
        q = np.random.default_rng(seed).uniform(-2.0, 2.0, (count, potential.n))
        tau = potential.gradient(q)
        assert by(q, tau).order == group.order
        assert by(q[1:], tau[1:]).order == 1
        # and what is more than gravity shows: constants, springs, noise
        noise = 1e-4 * np.random.default_rng(seed).normal(size=q.shape)
        for more in (0.01 * unit[-1], 0.01 * q, noise):
            found = by(q, tau + more)
            assert found.order == 1
            assert "and check them" in found.missing


@pytest.mark.parametrize("noise", [0.3, 0.5, 0.8])
def test_what_could_be_wrong_by_a_tenth_of_the_torque_is_not_claimed(noise):
    """Few samples, much noise, no contradiction: the error that remains is said."""
    potential, _ = known_potential("2r")
    said = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (14, 2))
        tau = potential.gradient(q) + noise * rng.normal(size=q.shape)
        learned = identify_by_waves(q, tau, noise=MeasurementNoise(0.0, noise))
        said.append("relations could still be wrong by" in (learned.missing or ""))
        assert learned.order == 1
    assert any(said)


def test_waves_veto_what_a_chain_takes_for_noise():
    """A chain in disguise: three joints whose torques fit one within noise, and waves see more."""
    potential, group = known_potential("3r")
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (400, 3))
    tau = potential.gradient(q) + 0.05 * rng.normal(size=q.shape)
    # no rigid arm has this wave without others: chains leave it to the noise
    wave = TrigonometricPolynomial([[1, -1, 0]], [0.15], [0.1])
    learned = identify(q, tau + wave.gradient(q))
    assert learned.order < group.order
    for relation in learned.group:
        arm = potential + wave
        error = worst_torque_error(relation, arm, np.random.default_rng(1))
        assert (error <= relation.bound + 1e-9).all()


def test_many_images_of_few_torques_do_not_make_a_chain():
    """Orbits of few samples fill equations, and false chains explain them exactly."""
    for name, torques in (("3r", 2), ("4r-planar", 3)):
        potential, group = known_potential(name)
        q, tau = recording(potential, group, np.random.default_rng(0), torques)
        found = identify_by_chain(q, tau)
        assert found.order == 1
        assert "different |torque|" in found.missing
        assert "more torques" in found.missing
