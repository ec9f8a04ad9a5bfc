"""How fast an arm that knows nothing finds out how much torque a joint takes."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.arm import LimitHit, OutcomeKind, Settled
from isotorque.learning.discovery.motor_babbling import AIM, DOUBLED, GROWTH, VISIBLE_MOTION, babble
from tests.learning.discovery.test_home_torque import result


class Hanging:
    """A pendulum of a given largest torque whose angle is read with an error."""

    def __init__(self, largest: float, noise: float = 0.0, seed: int = 0) -> None:
        self.largest, self.noise, self.rng = largest, noise, np.random.default_rng(seed)
        self.q = np.zeros(1)

    def apply(self, torque):
        share = float(torque[0]) / self.largest
        if abs(share) >= 1.0:
            self.go_home()
            return LimitHit(np.array([np.pi]), np.asarray(torque), 1.0)
        self.q = np.arcsin([share]) + self.noise * self.rng.normal(size=1)
        return Settled(self.q, np.asarray(torque), 1.0)

    def go_home(self):
        self.q = np.zeros(1)


def ramp(arm, growth):
    """The torques of the search for a joint's scale."""
    return result(babble(arm, np.random.default_rng(0), 0, growth=growth))[0]


@given(st.floats(0.05, 1e4), st.integers(0, 100))
def test_a_few_motions_find_the_scale_of_a_joint_and_do_not_throw_it_over(largest, seed):
    outcomes = ramp(Hanging(largest, np.deg2rad(0.1), seed), GROWTH)
    assert all(o.kind is OutcomeKind.SETTLED for o in outcomes)
    assert abs(outcomes[-1].q[0]) > VISIBLE_MOTION - 0.01
    assert abs(outcomes[-1].q[0]) < 2.5 * AIM
    assert len(outcomes) <= 4 + np.log(max(largest / 1e-3, 1.0)) / np.log(GROWTH)


def test_doubling_is_as_slow_as_it_ever_was():
    torques = [o.torque[0] for o in ramp(Hanging(10.0, np.deg2rad(0.1)), DOUBLED)]
    np.testing.assert_allclose(np.diff(np.log2(torques)), 1.0)


def test_a_joint_that_sticks_and_then_falls_is_tried_more_gently():
    arm = Hanging(0.05)
    free = arm.apply
    arm.apply = lambda torque: (  # sticks up to 0.02 N m, and nothing tells
        Settled(np.zeros(1), np.asarray(torque), 1.0) if torque[0] < 0.02 else free(torque)
    )
    outcomes = ramp(arm, GROWTH)
    kinds = [o.kind for o in outcomes]
    assert OutcomeKind.LIMIT in kinds
    assert outcomes[-1].kind is OutcomeKind.SETTLED
    assert outcomes[-1].q[0] > VISIBLE_MOTION


@pytest.mark.parametrize("count", [0, 3])
def test_wanted_torques_come_before_the_rays(count):
    wanted = SimpleNamespace(asked=[])

    def next_one(centre, size):
        wanted.asked.append(size.copy())
        return np.array([0.5]) if len(wanted.asked) <= count else None

    arm = Hanging(10.0)
    outcomes, _ = result(babble(arm, np.random.default_rng(0), 4, wanted=next_one))
    assert [o.torque[0] for o in outcomes].count(0.5) == count
    assert all(size[0] > 0.0 for size in wanted.asked)
    assert len(outcomes) == len(ramp(Hanging(10.0), DOUBLED)) + count + 4
