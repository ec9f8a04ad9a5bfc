import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from isotorque.learning.relations.identification.group_fit import fit_group, torque_uncertainty
from isotorque.learning.relations.potential.potential_fit import all_frequencies, fit_potential
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup, lifted_relations
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.testing.strategies import known_arms
from tests.learning.static_data import (
    known_potential,
    stable_samples,
    with_angle_noise,
    worst_torque_error,
)


def candidate(group) -> CandidateGroup:
    return CandidateGroup(group.basis, group.A_sat, group.d_sat, group.Y)


@given(known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_composed_repairs_small_errors_of_the_offsets(arm, seed):
    exact = candidate(arm.group)
    rng = np.random.default_rng(seed)
    error = 0.02 * rng.normal(size=exact.d.shape)
    error[exact.is_identity()] = 0.0
    repaired = CandidateGroup(exact.basis, exact.A, wrap(exact.d + error), exact.Y).composed()
    assert repaired is not None
    table, defects = repaired.products()
    assert (table == exact.products()[0]).all()
    assert np.abs(defects).max(initial=0.0) < 1e-12
    assert np.abs(wrap(repaired.d - exact.d)).max(initial=0.0) < 0.3


@given(known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_the_true_group_fits_and_its_offsets_are_found_from_wrong_ones(arm, seed):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (60, potential.n))
    used = potential.frequencies.any(axis=0)
    fit = fit_potential(q, potential.gradient(q), all_frequencies(potential.n, used))
    exact = candidate(arm.group)
    rank = exact.d.shape[1]
    shift = 0.05 * rng.normal(size=rank)
    moved = wrap(exact.d + np.einsum("gij,j->gi", np.eye(rank) - exact.A, shift))
    found = fit_group(fit, CandidateGroup(exact.basis, exact.A, moved, exact.Y))
    assert found.p_value > 1e-4
    assert np.abs(wrap(found.group.d - exact.d)).max(initial=0.0) < 1e-7
    scale = potential.gradient_bound().max()
    for relation in lifted_relations(found.group):
        assert worst_torque_error(relation, potential, rng).max() < 1e-6 * scale


def test_a_group_that_is_too_large_is_refuted():
    potential, group = known_potential("2r")
    tilted = potential + type(potential)([[1, 1]], [0.05], [0.0])
    rng = np.random.default_rng(0)
    q, tau = stable_samples(tilted, rng, 20)
    fit = fit_potential(with_angle_noise(q, 0.01, rng), tau, all_frequencies(2))
    wrong = candidate(group)
    wrong = CandidateGroup(wrong.basis, wrong.A, wrong.d, -wrong.Y)
    assert fit_group(fit, wrong).p_value < 1e-12


def test_p_values_are_uniform_and_offset_errors_honest():
    potential, group = known_potential("2r")
    exact = candidate(group)
    p_values, pulls = [], []
    for seed in range(150):
        rng = np.random.default_rng(seed)
        q, tau = stable_samples(potential, rng, 40)
        fit = fit_potential(with_angle_noise(q, 0.2, rng), tau, all_frequencies(2))
        found = fit_group(fit, exact)
        p_values.append(found.p_value)
        moving = found.offset_errors > 0.0
        pulls.append((wrap(found.group.d - exact.d)[moving] / found.offset_errors[moving])[0])
    assert stats.kstest(p_values, "uniform").pvalue > 1e-3
    assert 0.8 < np.std(pulls) < 1.25


def test_bounds_hold_for_the_true_torque_error():
    potential, group = known_potential("2r")
    broken = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        q, tau = stable_samples(potential, rng, 30)
        fit = fit_potential(with_angle_noise(q, 0.3, rng), tau, all_frequencies(2))
        found = fit_group(fit, candidate(group)).group
        bound, rms = torque_uncertainty(fit, found, 3.0)
        for relation, limit, typical in zip(lifted_relations(found), bound, rms, strict=True):
            error = worst_torque_error(relation, potential, rng, 100)
            broken += (error > limit + 1e-12).any()
            assert (typical <= limit + 1e-12).all()
    assert broken == 0


@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
@settings(max_examples=30)
def test_bounds_hold_for_maps_that_lead_out_of_the_frequencies(seed, n):
    """A^T k may be a frequency that the fit does not know: both sides of the relation count."""
    rng = np.random.default_rng(seed)
    waves = all_frequencies(n)
    truth = TrigonometricPolynomial(waves, *rng.normal(size=(2, len(waves))))
    q = rng.uniform(-np.pi, np.pi, (60, n))
    fit = fit_potential(q, truth.gradient(q), waves)
    A = rng.integers(-2, 3, (n, n)).astype(float)
    relation = SymmetryRelation(A, rng.uniform(-np.pi, np.pi, n), rng.choice([-1.0, 1.0], n))
    group = CandidateGroup(relation.basis, A[None], relation.d[None], relation.Y[None])
    bound, rms = torque_uncertainty(fit, group, 3.0)
    error = worst_torque_error(relation, truth, rng, 2000)
    assert (error <= bound[0] + 1e-9).all()
    assert (rms <= bound + 1e-12).all()


def test_the_bound_of_one_wave_and_its_double_is_twice_the_wave():
    """cos 2q against cos q: they meet with opposite signs at q = pi."""
    truth = TrigonometricPolynomial([[1]], [0.0], [2.0])
    q = np.linspace(-3.0, 3.0, 20)[:, None]
    fit = fit_potential(q, truth.gradient(q), all_frequencies(1))
    double = CandidateGroup(
        np.eye(1, dtype=np.int64), np.array([[[2.0]]]), np.zeros((1, 1)), np.ones((1, 1))
    )
    np.testing.assert_allclose(torque_uncertainty(fit, double, 3.0)[0], [[4.0]], rtol=1e-6)
    assert (
        worst_torque_error(
            SymmetryRelation([[2]], [0.0], [1]), truth, np.random.default_rng(0), 5000
        )[0]
        > 3.9
    )
