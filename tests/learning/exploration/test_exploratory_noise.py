"""Tests of the exploratory noise: an affine map whose variance stays, and which drifts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.exploration.exploratory_noise import ExploratoryNoise
from isotorque.symbolic.common.errors import InputError


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), joints=st.integers(1, 4))
def test_is_affine_in_the_displacement(seed, joints):
    rng = np.random.default_rng(seed)
    noise = ExploratoryNoise(rng.uniform(0.1, 2.0, joints), 0.3, rng)
    a, b = rng.normal(size=(2, joints))
    middle = noise((a + b) / 2)
    assert np.abs(middle - (noise(a) + noise(b)) / 2).max() < 1e-12
    assert not np.array_equal(noise(a), noise(b))


def test_variance_stays_and_neighbouring_times_are_alike():
    """Standard deviation = amplitude after any time; autocorrelation 1 / sqrt(1 + drift^2)."""
    rng = np.random.default_rng(0)
    noise = ExploratoryNoise(np.array([2.0]), 0.5, rng)
    values = []
    for _ in range(40_000):
        values.append(noise(np.zeros(1))[0])
        noise.step()
    values = np.array(values)
    assert np.std(values) == pytest.approx(2.0, rel=0.05)
    expected = 1 / np.sqrt(1 + 0.5**2)
    assert np.corrcoef(values[:-1], values[1:])[0, 1] == pytest.approx(expected, abs=0.01)


def test_no_amplitude_no_noise():
    noise = ExploratoryNoise(np.zeros(2), 0.3, np.random.default_rng(0))
    assert not noise(np.ones(2)).any()


@pytest.mark.parametrize(
    ("amplitude", "drift"), [([-1.0], 0.1), ([np.nan], 0.1), ([1.0], -1.0), ([1.0], np.nan)]
)
def test_refuses_what_is_no_amplitude(amplitude, drift):
    with pytest.raises(InputError, match=r"amplitude|drift"):
        ExploratoryNoise(np.array(amplitude), drift, np.random.default_rng(0))
