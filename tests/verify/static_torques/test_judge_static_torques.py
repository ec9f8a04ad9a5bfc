"""The judge of learned static torques, held against sets whose shape is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.scheme import Scheme
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.models.stability import is_stable
from isotorque.verify.static_torques.judge_static_torques import judge_static_torques
from isotorque.verify.static_torques.true_static_torques import TrueStaticTorques
from isotorque.verify.verdict import Status

A, B = 18.39375, 6.13125  # of the 2R arm: g1 - g2 = A cos q1, g2 = B cos(q1 + q2)
FULL = [[-np.pi, np.pi]] * 2


class Slanted:
    """All torques of the 2R arm, scaled: |tau1 - tau2| <= size A, |tau2| <= size B."""

    def __init__(self, size):
        self.size = size

    def contains(self, torque):
        upper, lower = torque[:, 0] - torque[:, 1], torque[:, 1]
        return (np.abs(upper) <= self.size * A) & (np.abs(lower) <= self.size * B)


@pytest.fixture(scope="module")
def gravity():
    return GravityModel(load_robot("2r"))


@pytest.mark.parametrize("stable_only", [True, False])
@pytest.mark.parametrize("size", [1.0, 0.5, 1.1])
def test_a_set_of_known_size_is_measured(gravity, size, stable_only):
    # every torque of the 2R arm is needed by a stable configuration too
    judged = judge_static_torques(Slanted(size), gravity, FULL, stable_only=stable_only)
    area = 4 * A * B
    allowed = 4 * judged.box_volume / np.sqrt(judged.samples)
    assert judged.true_volume == pytest.approx(area, abs=allowed)
    assert judged.learned_volume == pytest.approx(size**2 * area, abs=allowed)
    assert judged.coverage == pytest.approx(min(1.0, size**2), abs=0.06)
    assert judged.false_share == pytest.approx(1.0 - min(1.0, size**-2), abs=0.06)
    assert judged.overlap == pytest.approx(min(size**2, size**-2), abs=0.06)
    assert len(judged.outside) == len(judged.false_torques)
    assert (judged.outside > 0).all()
    # no admitted torque is farther out than the corner of the larger parallelogram
    assert judged.worst_outside <= max(0.0, size - 1.0) * np.hypot(A + B, B) + 1e-6
    assert not Slanted(1.0).contains(judged.false_torques).any()


def test_distances_from_the_set(gravity):
    truth = TrueStaticTorques(gravity, FULL)
    beyond = np.array([[0.0, B + 0.3], [3.0, -B - 2.0], [0.5, 0.25]])
    np.testing.assert_allclose(truth.distance(beyond), [0.3, 2.0, 0.0], atol=2e-3)
    assert truth.distance(np.empty((0, 2))).shape == (0,)


@given(
    st.lists(st.floats(-3.1, 3.1), min_size=4, max_size=4),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=15)
def test_what_is_reached_is_held_and_level_sets_agree(numbers, stable_only, seed):
    gravity = GravityModel(load_robot("2r"))
    limits = np.sort(np.reshape(numbers, (2, 2)), axis=1)
    limits += np.array([-0.05, 0.05])
    rng = np.random.default_rng(seed)
    truth = TrueStaticTorques(
        gravity, limits, stable_only=stable_only, rng=rng, configurations=5000
    )
    q = rng.uniform(*limits.T, (30, 2))
    torques = gravity.torque(q)
    torques[15:] *= rng.uniform(0.5, 1.5, (15, 1))
    reached = truth.reached(torques)
    held = np.array([truth.holds(torque) for torque in torques])
    assert not (reached & ~held).any()
    assert (reached != held).sum() <= 1
    assert held[:15].all() or stable_only
    assert held[:15][is_stable(q[:15], gravity)].all()
    assert (truth.distance(torques)[reached] < 1e-6).all()


def test_no_admission_is_called_false_before_its_level_set_is_asked(gravity, monkeypatch):
    found = judge_static_torques(Slanted(1.1), gravity, FULL, samples=300)
    monkeypatch.setattr(TrueStaticTorques, "reached", lambda self, torques: np.zeros(300, bool))
    asked = judge_static_torques(Slanted(1.1), gravity, FULL, samples=300)
    np.testing.assert_array_equal(asked.false_torques, found.false_torques)
    assert asked.common_volume == found.common_volume > 0


def test_limits_take_torques_away(gravity):
    hanging = [[-2.0, -1.0], [-0.3, 0.3]]
    judged = judge_static_torques(Slanted(1.0), gravity, hanging, samples=600)
    rng = np.random.default_rng(5)
    q = rng.uniform(*np.array(hanging).T, (200_000, 2))
    bins = np.histogram2d(*gravity.torque(q).T, bins=60, range=[[-25, 25], [-6.2, 6.2]])[0]
    area = (bins > 0).mean() * 50 * 12.4
    assert judged.true_volume == pytest.approx(area, rel=0.35)
    assert judged.coverage == 1.0
    assert judged.false_share > 0.5
    assert judged.worst_outside > 5.0


def test_verdicts_say_what_is_claimed(gravity):
    small = judge_static_torques(Slanted(0.5), gravity, FULL, samples=500)
    covered, tight = small.verdicts()
    assert covered.status is Status.REFUTED
    assert covered.worst_error == pytest.approx(1.0 - small.coverage)
    assert tight.status is Status.TESTED
    assert all(v.passed for v in small.verdicts(least_coverage=0.1))
    large = judge_static_torques(Slanted(1.5), gravity, FULL, samples=500)
    covered, tight = large.verdicts(most_outside=0.5)
    assert covered.passed
    assert not tight.passed
    assert tight.worst_error == large.worst_outside > 0.5


def test_nothing_learned_covers_nothing(gravity):
    judged = judge_static_torques(StaticTorqueSet(2), gravity, FULL, samples=200)
    assert (judged.learned_volume, judged.coverage, judged.false_share) == (0.0, 0.0, 0.0)
    assert judged.overlap == 0.0
    assert judged.worst_outside == 0.0


def test_free_joints_do_not_count():
    ur5 = load_robot("ur5")
    gravity = GravityModel(ur5)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (3000, 6))
    held = StaticTorqueSet(6)
    held.add(gravity.torque(q[is_stable(q, gravity)]))
    judged = judge_static_torques(held, gravity, ur5.limits, samples=150)
    reach = gravity.potential.gradient_bound().astype(float)
    acting = reach > 0
    assert acting.sum() == 3
    assert judged.box_volume == pytest.approx(np.prod(2.2 * reach[acting]))
    assert judged.coverage > 0.5


def test_what_an_arm_learned_while_moving():
    robot = load_robot("2r")
    scheme = Scheme(SimulatedArm(robot), np.random.default_rng(0), lambda group, span: None)
    for _ in scheme.discover():
        pass
    judged = judge_static_torques(scheme.static_torques, GravityModel(robot), robot.limits)
    assert 0.5 < judged.coverage <= 1.0
    assert judged.false_share < 0.05


@pytest.mark.parametrize("limits", [[[0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]])
def test_bad_limits_are_refused(gravity, limits):
    with pytest.raises(InputError, match="lower <= upper"):
        judge_static_torques(Slanted(1.0), gravity, limits)


def test_more_joints_than_can_be_measured_are_refused():
    robot = load_robot("4r-planar")
    with pytest.raises(InputError, match="4 joints"):
        judge_static_torques(StaticTorqueSet(4), GravityModel(robot), robot.limits)
