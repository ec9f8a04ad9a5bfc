"""Arms with springs, cables and bent links lose symmetries; straight ones do not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.testing.judge_candidates import Judgement
from isotorque.learning.relations.testing.nested_models import Comparison
from isotorque.learning.relations.testing.subgroup_test import over_joints
from isotorque.learning.relations.testing.supported_group import supported_group
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

ANGLE, TORQUE = np.deg2rad(0.1), 0.01


class Arm:
    """The true torque of an arm that may be broken, and the group of the straight one."""

    def __init__(self, robot, kind="straight"):
        self.kind, tree = kind, load_robot(robot).tree
        self.joint = min(2, len(tree.axes) - 1)  # where the spring or cable is
        self.group = primary_symmetries(GravityModel(tree).potential)
        if kind == "bent":
            turn = np.array([[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]])
            levers = np.array(tree.levers, dtype=float)
            plane = [0, 1] if abs(tree.axes[-1][2]) > 0.5 else [0, 2]
            levers[-1][plane] = turn @ levers[-1][plane]
            tree = replace(tree, levers=levers)
        self.gravity = GravityModel(tree)
        self.n = self.gravity.n

    def torque(self, q):
        torque = self.gravity.torque(q)
        if self.kind == "spring":
            torque[:, self.joint] += 2.0 * (q[:, self.joint] - 0.4)
        elif self.kind == "cable":
            torque[:, self.joint] += 0.5
        return torque

    def recorded(self, count, seed, angle=ANGLE, torque=TORQUE):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (count, self.n))
        measured = q + angle * rng.normal(size=q.shape)
        return measured, self.torque(q) + torque * rng.normal(size=q.shape)

    def holding(self):
        """Indices of relations that hold, by brute force."""
        q = np.random.default_rng(99).uniform(-np.pi, np.pi, (50, self.n))
        here = self.torque(q)
        return [
            i
            for i, r in enumerate(self.group)
            if np.abs(self.torque(wrap(r.configuration(q))) - r.torque(here)).max() < 1e-9
        ]


def numbers_of(group, part):
    return sorted(group.index(r) for r in part)


@pytest.mark.parametrize("kind", ["straight", "spring", "cable", "bent"])
@pytest.mark.parametrize(("robot", "count"), [("2r", 60), ("3r", 120), ("ur5", 120)])
def test_what_is_left_is_what_holds(robot, count, kind):
    arm = Arm(robot, kind)
    q, torque = arm.recorded(count, 0)
    found = supported_group(arm.group, q, torque)
    expected = arm.holding()
    assert numbers_of(arm.group, found.group) == expected
    assert found.whole == (len(expected) == arm.group.order)
    assert found.group.is_closed
    for i, tested in enumerate(found.tested, 1):
        assert (tested.judgement is Judgement.CONSISTENT) == (i in expected)


def test_few_samples_suffice_for_breaks_of_the_usual_kinds():
    """45 samples of the 3R arm cannot determine all waves, but springs and cables they show."""
    for kind in ("spring", "cable"):
        arm = Arm("3r", kind)
        found = supported_group(arm.group, *arm.recorded(45, 1))
        assert found.testable
        assert numbers_of(arm.group, found.group) == arm.holding()


def test_a_spring_that_pulls_to_a_mirror_plane_keeps_the_mirror():
    """Hanging pendulum, q = 0 downwards: q -> -q survives a spring there, q + pi does not."""
    q = np.random.default_rng(0).uniform(-3, 3, (40, 1))
    rigid = 5.0 * np.sin(q)
    group = primary_symmetries(TrigonometricPolynomial([[1]], [-5.0], [0.0]))
    assert group.order == 4
    found = supported_group(group, q, rigid + 2.0 * q)
    assert found.group.order == 2
    mirror = found.group[1]
    np.testing.assert_allclose([mirror.A[0, 0], mirror.d[0], mirror.Y[0]], [-1, 0, -1], atol=1e-12)


def test_noise_free_samples():
    arm = Arm("2r")
    assert supported_group(arm.group, *arm.recorded(40, 0, 0.0, 0.0)).whole
    broken = Arm("2r", "bent")
    found = supported_group(broken.group, *broken.recorded(40, 0, 0.0, 0.0))
    assert numbers_of(broken.group, found.group) == broken.holding()


def test_violation_is_measured_in_torque():
    arm = Arm("2r", "cable")
    found = supported_group(arm.group, *arm.recorded(200, 0))
    against = [t for t in found.tested if t.relation.Y[1] == -1]
    for tested in against:
        assert tested.judgement is Judgement.CONTRADICTED
        np.testing.assert_allclose(tested.violation[1], 0.5, atol=0.1)
        assert tested.resolution[1] < 0.05
    assert "4 are used" in str(found)


@pytest.mark.parametrize("known", [True, False])
def test_relations_that_hold_are_rejected_at_the_stated_rate(known):
    """50 recordings, level 5 %: not more rejections than chance explains (99.9 %)."""
    arm, level, runs = Arm("2r"), 0.05, 50
    noise = MeasurementNoise(ANGLE, TORQUE) if known else None
    rejected = 0
    p_values = []
    for seed in range(runs):
        found = supported_group(arm.group, *arm.recorded(60, seed), noise, level=level)
        rejected += not found.whole
        p_values.append(found.tested[0].p_value)
    assert rejected <= stats.binom.isf(1e-3, runs, level)
    # p-values are bounds (Bonferroni over joints), so small ones are no more frequent than stated
    for threshold in (0.05, 0.2):
        assert np.sum(np.array(p_values) < threshold) <= stats.binom.isf(1e-3, runs, threshold)


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "count"), [("3r", 60), ("3r", 150), ("ur5", 100)])
@pytest.mark.parametrize("degrees", [0.1, 0.5])
def test_rejection_rate_on_larger_arms(robot, count, degrees):
    arm, level, runs = Arm(robot), 0.05, 60
    rejected = sum(
        not supported_group(
            arm.group, *arm.recorded(count, seed, np.deg2rad(degrees)), level=level
        ).whole
        for seed in range(runs)
    )
    assert rejected <= stats.binom.isf(1e-3, runs, level) + 2


@pytest.mark.parametrize("kind", ["spring", "cable", "bent"])
def test_breaks_are_found_in_noise(kind):
    """0.5 degrees of noise, 100 samples: every break is found in each of 10 recordings."""
    arm = Arm("2r", kind)
    for seed in range(10):
        q, torque = arm.recorded(100, seed, np.deg2rad(0.5))
        found = supported_group(arm.group, q, torque)
        assert not found.whole
        assert set(numbers_of(arm.group, found.group)) <= set(arm.holding())


def test_too_few_samples_leave_the_question_open():
    arm = Arm("3r", "cable")
    found = supported_group(arm.group, *arm.recorded(8, 0))
    assert not found.testable
    assert found.group.order == arm.group.order
    assert "too few samples" in str(found)


def test_a_free_direction_that_is_none():
    """The first axis of the UR5 is vertical; a spring there makes the torque depend on it."""
    gravity = GravityModel(load_robot("ur5"))
    group = primary_symmetries(gravity.potential)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (150, 6))
    torque = gravity.torque(q)
    torque[:, 0] += 3.0 * q[:, 0]
    found = supported_group(
        group, q, torque + TORQUE * np.random.default_rng(1).normal(size=q.shape)
    )
    assert found.free_p_value < 1e-9
    assert found.group.order == 1
    np.testing.assert_array_equal(found.group.basis, np.eye(6))


def test_the_identity_alone_needs_no_test():
    arm = Arm("2r")
    found = supported_group(SymmetryGroup([arm.group[0]]), *arm.recorded(20, 0))
    assert found.whole
    assert found.tested == ()
    assert found.p_value == 1.0


def test_refusals():
    arm = Arm("2r")
    q, torque = arm.recorded(20, 0)
    with pytest.raises(InputError, match="number of joints"):
        supported_group(arm.group, q[:, :1], torque[:, :1])
    with pytest.raises(InputError, match="level"):
        supported_group(arm.group, q, torque, level=0.0)
    with pytest.raises(InputError, match="shape of tau"):
        supported_group(arm.group, q, torque[:-1])


def test_a_pose_that_was_recorded_often_is_one_sample():
    """What sticks for a whole pose contradicts nothing by being recorded 25 times."""
    arm = Arm("2r")
    rng = np.random.default_rng(4)
    q, tau = arm.recorded(40, 4, 0.0, 0.3)
    rows = np.repeat(np.arange(40), 25)
    once = supported_group(arm.group, q, tau)
    often = supported_group(arm.group, q[rows] + 1e-6 * rng.normal(size=(1000, 2)), tau[rows])
    assert once.whole
    assert often.whole
    assert often.p_value == pytest.approx(once.p_value, rel=1e-2)


@given(st.integers(1, 7), st.floats(0.01, 0.99), st.sampled_from([1e-3, 0.05]))
@settings(max_examples=30)
def test_each_of_many_relations_may_be_contradicted_at_its_share_of_the_level(number, at, level):
    """Seven relations are tested at once: one is contradicted below a seventh of the level."""
    arm = Arm("2r")
    p_values = dict.fromkeys(range(1, 8), 1.0)
    p_values[number] = at * level

    class Trial:
        def __init__(self, group, q, tau, noise):
            self.table = group.multiplication_table

        def free_directions(self):
            return 1.0

        def comparisons(self, members):
            return [Comparison(min(p_values[i] for i in members if i), 0.0, 0.0)]

        def p_value(self, members):
            return 1.0

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(f"{supported_group.__module__}.GroupTrial", Trial)
        found = supported_group(arm.group, *arm.recorded(20, 0), level=level)
    for tested in found.tested:
        contradicted = tested.p_value < level / 7
        assert (tested.judgement is Judgement.CONTRADICTED) == contradicted
    assert found.tested[number - 1].p_value == pytest.approx(at * level)


@given(st.integers(1, 7), st.integers(0, 2**32 - 1))
@settings(max_examples=10)
def test_p_values_of_several_joints_together_are_small_no_more_often_than_they_say(joints, seed):
    uniform = np.random.default_rng(seed).uniform(size=(2000, joints))
    together = np.array([over_joints(row.tolist()) for row in uniform])
    assert (together <= 1.0).all()
    for level in (0.01, 0.1, 0.5):
        assert np.sum(together < level) <= stats.binom.isf(1e-6, 2000, level)
    assert np.isnan(over_joints([]))
