"""Bounds of claims contain constants and what samples do not exclude, on both sides."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.claim_bounds import claim_bounds
from isotorque.learning.relations.identification.wave_identification import identify_by_waves
from isotorque.learning.relations.lack_of_fit import Alternative, LackOfFit, lack_of_fit
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.potential.potential_fit import all_frequencies, fit_potential
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup, lifted_relations
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from tests.learning.static_data import known_potential

seeds = st.integers(0, 2**32 - 1)


def arm(name, more):
    """Fit of an arm's exact torque with constants ``more``, and its exact group."""
    potential, exact = known_potential(name)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (80, potential.n))
    tau = potential.gradient(q) + more
    fit = fit_potential(q, tau, all_frequencies(potential.n))
    group = CandidateGroup(exact.basis, exact.A_sat, exact.d_sat, exact.Y)
    return potential, fit, tau, group


def worst_errors(torque, group, q):
    here = torque(q)
    return np.array(
        [
            np.abs(torque(wrap(r.configuration(q))) - r.torque(here)).max(axis=0)
            for r in lifted_relations(group)
        ]
    )


@given(seeds, st.sampled_from(["2r", "3r"]), st.floats(0.05, 2.0))
@settings(max_examples=10)
def test_a_constant_makes_relations_that_flip_it_wrong_by_twice_its_size(seed, name, size):
    n = int(name[0])
    constants = size * np.random.default_rng(seed).uniform(-1, 1, n)
    potential, fit, tau, group = arm(name, constants)
    bound, rms = claim_bounds(fit, lack_of_fit(fit), group, 3.0)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (200, n))
    error = worst_errors(lambda x: potential.gradient(x) + constants, group, q)
    scale = np.abs(tau).max()
    assert (error <= bound + 1e-9 * scale).all()
    np.testing.assert_allclose(error, np.where(group.Y < 0, 2 * np.abs(constants), 0), atol=1e-9)
    assert rms.max() < 1e-6 * scale  # of gravity alone nothing is wrong


@given(seeds, st.sampled_from(["2r", "3r"]), st.floats(0.05, 2.0), st.booleans())
@settings(max_examples=10)
def test_a_torque_that_may_be_there_is_allowed_for_on_both_sides(seed, name, size, spring):
    """The alternative is given as it would be estimated; the arm has it, at its full size."""
    rng = np.random.default_rng(seed)
    n = int(name[0])
    potential, fit, _, group = arm(name, 0.0)
    largest = size * rng.uniform(0.2, 1.0, n)
    phase = rng.uniform(-np.pi, np.pi, n)

    def more(q):
        return largest * (q / np.pi if spring else np.sin(2.0 * q + phase))

    nothing = np.zeros(n)
    other = Alternative("spring" if spring else "second harmonic", fit, largest)
    no_joints = np.zeros(0, dtype=np.intp)
    lack = LackOfFit((), no_joints, nothing, nothing, (other,), False, "")
    bound, _ = claim_bounds(fit, lack, group, 3.0)
    q = rng.uniform(-np.pi, np.pi, (4000, n))
    error = worst_errors(lambda x: potential.gradient(x) + more(x), group, q)
    assert (error <= bound + 1e-9).all()
    # some relation turns the torque round where it is largest: less would be too little
    assert (error.max(axis=0) > 1.5 * largest).any()


@given(seeds, st.floats(0.02, 0.1))
@settings(max_examples=10)
def test_a_joint_that_never_stands_out_of_the_noise_may_hold_what_was_seen_of_it(seed, lever):
    """It was taken for a joint without torque, and the bound of its sign was rounding."""
    potential = TrigonometricPolynomial(
        [[1, 0, 0], [1, 1, 0], [1, 1, 1]], [0.0] * 3, [18.4, 6.1, lever]
    )
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (60, 3))
    tau = potential.gradient(q) + 0.05 * rng.normal(size=q.shape)
    found = identify_by_waves(q, tau, noise=MeasurementNoise(0.0, 0.05))
    if np.abs(tau[:, 2]).max() > 0.25 or found.missing:
        return  # it stands out
    far = rng.uniform(-np.pi, np.pi, (1000, 3))
    here = potential.gradient(far)
    for learned in found.relations:
        relation = learned.relation
        flipped = SymmetryRelation(
            relation.A, relation.unwrapped_d, relation.Y * [1, 1, -1], relation.basis
        )
        for one in (relation, flipped):  # the samples do not tell which
            error = np.abs(potential.gradient(one.configuration(far)) - one.torque(here))
            if not relation.is_identity:
                assert error[:, 2].max() <= relation.bound[2] + 1e-9
    assert found.order > 1
