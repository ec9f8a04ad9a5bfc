"""Tests of the hidden layer: values written out, derivatives against finite differences."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.learners.network.tanh_layer import TanhLayer


def random_layer(seed):
    """A layer, parameters and inputs (m, G, f) of random sizes."""
    rng = np.random.default_rng(seed)
    copies, outputs, inputs = rng.integers(1, 5), rng.integers(1, 4), rng.integers(1, 4)
    signs = rng.choice([-1.0, 1.0], (copies, outputs))
    layer = TanhLayer(int(inputs), int(rng.integers(1, 6)), int(outputs), signs)
    return layer, rng.normal(size=layer.size), rng.normal(size=(3, copies, inputs)), rng


@given(seed=st.integers(0, 2**32 - 1))
def test_is_the_signed_mean_of_a_plain_network(seed):
    layer, parameters, x, _ = random_layer(seed)
    inner = layer.hidden * (layer.inputs + 1)
    W = parameters[:inner].reshape(layer.hidden, -1)
    V = parameters[inner:].reshape(layer.outputs, -1)
    for values, row in zip(layer.values(parameters, x), x, strict=True):
        expected = np.zeros(layer.outputs)
        for sign, copy in zip(layer.signs, row, strict=True):
            unit = np.tanh(W @ np.append(copy, 1.0))
            expected += sign * (V @ np.append(unit, 1.0)) / len(row)
        assert np.abs(values - expected).max() < 1e-13


@given(seed=st.integers(0, 2**32 - 1))
def test_derivatives_by_the_parameters(seed):
    """Central differences of every parameter."""
    layer, parameters, x, _ = random_layer(seed)
    values, slopes = layer.derivatives(parameters, x)
    assert np.abs(values - layer.values(parameters, x)).max() < 1e-12
    for p in range(layer.size):
        step = np.zeros(layer.size)
        step[p] = 1e-5
        difference = layer.values(parameters + step, x) - layer.values(parameters - step, x)
        assert np.abs(slopes[:, :, p] - difference / 2e-5).max() < 1e-7


@given(seed=st.integers(0, 2**32 - 1))
def test_derivatives_by_the_inputs(seed):
    """Central differences along random directions of all copies together."""
    layer, parameters, x, rng = random_layer(seed)
    dx = rng.normal(size=(*x.shape, 2))
    found = layer.input_derivatives(parameters, x, dx)
    for r in range(2):
        step = 1e-5 * dx[..., r]
        difference = layer.values(parameters, x + step) - layer.values(parameters, x - step)
        assert np.abs(found[:, :, r] - difference / 2e-5).max() < 1e-6


def test_starts_differ_and_bend_within_the_inputs():
    layer = TanhLayer(4, 18, 2, np.ones((1, 2)))
    first, second = (layer.initial(np.random.default_rng(seed)) for seed in (0, 1))
    assert not np.allclose(first, second)
    W, _ = layer.split(first)
    distance = np.abs(W[:, -1]) / np.linalg.norm(W[:, :-1], axis=1)
    assert distance.max() <= 1 + 1e-12
