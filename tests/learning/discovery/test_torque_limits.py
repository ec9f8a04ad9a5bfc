"""Motors are limited in both directions, and what is cut off is counted."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.discovery.torque_limits import TorqueLimitedArm, check_torque
from isotorque.symbolic.common.errors import InputError

NAMES = ("shoulder", "elbow", "wrist")
torques = st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3).map(np.array)
limits = st.lists(st.floats(0.1, 500.0) | st.just(np.inf), min_size=3, max_size=3).map(np.array)


@given(st.lists(torques, min_size=1, max_size=5), limits)
def test_what_is_commanded_is_the_torque_nearest_to_the_one_wanted_that_motors_give(wanted, most):
    commanded = []
    watched = SimpleNamespace(
        apply=commanded.append, play=lambda rows, seconds: commanded.append(rows)
    )
    arm = TorqueLimitedArm(watched, most)
    for torque in wanted:
        arm.apply(torque)
    arm.play(np.array(wanted), 0.02)
    beyond = [bool((np.abs(torque) > most).any()) for torque in wanted]
    assert arm.cut == sum(beyond) + any(beyond)
    for torque, sent in zip([*wanted, np.array(wanted)], commanded, strict=True):
        assert (np.abs(sent) <= most).all()
        np.testing.assert_array_equal(sent, np.sign(torque) * np.minimum(np.abs(torque), most))


@given(torques, limits)
def test_a_torque_beyond_a_limit_is_refused_whatever_its_sign(torque, most):
    beyond = np.flatnonzero(np.abs(torque) > most)
    if not len(beyond):
        check_torque("arm.urdf", "torque", torque, most, NAMES)
        return
    with pytest.raises(InputError, match=f"torque of joint '{NAMES[beyond[0]]}'"):
        check_torque("arm.urdf", "torque", torque, most, NAMES)
