"""Tests of the symmetric Gaussian process: its kernel, its figures, what it says of itself."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.base import clone

from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.gaussian_process.symmetric_kernel import SymmetrisedPeriodicKernel
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.learners import planar_arm
from tests.learning.learners.random_groups import groups, worst_asymmetry

FIXED = {"length_scale": 1.5, "noise": 0.05}


@given(group=groups(), seed=st.integers(0, 2**32 - 1), length=st.floats(0.4, 4.0))
def test_kernel_is_the_definition(group, seed, length):
    """Summed relation by relation, row by row; gradient by differences; symmetric, positive."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (5, group.n))
    kernel = SymmetrisedPeriodicKernel(SymmetryCoordinates.of(group, group.n), 0, length)
    found, slope = kernel(q, eval_gradient=True)
    rows = group.A_sat.reshape(-1, group.rank)
    expected = np.zeros((5, 5))
    for a, b in itertools.product(range(5), repeat=2):
        for A, d, Y in zip(group.A_sat, group.d_sat, group.Y, strict=True):
            away = A @ group.basis @ q[a] + d - group.basis @ q[b]
            distance = np.sum(1 - np.cos(rows @ away)) / group.order
            expected[a, b] += Y[0] * np.exp(-distance / length**2)
    assert np.abs(found - expected).max() < 1e-10
    assert np.abs(found - found.T).max() < 1e-10
    assert np.linalg.eigvalsh(found).min() > -1e-10
    assert np.abs(kernel.diag(q) - np.diag(found)).max() < 1e-10
    near = [kernel.clone_with_theta(np.log([length]) + h)(q) for h in (1e-5, -1e-5)]
    assert np.abs(slope[:, :, 0] - (near[0] - near[1]) / 2e-5).max() < 1e-6


@settings(max_examples=30)
@given(group=groups(), seed=st.integers(0, 2**32 - 1))
def test_equivariant_whatever_the_weights(group, seed):
    rng = np.random.default_rng(seed)
    q, labels = rng.uniform(-np.pi, np.pi, (2, 8, group.n))
    learner = SymmetricGaussianProcess(**FIXED, group=group).fit(q, labels)
    for process in learner.processes_:
        process.kernel_.theta = np.zeros_like(process.kernel_.theta)
        process.alpha_ = rng.normal(size=process.alpha_.shape)
    assert worst_asymmetry(learner.predict, group, q[:4] + 0.1, least=0.1) < 1e-12


@pytest.mark.parametrize(("robot", "samples"), [("2r", 40), ("3r", 60), ("ur5", 60)])
def test_learns_arms_from_few_samples(robot, samples):
    gravity = GravityModel(load_robot(robot))
    group = primary_symmetries(gravity.potential)
    region = SamplingRegion.of_domain(FundamentalDomain(group))
    q = lattice_samples(region, samples, np.random.default_rng(0)).q
    learner = SymmetricGaussianProcess(group=group).fit(q, gravity.torque(q))
    dense = np.random.default_rng(1).uniform(-np.pi, np.pi, (500, gravity.n))
    error = learner.predict(dense) - gravity.torque(dense)
    assert np.sqrt(np.mean(error**2)) < 1e-4


def test_torques_beyond_gravity():
    """A torsion spring that respects the symmetry q -> -q but is no trigonometric polynomial."""
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (40, 1))

    def torque(q):
        return np.sin(q) * np.exp(np.cos(q))

    learner = SymmetricGaussianProcess().fit(q, torque(q))
    dense = np.linspace(-np.pi, np.pi, 200)[:, None]
    assert np.abs(learner.predict(dense) - torque(dense)).max() < 1e-3


