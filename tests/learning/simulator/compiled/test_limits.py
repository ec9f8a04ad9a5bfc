"""Crossings of joint limits: both engines' code against a fine sampling of the motion."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from isotorque.learning.simulator.compiled.limits import crossing, stop_at
from isotorque.learning.simulator.dynamics.crossing import first_crossing


def draw_step(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    limits = np.column_stack([rng.uniform(-2, -0.5, n), rng.uniform(0.5, 2, n)])
    q = rng.uniform(limits[:, 0], limits[:, 1])
    h = rng.uniform(0.05, 1.0)
    q_next = q + rng.normal(size=n) * rng.choice([0.1, 1.0])
    mean = (q_next - q) / h
    return limits, q, mean + rng.normal(size=n), q_next, mean + rng.normal(size=n), h


@given(st.integers(0, 2**32 - 1))
def test_the_first_crossing_is_found(seed):
    limits, q, v, q_next, v_next, h = draw_step(seed)
    motion = CubicHermiteSpline([0.0, 1.0], [q, q_next], [h * v, h * v_next])
    s = np.linspace(0.0, 1.0, 4001)
    path = motion(s)
    outside = (path < limits[:, 0]) | (path > limits[:, 1])
    # Promised: a joint that ends outside, or that turns round once outside.
    promised = outside[-1] | (v * v_next < 0)
    seen = outside[:, promised].any(axis=1)
    ours = crossing(limits, q, v, q_next, v_next, h)
    theirs = first_crossing(limits, q, v, q_next, v_next, h)
    if not seen.any():
        # What passes a limit between two samples only grazes it.
        for found in (ours if ours <= 1.0 else None, theirs and theirs[0]):
            if found is not None:
                depth = np.maximum(limits[:, 0] - path, path - limits[:, 1]).max()
                assert depth > -1e-5
        return
    expected = s[np.argmax(seen)]
    # A cubic may enter, leave and enter again; then the last entry also is an answer to bisection.
    entries = s[1:][seen[1:] & ~seen[:-1]]
    accepted = [expected, *entries]
    assert min(abs(ours - x) for x in accepted) < 1e-3
    assert theirs is not None
    assert abs(theirs[0] - ours) < 1e-9
    there = q.copy()
    stop_at(limits, there, v, q_next, v_next, h, ours)
    assert np.allclose(there, theirs[1], atol=1e-9)
    assert (there >= limits[:, 0]).all()
    assert (there <= limits[:, 1]).all()


def test_a_joint_that_turns_round_beyond_its_limit_is_noticed():
    limits, still = np.array([[-1.0, 1.0]]), np.array([0.9])
    found = first_crossing(limits, still, np.array([4.0]), still, np.array([-4.0]), 0.5)
    assert found is not None
    assert found[1] == [1.0]
    s = crossing(limits, still, np.array([4.0]), still, np.array([-4.0]), 0.5)
    assert abs(s - found[0]) < 1e-12


def test_no_limits_no_crossing():
    limits = np.array([[-np.inf, np.inf]])
    far = np.array([1e3])
    assert first_crossing(limits, 0 * far, far, far, far, 1.0) is None
    assert crossing(limits, 0 * far, far, far, far, 1.0) > 1.0


def test_an_arm_at_its_limit_that_is_pushed_out_hits_it_at_once():
    limits = np.array([[-1.0, 1.0]])
    at, out, still = np.array([1.0]), np.array([1.1]), np.zeros(1)
    found = first_crossing(limits, at, still, out, np.array([1.0]), 0.1)
    assert found is not None
    assert found[1] == [1.0]
    s = crossing(limits, at, still, out, np.array([1.0]), 0.1)
    assert abs(found[0] - s) < 1e-6
