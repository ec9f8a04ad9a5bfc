"""What is given to a simulated arm and cannot be used."""

import numpy as np
import pytest

from isotorque.learning.simulator.results import ArmState
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from tests.learning.two_link_arm import ARM, ROBOT


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (lambda arm: arm.apply([1.0]), "torque is of length 1; accepted: 2 finite numbers"),
        (lambda arm: arm.apply([1.0, np.nan]), r"torque is \[1.0, nan\]"),
        (lambda arm: arm.apply([1.0, np.inf]), r"torque is \[1.0, inf\]"),
        (lambda arm: arm.apply(["a", 1.0]), "torque is"),
        (lambda arm: arm.apply([[1.0, 2.0]]), r"torque is of shape \(1, 2\)"),
        (lambda arm: arm.play([[1.0]], 0.1), r"torques is of shape \(1, 1\)"),
        (lambda arm: arm.play(np.empty((0, 2)), 0.1), r"torques is of shape \(0, 2\)"),
        (lambda arm: arm.play([[0.0, 0.0], [0.0, np.nan]], 0.1), "row 1 of torques"),
        (lambda arm: arm.play([[0.0, 0.0]], 0.0), "step_seconds is 0.0; accepted: .* > 0"),
        (lambda arm: arm.play([[0.0, 0.0]], np.nan), "step_seconds is nan"),
        (lambda arm: arm.place_and_hold([0.0, 4.0], [0.0, 0.0]), "q of joint .* is 4.0"),
        (lambda arm: arm.place_and_hold([0.0, 0.0], [0.0, 0.0], seconds=-1), "seconds is -1"),
        (lambda arm: arm.release_test([0.0], [0.0, 0.0]), "q is of length 1"),
        (lambda arm: arm.settle_each([[0.0, 0.0]], [[0.0, 0.0]] * 2), "1 rows beside 2 torques"),
        (lambda arm: arm.restore(ArmState((0.0,), (0.0,), (0.0,), None)), "q is of length 1"),
        (lambda arm: SimulatedArm(ROBOT, "floating"), "physics is floating; .* open_loop, geared"),
        (lambda arm: SimulatedArm(ROBOT, engine="bullet"), "engine is bullet; .* compiled, pino"),
        (lambda arm: SimulatedArm(ROBOT, settle="almost"), "settle is almost; .* finished, raw"),
        (lambda arm: SimulatedArm(ROBOT, q0=[0.0, 9.0]), "q0 of joint .* is 9.0"),
        (lambda arm: SimulatedArm(ROBOT, noise=SensorNoise(angle=0.1)), "rng is None"),
    ],
)
def test_bad_input_is_refused_in_one_line_and_nothing_moves(action, message):
    before = ARM.state()
    with pytest.raises(InputError, match=message) as caught:
        action(ARM)
    assert "\n" not in str(caught.value)
    assert ARM.state() == before
