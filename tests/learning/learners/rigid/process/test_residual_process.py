"""Processes of residuals against scikit-learn's, and against differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from isotorque.learning.learners.rigid.process import residual_process
from isotorque.learning.learners.rigid.process.residual_process import ResidualProcess


def draw(seed, joints, count):
    """Configurations, residuals and hyperparameters."""
    rng = np.random.default_rng(seed)
    x = np.concatenate([rng.normal(-0.5, 0.5, 3), rng.normal(0.7, 0.4, joints), [-3.0]])
    return rng.uniform(-np.pi, np.pi, (count, joints)), rng.normal(size=count), x


def on_circles(q):
    """Cosines and sines, the sines after the cosines."""
    return np.concatenate([np.cos(q), np.sin(q)], axis=1)


def peer(process):
    """scikit-learn's process with the same covariance."""
    n, x = process.q.shape[1], process.hyperparameters
    alone = np.full(n, 1e8)
    alone[process.joint] = np.exp(x[1])
    kernel = ConstantKernel(np.exp(x[0])) * RBF(np.tile(alone, 2), "fixed")
    kernel += ConstantKernel(np.exp(x[2])) * RBF(np.tile(np.exp(x[3:-1]), 2), "fixed")
    noise = np.exp(x[-1]) + residual_process.JITTER
    made = GaussianProcessRegressor(kernel, alpha=noise, optimizer=None)
    return made.fit(on_circles(process.q), process.residuals / process.scale)


@given(st.integers(0, 10_000), st.integers(1, 4), st.data())
@settings(max_examples=15)
def test_mean_and_variance_are_scikit_learns(seed, joints, data):
    joint = data.draw(st.integers(0, joints - 1))
    q, residuals, x = draw(seed, joints, 12)
    process = ResidualProcess(joint, q, residuals, 2.5, x)
    new, *_ = draw(seed + 1, joints, 7)
    mean, deviation = peer(process).predict(on_circles(new), return_std=True)
    np.testing.assert_allclose(process.mean(new), 2.5 * mean, rtol=1e-7, atol=1e-9)
    across = process.covariance(new) @ process.whitening.T * process.scale**2
    variance = process.size**2 - np.sum(across**2, axis=1)
    np.testing.assert_allclose(variance, (2.5 * deviation) ** 2, rtol=1e-6, atol=1e-9)


@given(st.integers(0, 10_000), st.integers(1, 3), st.booleans())
@settings(max_examples=15)
def test_the_gradient_is_that_of_the_cost(seed, joints, restricted):
    q, residuals, x = draw(seed, joints, 9)
    fixed = None
    if restricted:
        fixed = np.linalg.qr(np.random.default_rng(seed).normal(size=(9, 2)))[0]
    given_to = (joints - 1, residual_process._chords(q, q), residuals, fixed)
    _, gradient = residual_process._cost(x, *given_to)
    numeric = approx_fprime(x, lambda x: residual_process._cost(x, *given_to)[0], 1e-6)
    np.testing.assert_allclose(gradient, numeric, rtol=2e-4, atol=2e-4)


def test_the_likelihood_is_scikit_learns_up_to_a_constant():
    q, residuals, x = draw(3, 2, 10)
    other = x + np.linspace(-0.3, 0.3, len(x))

    def both(x):
        process = ResidualProcess(0, q, residuals, 1.0, x)
        names = residual_process._names(2)
        deviation = [residual_process.UNCERTAIN[name] for name in names]
        prior = 0.5 * np.sum(((x - residual_process._expected(2)) / deviation) ** 2)
        ours, _ = residual_process._cost(x, 0, residual_process._chords(q, q), residuals, None)
        return ours - prior, -peer(process).log_marginal_likelihood_value_

    differences = np.subtract(both(x), both(other))
    assert differences[0] == pytest.approx(differences[1], abs=1e-6)


def test_noise_that_is_known_is_kept():
    q, residuals, _ = draw(0, 2, 20)
    process = ResidualProcess.fitted_to(0, q, residuals, noise=0.3)
    assert process.noise == pytest.approx(0.3)


def test_more_samples_than_hyperparameters_need_are_all_conditioned_on(monkeypatch):
    monkeypatch.setattr(residual_process, "MOST_SEARCHED", 40)
    q = np.random.default_rng(0).uniform(-2, 2, (70, 2))
    process = ResidualProcess.fitted_to(0, q, np.sin(3 * q[:, 0]))
    assert len(process.weights) == len(q)
    assert np.abs(process.mean(q) - np.sin(3 * q[:, 0])).max() < 0.01
