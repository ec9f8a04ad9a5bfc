import numpy as np
import pytest

from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings
from isotorque.learning.relations.identification.identify import identify
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.next_sample import (
    confirm_by_release,
    most_telling_sample,
    next_torque,
)
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    torque_features,
)
from isotorque.learning.relations.potential.potential_fit import all_frequencies, fit_potential
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.static_data import known_potential, stable_samples, with_angle_noise

NOBODY = np.array([], dtype=np.intp)


def noisy_fit(rng, count, degrees=0.3):
    potential, group = known_potential("2r")
    q, tau = stable_samples(potential, rng, count)
    noise = MeasurementNoise(np.deg2rad(degrees), 0.0)
    noisy = with_angle_noise(q, degrees, rng)
    fit = fit_potential(noisy, tau, all_frequencies(2), noise).without_constants(NOBODY)
    return noisy, tau, fit, group, potential


def forbidden_spread(fit, potential):
    """Uncertainty of the coefficients that the arm does not have."""
    m = len(fit.frequencies)
    own = {tuple(k) for k in potential.frequencies.tolist()}
    others = [i for i, k in enumerate(fit.frequencies.tolist()) if tuple(k) not in own]
    return np.sqrt((fit.standard_error[others] ** 2 + fit.standard_error[m:][others] ** 2).sum())


def test_the_chosen_sample_decides_faster_than_chance():
    better = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        q, tau, fit, group, potential = noisy_fit(rng, 6)
        proposals, _ = stable_samples(potential, rng, 40)
        chosen = most_telling_sample(fit, group, proposals)
        spreads = []
        for index in (chosen.index, int(rng.integers(40))):
            angles = with_angle_noise(proposals[index : index + 1], 0.3, rng)
            more_q = np.concatenate([q, angles])
            more_tau = np.concatenate([tau, potential.gradient(proposals[index : index + 1])])
            noise = MeasurementNoise(np.deg2rad(0.3), 0.0)
            later = fit_potential(more_q, more_tau, all_frequencies(2), noise)
            later = later.without_constants(NOBODY)
            spreads.append(forbidden_spread(later, potential))
        better += spreads[0] <= spreads[1]
    assert better >= 15


def test_information_is_what_the_covariance_loses():
    rng = np.random.default_rng(1)
    _, _, fit, group, potential = noisy_fit(rng, 10)
    proposals, _ = stable_samples(potential, rng, 30)
    found = most_telling_sample(fit, group, proposals)
    assert found.information > 0.0
    np.testing.assert_array_equal(found.q, proposals[found.index])
    np.testing.assert_allclose(found.torque, fit.potential.gradient(found.q), atol=1e-9)
    again = most_telling_sample(fit, group, proposals[[found.index]])
    assert np.isclose(again.information, found.information)


def test_a_release_test_confirms_true_relations_and_refutes_others():
    robot = load_robot("2r")
    arm = SimulatedArm(robot, physics="guided")
    potential, _ = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(2), 8)
    learned = identify(q, tau)
    for relation in learned.group:
        assert confirm_by_release(arm, relation, q, tau).passed
    lie = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
    refuted = confirm_by_release(arm, lie, q, tau)
    assert not refuted.passed
    assert refuted.counterexample is not None
    assert refuted.tested == 8


def test_nothing_tested_is_not_passed():
    arm = SimulatedArm(load_robot("2r"), physics="guided")
    relation = known_potential("2r")[1][1]
    assert not confirm_by_release(arm, relation, np.zeros((0, 2)), np.zeros((0, 2))).passed


def test_no_proposals_are_refused():
    rng = np.random.default_rng(3)
    _, _, fit, group, _ = noisy_fit(rng, 8)
    with pytest.raises(InputError, match="shape of proposals"):
        most_telling_sample(fit, group, np.zeros((0, 2)))


def discovered(confirm, seed=1):
    """A discovery that is too short for its noise, and some chosen torques."""
    noise = SensorNoise(np.deg2rad(0.4))
    arm = SimulatedArm(load_robot("2r"), noise=noise, rng=np.random.default_rng(seed + 50))
    settings = SchemeSettings(
        confirm=confirm, max_targets=2, discovery=DiscoverySettings(babbling=20)
    )
    scheme = Scheme(arm, np.random.default_rng(seed), lambda group, span: None, settings)
    return scheme, list(scheme.discover())


def test_chosen_torques_decide_what_a_short_discovery_left_open():
    short, before = discovered(0)
    assert short.learned.order == 1
    assert "more samples" in short.learned.missing
    scheme, motions = discovered(10)
    assert len(before) < len(motions) <= len(before) + 10  # until the relations are known
    for motion, earlier in zip(motions, before, strict=False):
        np.testing.assert_array_equal(motion.outcome.q, earlier.outcome.q)
    chosen = motions[len(before) :]
    assert all(motion.target is None and motion.playback is None for motion in chosen)
    assert scheme.learned.missing is None
    assert scheme.learned.order == 8
    again, repeated = discovered(10)
    np.testing.assert_array_equal(again.samples[0], scheme.samples[0])
    assert len(repeated) == len(motions)


def test_the_next_torque_is_one_the_arm_should_hold():
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = stable_samples(potential, rng, 8)
    for count in (6, 8):
        learned = learn_relations(q[:count], tau[:count])
        found = next_torque(learned, q[:count], rng)
        assert np.linalg.eigvalsh(potential.hessian(found.q)).min() > 0.0
        np.testing.assert_allclose(found.torque, potential.gradient(found.q), atol=1e-6)


def test_without_a_fit_there_is_no_next_torque():
    potential, _ = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(0), 3)
    learned = learn_relations(q, tau)
    assert learned.fit is None
    assert next_torque(learned, q, np.random.default_rng(0)) is None


def test_where_nothing_is_claimed_all_coefficients_are_in_question():
    rng = np.random.default_rng(4)
    _, _, fit, _, potential = noisy_fit(rng, 10)
    proposals, _ = stable_samples(potential, rng, 30)
    found = most_telling_sample(fit, None, proposals)
    information = []
    for q in proposals:  # entropy of what a measurement there would show, less that of its noise
        feature = torque_features(fit.frequencies, q[None])[0]
        stiffness = fit.potential.hessian(q)
        noise = fit.noise.torque**2 * np.eye(2) + fit.noise.angle**2 * stiffness @ stiffness.T
        predicted = noise + feature @ fit.covariance @ feature.T
        information.append(0.5 * np.log(np.linalg.det(predicted) / np.linalg.det(noise)))
    assert found.index == np.argmax(information)
    assert found.information == pytest.approx(max(information))
