import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.rigid.equivariant_basis import (
    multi_affine_frequencies,
    potential_basis,
)
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    torque_features,
)
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.optimal_design import d_optimal, least_variance
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def arm(name):
    gravity = GravityModel(load_robot(name))
    group = primary_symmetries(gravity.potential)
    return gravity, group, SamplingRegion.of_domain(FundamentalDomain(group))


def log_det(group, q, noise=None, stiffness=None):
    """Log det of the information on the tied coefficients, by the definition."""
    coordinates = SymmetryCoordinates.of(group, q.shape[1])
    kappa = multi_affine_frequencies(coordinates.basis)
    rows = torque_features(kappa @ coordinates.basis.astype(int), q)
    rows = rows @ potential_basis(coordinates, kappa)
    covariance = np.broadcast_to(np.eye(q.shape[1]), (len(q), q.shape[1], q.shape[1]))
    if noise is not None:
        spread = stiffness @ stiffness.transpose(0, 2, 1)
        covariance = noise.torque**2 * covariance + noise.angle**2 * spread
    information = np.einsum("cnp,cnm,cmq->pq", rows, np.linalg.inv(covariance), rows)
    return np.linalg.slogdet(information)[1]


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 3))
@settings(max_examples=25, deadline=None)
def test_nearly_as_good_as_the_best_of_all_designs(seed, count):
    """Brute force over all choices with repetition: exchange may stop at a local optimum."""
    _, group, _ = arm("2r")
    candidates = np.random.default_rng(seed).uniform(-np.pi, np.pi, (7, 2))
    design = d_optimal(group, candidates, count)
    choices = itertools.combinations_with_replacement(range(7), count)
    best = max(log_det(group, candidates[list(c)]) for c in choices)
    found = log_det(group, design.q)
    assert found <= best + 1e-6
    assert found >= best - 0.1
    np.testing.assert_array_equal(design.q, candidates[design.chosen])


@pytest.mark.parametrize(("name", "count", "even"), [("2r", 8, 16), ("3r", 8, 16), ("ur5", 16, 20)])
def test_fewer_samples_than_a_lattice_for_the_same_error(name, count, even):
    """Angles off by 0.5 degrees: a smaller design is better than a lattice."""
    gravity, group, region = arm(name)
    noise = MeasurementNoise(np.deg2rad(0.5), 0.02)
    dense = np.random.default_rng(9).uniform(-np.pi, np.pi, (300, gravity.n))
    truth = gravity.torque(dense)

    def measured(q, rng):
        angles = q + noise.angle * rng.normal(size=q.shape)
        return [angles, gravity.torque(q) + noise.torque * rng.normal(size=q.shape)]

    def fit(samples):
        return EquivariantTrigonometric(group=group).fit(*samples)

    def square_error(learner):
        return np.mean((learner.predict(dense) - truth) ** 2)

    spread, chosen = [], []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        lattice = lattice_samples(region, even, rng, exact=False).q
        spread.append(square_error(fit(measured(lattice, rng))))
        first = measured(lattice_samples(region, count // 2, rng, exact=False).q, rng)
        design = d_optimal(
            group,
            lattice_samples(region, 150, rng, exact=False).q,
            count - len(first[0]),
            noise=noise,
            potential=fit(first).fitted_potential(),
            known=first[0],
        )
        pairs = zip(first, measured(design.q, rng), strict=True)
        chosen.append(square_error(fit([np.concatenate(pair) for pair in pairs])))
    assert np.sqrt(np.mean(chosen)) < np.sqrt(np.mean(spread))


def test_what_is_known_is_not_measured_again():
    _, group, _ = arm("2r")
    candidates = np.random.default_rng(0).uniform(-np.pi, np.pi, (40, 2))
    alone = d_optimal(group, candidates, 4)
    more = d_optimal(group, candidates, 4, known=alone.q)
    together = log_det(group, np.concatenate([alone.q, more.q]))
    assert together >= log_det(group, np.concatenate([alone.q, alone.q])) - 1e-9
    assert more.value == pytest.approx(together, abs=1e-6)


def test_candidates_may_be_limited_to_what_the_arm_can_hold():
    gravity, group, region = arm("2r")

    def stable(q):
        return np.linalg.eigvalsh(gravity.stiffness(q))[:, 0] > 0.0

    rng = np.random.default_rng(0)
    candidates = lattice_samples(region, 40, rng, admit=stable, images=group, exact=False).q
    design = d_optimal(group, candidates, 6)
    assert stable(design.q).all()


def test_noise_of_angles_counts_by_the_stiffness():
    gravity, group, region = arm("2r")
    candidates = lattice_samples(region, 100, np.random.default_rng(0), exact=False).q
    noise = MeasurementNoise(0.01, 1e-3)
    potential = gravity.potential.to_float()
    blind = d_optimal(group, candidates, 6)
    aware = d_optimal(group, candidates, 6, noise=noise, potential=potential)
    values = [log_det(group, d.q, noise, gravity.stiffness(d.q)) for d in (blind, aware)]
    assert values[1] > values[0] + 0.1
    assert aware.value == pytest.approx(values[1], abs=1e-6)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
def test_first_choice_leaves_least_variance(seed):
    """Against brute force: condition the process on every candidate in turn."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (4, 2))
    torque = rng.normal(size=(4, 2))
    process = SymmetricGaussianProcess(0.1, length_scale=1.0).fit(q, torque)
    candidates = rng.uniform(-np.pi, np.pi, (6, 2))
    design = least_variance(process, candidates, 1)

    def left(extra):
        total = 0.0
        for model, scale in zip(process.processes_, process._scale, strict=True):
            kernel, samples = model.kernel_, np.concatenate([q, extra])
            gram = kernel(samples, samples.copy()) + (0.1 / scale) ** 2 * np.eye(len(samples))
            cross = kernel(samples, candidates)
            prior = np.diag(kernel(candidates, candidates.copy()))
            total += (prior - np.einsum("sc,sc->c", cross, np.linalg.solve(gram, cross))).sum()
        return total

    remaining = [left(candidates[i : i + 1]) for i in range(6)]
    assert remaining[design.chosen[0]] == pytest.approx(min(remaining), rel=1e-6)
    assert design.value == pytest.approx(min(remaining) / left(q[:0]), rel=1e-6)


def test_level_places_are_preferred_by_the_process_too():
    gravity, group, region = arm("2r")
    rng = np.random.default_rng(0)
    q = lattice_samples(region, 12, rng, exact=False).q
    process = SymmetricGaussianProcess(0.0, group=group).fit(q, gravity.torque(q))
    candidates = lattice_samples(region, 100, rng, exact=False).q
    noise = MeasurementNoise(0.05, 1e-3)
    aware = least_variance(process, candidates, 5, noise=noise)
    slopes = np.linalg.norm(gravity.stiffness(aware.q), axis=(1, 2)).mean()
    assert slopes < 0.9 * np.linalg.norm(gravity.stiffness(candidates), axis=(1, 2)).mean()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: d_optimal(None, np.zeros((0, 2)), 1), "candidates"),
        (lambda: d_optimal(None, np.zeros((3, 2)), 0), "number of configurations"),
        (lambda: d_optimal(None, np.full((3, 2), np.nan), 1), "not finite"),
        (lambda: d_optimal(None, np.ones((3, 2)), 1, known=np.ones((1, 3))), "known"),
        (
            lambda: d_optimal(None, np.ones((3, 2)), 1, noise=MeasurementNoise(0.1, 0.1)),
            "potential",
        ),
    ],
)
def test_refusals(call, message):
    with pytest.raises(InputError, match=message):
        call()
