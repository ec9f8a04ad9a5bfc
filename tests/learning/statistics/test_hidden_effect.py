"""Effects that small residuals hide: no more often than is said, whatever the noise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.statistics.hidden_effect import CHANCE, hidden_effect


@given(st.integers(1, 6), st.floats(-3.0, 3.0), st.integers(0, 2**32 - 1))
def test_noise_of_any_level_hides_a_larger_effect_as_rarely_as_that(freedom, logarithm, seed):
    effect = np.zeros(freedom)
    effect[0] = 1.0
    noise = 10.0**logarithm * np.random.default_rng(seed).normal(size=(20_000, freedom))
    left = np.linalg.norm(effect + noise, axis=1)
    hidden = float(np.mean(left * hidden_effect(freedom) < 1.0))
    assert hidden <= CHANCE + 5.0 * np.sqrt(CHANCE / len(noise))


@pytest.mark.parametrize("freedom", [1, 2, 5])
def test_at_the_worst_level_it_is_as_often(freedom):
    """The limit is no larger than it has to be."""
    noise = np.random.default_rng(0).normal(size=(200_000, freedom)) / np.sqrt(freedom)
    noise[:, 0] += 1.0
    left = np.linalg.norm(noise, axis=1)
    assert np.mean(left * hidden_effect(freedom) < 1.0) > 0.8 * CHANCE


def test_more_residuals_hide_less():
    limits = [hidden_effect(freedom) for freedom in range(1, 20)]
    assert np.all(np.diff(limits) < 0.0)
    assert limits[-1] > 1.0
