"""Torque profiles leave a torque smoothly and come back to its size smoothly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.discovery.torque_profiles import ProfileShape, draw_profile
from isotorque.symbolic.common.errors import InputError

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.integers(1, 5))
@settings(max_examples=40)
def test_profiles_begin_and_end_at_rest_where_they_were_told_to(seed, joints):
    """At rest: the slope at both ends vanishes against the steepest in between."""
    rng = np.random.default_rng(seed)
    tau = rng.uniform(-5.0, 5.0, joints)
    start, end = rng.choice([-1, 1], (2, joints)) * tau
    fine = ProfileShape(step_seconds=1e-3)
    profile = draw_profile(start, end, rng.uniform(1.0, 20.0, joints), rng, fine)
    np.testing.assert_array_equal(profile[0], start)
    np.testing.assert_array_equal(profile[-1], end)
    assert fine.seconds[0] <= len(profile) * fine.step_seconds <= fine.seconds[1]
    slope = np.abs(np.diff(profile, axis=0))
    assert (slope[[0, -1]] < 0.02 * slope.max(axis=0)).all()
    # ... and grows linearly from there: a cubic with curvature, not a kink
    assert (slope[[1, -2]] > 2.0 * slope[[0, -1]] - 1e-12).all()


@given(seeds)
@settings(max_examples=20)
def test_one_seed_draws_one_profile_about_its_centre(seed):
    tau, scale, centre = np.array([1.0, -2.0]), np.array([3.0, 4.0]), np.array([50.0, -50.0])
    drawn = [
        draw_profile(tau, -tau, scale, np.random.default_rng(seed), centre=c)
        for c in (centre, centre, 0.0)
    ]
    np.testing.assert_array_equal(drawn[0], drawn[1])
    assert drawn[0][len(drawn[0]) // 2, 0] > 10.0 > drawn[2].max()


@pytest.mark.parametrize("end", [[1.0, 2.1], [1.0, -2.0 - 1e-6], [1.0, 2.0, 3.0]])
def test_other_sizes_at_the_end_are_refused(end):
    with pytest.raises(InputError, match="end"):
        draw_profile([1.0, -2.0], end, [1.0, 1.0], np.random.default_rng(0))
