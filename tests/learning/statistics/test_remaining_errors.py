"""What explains errors at fresh poses: noise, the model's own standard error, constants."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.statistics.fresh_errors import fresh_errors
from isotorque.learning.statistics.remaining_errors import constants, explained

POSES = 40


def found(errors, noise):
    return fresh_errors(errors, np.full(errors.shape, noise), np.inf, np.full(errors.shape[1], 0.1))


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.integers(0, 2), st.floats(0.2, 5.0), st.sampled_from([-1, 1]))
def test_a_constant_is_named_with_its_joint_and_size(seed, joint, size, sign):
    errors = 0.1 * np.random.default_rng(seed).normal(size=(POSES, 3))
    errors[:, joint] += sign * size
    measured = found(errors, 0.1)
    assert constants(measured).tolist() == [joint]
    noise, constant = explained(measured)
    assert noise == "noise alone does not explain the errors"
    mean = errors[:, joint].mean()
    assert f"a constant torque of {mean:+.3g} N m on joint {joint + 1} (standard" in constant
    assert "or friction approached from one side" in constant


def test_noise_shows_no_constant_more_often_than_stated():
    rng = np.random.default_rng(0)
    seen = sum(len(constants(found(rng.normal(size=(20, 2)), 1.0))) for _ in range(300))
    assert seen <= 6  # one in two hundred is stated


@pytest.mark.parametrize(
    ("own", "words"),
    [
        (None, "noise alone does not explain the errors"),
        (0.5, "explain the errors"),
        (0.01, "do not explain the errors"),
        (np.inf, "is infinite there"),
    ],
)
def test_the_models_own_standard_error_explains_as_much_as_it_is(own, words):
    rng = np.random.default_rng(2)
    errors = 0.1 * rng.normal(size=(POSES, 2)) + 0.6 * np.sin(3.0 * rng.normal(size=(POSES, 2)))
    stated = None if own is None else np.full(errors.shape, own)
    said = explained(found(errors, 0.1), stated)
    assert words in said[0]
    assert ("do not" in said[0]) == (words.startswith("do not"))


def test_nothing_is_said_of_noise_that_nobody_knows():
    errors = np.sin(np.arange(20.0))[:, None]
    assert explained(found(errors, 0.0)) == ()
