"""Chances of large deviations are those of the distributions that they are said to follow."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from isotorque.learning.statistics.tails import quantile, tail_probability


@given(st.floats(0.5, 4.0), st.floats(1.0, 200.0))
def test_quantiles_are_exceeded_as_rarely_as_those_of_a_normal_variable(deviations, freedom):
    wide = quantile(deviations, freedom)
    assert stats.t.sf(wide, freedom) == pytest.approx(stats.norm.sf(deviations), rel=1e-6)
    assert wide > deviations
    assert quantile(deviations, np.inf) == deviations


def test_tail_probability_knows_its_limits():
    assert tail_probability(5.0, 0, np.inf) == 1.0
    assert np.isclose(tail_probability(3.84, 1, np.inf), 0.05, atol=1e-3)
    assert tail_probability(3.84, 1, 3.0) > 0.1  # three degrees of freedom know the noise badly
