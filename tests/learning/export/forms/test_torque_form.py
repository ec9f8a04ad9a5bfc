"""An exported form is held against its model, all over the space."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.export.forms.torque_form import largest_difference
from isotorque.learning.export.forms.waves import Waves


@given(st.integers(1, 4), st.integers(0, 2**32 - 1), st.floats(1e-6, 10.0))
@settings(max_examples=15)
def test_the_largest_difference_of_any_joint_is_found(joints, seed, size):
    rng = np.random.default_rng(seed)
    frequencies = np.unique(rng.integers(-1, 2, (6, joints)), axis=0)
    cos, sin = rng.normal(size=(2, len(frequencies), joints))
    form = Waves(frequencies, cos, sin)

    def model(q):
        phase = q @ frequencies.T
        return np.cos(phase) @ cos + np.sin(phase) @ sin

    assert largest_difference(form, model) < 1e-12
    joint = int(rng.integers(joints))

    def other(q):  # wrong at one joint, and only where all of them are bent
        return model(q) + size * np.eye(joints)[joint] * np.sin(q).prod(axis=1)[:, None]

    found = largest_difference(form, other)
    assert 0.3 * size < found <= size * (1 + 1e-9)


def test_a_difference_in_one_octant_is_found():
    form = Waves(np.array([[1, 0]]), np.array([[1.0, 0.0]]), np.zeros((1, 2)))

    def other(q):
        torque = np.stack([np.cos(q[:, 0]), 0.0 * q[:, 0]], axis=1)
        return torque + 0.5 * ((q > 1.0).all(axis=1) & (q < 3.0).all(axis=1))[:, None]

    assert largest_difference(form, other) == pytest.approx(0.5)
