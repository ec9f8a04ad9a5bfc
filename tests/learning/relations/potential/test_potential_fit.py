import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.potential_fit import (
    all_frequencies,
    fit_potential,
    present_frequencies,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.testing.strategies import known_arms
from tests.learning.static_data import known_potential, stable_samples, with_angle_noise


def in_order_of(fit, potential):
    """Coefficients of a potential in the order of a fit's."""
    m = len(fit.frequencies)
    place = {tuple(k): i for i, k in enumerate(fit.frequencies.tolist())}
    values = np.zeros(2 * m)
    for k, a, b in zip(potential.frequencies.tolist(), potential.cos, potential.sin, strict=True):
        values[place[tuple(k)]], values[m + place[tuple(k)]] = a, b
    return values


@given(known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_one_sample_more_than_unknowns_recovers_the_potential(arm, seed):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    n = potential.n
    used = potential.frequencies.any(axis=0)
    frequencies = all_frequencies(n, used)
    count = -(-(2 * len(frequencies) + 1) // int(used.sum())) + 2
    q = rng.uniform(-np.pi, np.pi, (count, n))
    fit = fit_potential(q, potential.gradient(q), frequencies)
    k, a, b = potential.frequencies, potential.cos, potential.sin
    moving = k.any(axis=1)
    truth = TrigonometricPolynomial(k[moving], a[moving], b[moving])
    error = (fit.potential - truth).sup_bound()
    assert error <= 1e-6 * truth.sup_bound()
    assert error <= 30.0 * np.linalg.norm(fit.standard_error) * len(fit.standard_error)


@pytest.mark.parametrize(("name", "count"), [("2r", 6), ("3r", 10), ("4r-planar", 22)])
def test_stable_samples_alone_determine_the_potential(name, count):
    potential, _ = known_potential(name)
    for seed in range(5):
        q, tau = stable_samples(potential, np.random.default_rng(seed), count)
        fit = fit_potential(q, tau, all_frequencies(potential.n))
        assert (fit.potential - potential).sup_bound() < 1e-9


@pytest.mark.parametrize("degrees", [0.1, 0.5, 2.0])
def test_standard_errors_and_noise_level_are_honest(degrees):
    potential, _ = known_potential("2r")
    misfits, levels = [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        q, tau = stable_samples(potential, rng, 60)
        fit = fit_potential(with_angle_noise(q, degrees, rng), tau, all_frequencies(2))
        whitened = fit.root @ (fit.coefficients - in_order_of(fit, potential))
        misfits.append(float(whitened @ whitened) / len(whitened))
        levels.append(np.rad2deg(fit.noise.angle))
    # chi-square / 8 of 40 fits: standard deviation of the mean 0.08
    assert 0.5 < np.mean(misfits) < 1.4
    assert abs(np.mean(levels) / degrees - 1.0) < 0.05


def test_torque_noise_is_told_from_angle_noise():
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (300, 2))
    tau = potential.gradient(q) + 0.05 * rng.normal(size=q.shape)
    fit = fit_potential(q, tau, all_frequencies(2))
    assert 0.04 < fit.noise.torque < 0.06
    given_level = fit_potential(q, tau, all_frequencies(2), MeasurementNoise(0.0, 0.05))
    assert np.isinf(given_level.freedom)
    np.testing.assert_allclose(given_level.standard_error, fit.standard_error, rtol=0.2)


def test_correcting_the_angles_removes_the_shrinkage_of_ordinary_least_squares():
    potential, _ = known_potential("2r")
    ordinary, corrected = [], []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (800, 2))
        noisy = with_angle_noise(q, 8.0, rng)
        tau = potential.gradient(q)
        fit = fit_potential(noisy, tau, all_frequencies(2))
        truth = in_order_of(fit, potential)
        plain = fit_potential(noisy, tau, all_frequencies(2), MeasurementNoise(0.0, 1.0))
        largest = int(np.abs(truth).argmax())
        corrected.append(fit.coefficients[largest] / truth[largest] - 1.0)
        ordinary.append(plain.coefficients[largest] / truth[largest] - 1.0)
    assert np.mean(ordinary) < -0.008
    assert abs(np.mean(corrected)) < 0.005


def test_present_frequencies_are_the_true_ones():
    potential, _ = known_potential("3r")
    rng = np.random.default_rng(1)
    q, tau = stable_samples(potential, rng, 60)
    fit = fit_potential(with_angle_noise(q, 0.1, rng), tau, all_frequencies(3))
    found = fit.frequencies[present_frequencies(fit, 1e-3)].tolist()
    assert sorted(found) == sorted(potential.frequencies.tolist())


def test_too_few_and_repeated_samples_are_counted():
    potential, _ = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(0), 4)
    for repeats in (1, 5):
        with pytest.raises(Undetermined, match=r"^2 more samples: 4 different"):
            fit_potential(np.tile(q, (repeats, 1)), np.tile(tau, (repeats, 1)), all_frequencies(2))
    turned = np.concatenate([q, q + 2 * np.pi])
    with pytest.raises(Undetermined, match=r"^2 more samples"):
        fit_potential(turned, np.tile(tau, (2, 1)), all_frequencies(2))


def test_samples_on_a_line_leave_coefficients_open():
    potential, _ = known_potential("2r")
    q = np.stack([np.linspace(-1, 1, 30), np.full(30, 0.3)], axis=1)
    with pytest.raises(Undetermined, match="general position"):
        fit_potential(q, potential.gradient(q), all_frequencies(2))


@pytest.mark.parametrize("level", [-1.0, np.nan, np.inf])
def test_noise_levels_must_be_numbers(level):
    with pytest.raises(InputError, match="angle"):
        MeasurementNoise(level, 0.0)
