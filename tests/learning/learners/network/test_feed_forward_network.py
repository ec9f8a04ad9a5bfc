"""Tests of the symmetric network: equivariance, derivatives, the paper's figures, refusals."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.learners import planar_arm
from tests.learning.learners.random_groups import groups, worst_asymmetry

MODES = ("averaged", "augmented", "canonical")
QUICK = {"hidden": 4, "restarts": 1, "trial_iterations": 1, "iterations": 1}


def with_random_weights(group, rng, **options):
    """A network that has learned nothing but has weights."""
    n = group.n
    network = FeedForwardNetwork(**QUICK, group=group, **options)
    network.fit(rng.uniform(-3, 3, (3, n)), rng.normal(size=(3, n)))
    network.weights_ = rng.normal(size=network.weights_.shape)
    return network


def rms_error(network, torque, n, seed=99):
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (1500, n))
    return np.sqrt(np.mean((network.predict(q) - torque(q)) ** 2))


@given(
    group=groups(),
    seed=st.integers(0, 2**32 - 1),
    mode=st.sampled_from(("averaged", "canonical")),
    inputs=st.sampled_from(("sincos", "raw")),
)
def test_exactly_equivariant_whatever_the_weights(group, seed, mode, inputs):
    rng = np.random.default_rng(seed)
    network = with_random_weights(group, rng, symmetries=mode, inputs=inputs)
    q = rng.uniform(-np.pi, np.pi, (5, group.n))
    assert worst_asymmetry(network.predict, group, q) < 1e-12


@settings(max_examples=40)
@given(
    group=groups(),
    seed=st.integers(0, 2**32 - 1),
    mode=st.sampled_from(MODES),
    inputs=st.sampled_from(("sincos", "raw")),
)
def test_jacobian_is_the_derivative(group, seed, mode, inputs):
    rng = np.random.default_rng(seed)
    network = with_random_weights(group, rng, symmetries=mode, inputs=inputs)
    q = rng.uniform(-1, 1, (3, group.n))
    found = network.jacobian(q)
    for j in range(group.n):
        step = np.zeros(group.n)
        step[j] = 1e-6
        difference = (network.predict(q + step) - network.predict(q - step)) / 2e-6
        assert np.abs(found[:, :, j] - difference).max() < 1e-5 * (1 + np.abs(found).max())


@given(seed=st.integers(0, 2**32 - 1), mode=st.sampled_from(MODES))
def test_periodic_with_circles_as_inputs(seed, mode):
    rng = np.random.default_rng(seed)
    group = primary_symmetries(GravityModel(load_robot("2r")).potential)
    network = with_random_weights(group, rng, symmetries=mode)
    q = rng.uniform(-np.pi, np.pi, (4, 2))
    turned = network.predict(q + 2 * np.pi * rng.integers(-2, 3, q.shape))
    assert np.abs(turned - network.predict(q)).max() < 1e-10 * (1 + np.abs(turned).max())


@pytest.mark.parametrize(
    ("robot", "samples", "hidden", "demanded"),
    [
        pytest.param("2r", 255, 18, 1e-4, marks=pytest.mark.slow),
        ("2r", 64, 18, 5e-4),
        ("3r", 65, 18, 0.02),
        pytest.param("3r", 300, 30, 0.002, marks=pytest.mark.slow),
    ],
)
def test_figures_of_the_paper_and_better(robot, samples, hidden, demanded):
    gravity = GravityModel(load_robot(robot))
    group = primary_symmetries(gravity.potential)
    region = SamplingRegion.of_domain(FundamentalDomain(group))
    q = lattice_samples(region, samples, np.random.default_rng(0)).q
    network = FeedForwardNetwork(hidden, group=group).fit(q, gravity.torque(q))
    assert rms_error(network, gravity.torque, q.shape[1]) < demanded


@pytest.mark.parametrize("mode", ["augmented", "canonical"])
def test_other_modes_learn_too(mode):
    group = primary_symmetries(GravityModel(load_robot("2r")).potential)
    region = SamplingRegion.of_domain(FundamentalDomain(group))
    q = lattice_samples(region, 60, np.random.default_rng(0)).q
    network = FeedForwardNetwork(12, symmetries=mode, group=group, restarts=4, iterations=120)
    network.fit(q, planar_arm.torque(q))
    assert rms_error(network, planar_arm.torque, 2) < 0.05


def test_without_a_group_modes_are_one():
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (200, 2))
    fits = [
        FeedForwardNetwork(10, symmetries=mode, restarts=2, iterations=60)
        .fit(q, planar_arm.torque(q))
        .predict(q[:5])
        for mode in MODES
    ]
    assert np.abs(fits[0] - fits[1]).max() < 1e-9
    assert np.abs(fits[0] - fits[2]).max() < 1e-9
    assert np.abs(fits[0] - planar_arm.torque(q[:5])).max() < 0.1


def test_weights_count_like_repetitions():
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (30, 1))
    torque = np.cos(q) + 0.1 * rng.normal(size=q.shape)
    weights = rng.integers(1, 4, 30)
    options = {"hidden": 2, "restarts": 2, "iterations": 60}
    weighted = FeedForwardNetwork(**options).fit(q, torque, weights)
    repeated = FeedForwardNetwork(**options).fit(
        np.repeat(q, weights, axis=0), np.repeat(torque, weights, axis=0)
    )
    assert np.abs(weighted.predict(q) - repeated.predict(q)).max() < 1e-5


def test_early_stop_keeps_noise_out():
    """Samples with errors, more units than needed: held-out samples end the search in time."""
    rng = np.random.default_rng(2)
    q = rng.uniform(-np.pi, np.pi, (60, 2))
    torque = planar_arm.torque(q) + rng.normal(0, 1.0, q.shape)
    options = {"hidden": 18, "restarts": 3, "iterations": 150, "random_state": 1}
    plain = FeedForwardNetwork(**options).fit(q, torque)
    early = FeedForwardNetwork(**options, validation_fraction=0.2).fit(q, torque)
    assert early.n_iterations_ < plain.n_iterations_
    assert rms_error(early, planar_arm.torque, 2) < rms_error(plain, planar_arm.torque, 2)


@pytest.mark.parametrize("mode", MODES)
def test_saved_and_restored(mode):
    rng = np.random.default_rng(3)
    group = primary_symmetries(GravityModel(load_robot("3r")).potential)
    network = with_random_weights(group, rng, symmetries=mode)
    saved = json.loads(json.dumps(network.parameters()))
    again = FeedForwardNetwork.from_arrays(network.to_arrays(), saved)
    q = rng.uniform(-np.pi, np.pi, (20, 3))
    assert np.abs(again.predict(q) - network.predict(q)).max() < 1e-12
    wrong = network.to_arrays() | {"weights": np.zeros(3)}
    with pytest.raises(InputError, match="number of weights"):
        FeedForwardNetwork.from_arrays(wrong, saved)


def test_joints_without_torque_and_one_column():
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (30, 2))
    torque = np.stack([np.zeros(30), np.cos(q[:, 1])], axis=1)
    network = FeedForwardNetwork(4, restarts=2, iterations=60).fit(q, torque)
    assert np.abs(network.predict(q) - torque).max() < 0.01
    flat = FeedForwardNetwork(4, restarts=2, iterations=60).fit(q, torque[:, 1])
    assert flat.predict(q).shape == (30,)
    silent = FeedForwardNetwork(**QUICK).fit(q, np.zeros((30, 2)))
    assert np.isfinite(silent.predict(q)).all()


@pytest.mark.parametrize(
    "options",
    [
        {"hidden": 0},
        {"symmetries": "half"},
        {"inputs": "degrees"},
        {"restarts": 0},
        {"iterations": 0},
        {"ridge": -1.0},
        {"tolerance": np.nan},
        {"validation_fraction": 1.0},
    ],
)
def test_refuses_unusable_settings(options):
    with pytest.raises(InputError, match=next(iter(options))):
        FeedForwardNetwork(**options).fit([[0.0, 0.0]], [[1.0, 2.0]])


def test_refuses_what_does_not_fit():
    network = FeedForwardNetwork(**QUICK)
    with pytest.raises(InputError, match="NaN"):
        network.fit([[0.0, np.nan]], [[1.0, 2.0]])
    with pytest.raises(InputError, match="shape"):
        network.fit([[0.0, 0.0]], [[1.0, 2.0], [3.0, 4.0]])
    with pytest.raises(InputError, match="number of columns"):
        FeedForwardNetwork(**QUICK, group=planar_arm.group()).fit([[0.0, 0.0]], [[1.0]])