def test_deviations_say_how_large_errors_are():
    """Noise estimated within a fifth; errors of about the size foretold, small near samples."""
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (150, 2))
    noisy = planar_arm.torque(q) + rng.normal(0, 0.5, q.shape)
    learner = SymmetricGaussianProcess(noise=None, group=planar_arm.group()).fit(q, noisy)
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    _, deviation = learner.predict(dense, return_std=True)
    assert deviation.shape == (500, 2)
    known = SymmetricGaussianProcess(noise=0.5, group=planar_arm.group()).fit(q, noisy)
    mean, deviation = known.predict(dense, return_std=True)
    share = np.abs(mean - planar_arm.torque(dense)) / deviation
    assert np.mean(share) < 2.0
    few = SymmetricGaussianProcess(**FIXED).fit([[0.0, 0.0]], [[1.0, 2.0]])
    near, far = few.predict([[0.01, 0.0], [2.0, 2.0]], return_std=True)[1]
    assert (near < 0.2 * far).all()


def test_saved_and_restored():
    rng = np.random.default_rng(4)
    group = primary_symmetries(GravityModel(load_robot("3r")).potential)
    q = rng.uniform(-np.pi, np.pi, (30, 3))
    gravity = GravityModel(load_robot("3r"))
    learner = SymmetricGaussianProcess(noise=0.01, group=group).fit(q, gravity.torque(q))
    saved = json.loads(json.dumps(learner.parameters()))
    again = SymmetricGaussianProcess.from_arrays(learner.to_arrays(), saved)
    for one, other in zip(
        again.predict(q, return_std=True), learner.predict(q, return_std=True), strict=True
    ):
        assert np.abs(one - other).max() < 1e-9


def test_scikit_learn_can_clone_it_and_one_column_stays_one():
    q = np.linspace(-3, 3, 10)[:, None]
    learner = clone(SymmetricGaussianProcess(**FIXED)).fit(q, np.cos(q[:, 0]))
    mean, deviation = learner.predict(q, return_std=True)
    assert mean.shape == deviation.shape == (10,)
    assert mean == pytest.approx(np.cos(q[:, 0]), abs=0.1)


@pytest.mark.parametrize("options", [{"noise": -1.0}, {"length_scale": 0.0}, {"restarts": -1}])
def test_refuses_unusable_settings(options):
    with pytest.raises(InputError, match=next(iter(options))):
        SymmetricGaussianProcess(**options).fit([[0.0]], [[1.0]])


def test_refuses_what_does_not_fit():
    with pytest.raises(InputError, match="NaN"):
        SymmetricGaussianProcess().fit([[np.nan]], [[1.0]])
    with pytest.raises(InputError, match="number of columns"):
        SymmetricGaussianProcess(group=planar_arm.group()).fit([[0.0, 0.0]], [[1.0]])


@pytest.mark.parametrize("noise", [0.05, None])
def test_mean_is_that_of_scikit_learn(noise):
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, 2))
    torque = planar_arm.torque(q)
    learner = SymmetricGaussianProcess(noise, length_scale=1.0, group=planar_arm.group())
    learner.fit(q, torque)
    assert learner.waves_ == [None, None]
    expected = [process.predict(q + 0.3) for process in learner.processes_]
    scale = np.sqrt(np.mean(torque**2, axis=0))
    assert np.abs(learner.predict(q + 0.3) - np.transpose(expected) * scale).max() < 1e-11


@given(st.integers(0, 2**32 - 1), st.integers(6, 16))
@settings(max_examples=6)
def test_no_length_scale_is_below_the_distance_of_the_samples(seed, count):
    # torques without any form are fitted best by a process that knows each sample by itself
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, 2))
    torque = np.stack([np.cos(q[:, 0]), rng.choice([-1.0, 1.0], count)], axis=1)
    learner = SymmetricGaussianProcess(0.0, random_state=0).fit(q, torque)
    chords = np.abs(np.exp(1j * q[:, None]) - np.exp(1j * q))
    distance = np.sqrt((chords**2).sum(axis=2)) + 1e9 * np.eye(count)
    usual = np.median(distance.min(axis=1))
    for joint in range(2):
        assert learner.covariance_sum(joint)[1] >= 0.999 * min(usual, 0.5)
