"""Explorations on an ideal planar arm: constrained, guided, unconstrained, goals, babbling."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import Settled
from isotorque.learning.exploration.explored_share import ExploredShare
from isotorque.learning.exploration.strategies import (
    ConstrainedGoalBabbling,
    DirectionSampling,
    ExplorationSettings,
    GoalBabbling,
    GuidedDirectionSampling,
    MotorBabbling,
)
from isotorque.learning.exploration.targets import Phase
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.symbolic.common.errors import InputError
from tests.learning.exploration.explored_arm import (
    HOME,
    RANGE,
    Recorder,
    ScriptedArm,
    ToyDomain,
    TrueStaticTorques,
    constrained,
    rmse,
)
from tests.learning.learners import planar_arm


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_algorithm_2_step_by_step(seed):
    """Eq. 13, 15, 16, targets in the domain, torques in the set, for any seed."""
    static_torques = TrueStaticTorques()
    exploration, _ = constrained(seed, static_torques=static_torques)
    steps = list(exploration.steps(150))
    assert [s.number for s in steps] == list(range(150))
    before_last, previous, last = None, steps[0].outcome.q, steps[0]
    for step in steps[1:]:
        q = step.outcome.q
        assert isinstance(step.outcome, Settled)
        assert static_torques.contains(step.torque * 0.9999)
        assert step.phase is Phase.HOME or ToyDomain().contains(step.target)
        wanted, moved = step.target - previous, q - previous
        lengths = np.linalg.norm(wanted) * np.linalg.norm(moved)
        cosine = wanted @ moved / lengths if lengths > 0 else 0.0
        assert step.weight == pytest.approx((1 + cosine) / 2, abs=1e-9)
        if step.phase is Phase.DIRECTION:
            start = last.target if not last.turned else before_last
            assert np.linalg.norm(step.target - start) <= 0.3 + 1e-12
            alpha = (step.target - start) @ moved
            assert step.alpha == pytest.approx(alpha, abs=1e-9)
            assert step.turned == (alpha < -1e-15)
        else:
            assert np.isnan(step.alpha)
            assert not step.turned
        before_last, previous, last = previous, q, step
    assert exploration.counts.settled == 150 == len(static_torques.added)


def test_direction_is_kept_until_it_ends():
    """Undisturbed, targets are equally spaced on a line until the domain's boundary."""
    answers = [(-0.7, -0.7)] + [(-0.7 - 1e-3 * i, -0.7) for i in range(60)]
    exploration, _ = constrained(
        3,
        Recorder(),
        ScriptedArm(answers),
        settings=ExplorationSettings(step_width=0.05, home_probability=0.0, turn_angle=np.pi),
    )
    targets = np.array([s.target for s in exploration.steps(40)])
    steps = np.diff(targets, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    full = lengths > 0.05 - 1e-9
    assert full.sum() > 30
    assert lengths.max() < 0.05 + 1e-12
    sums = np.stack([targets[:, 0], targets.sum(axis=1)], axis=1)
    to_boundary = np.abs(sums[:, [0, 0, 1, 1]] - [0, -np.pi / 2, 0, -np.pi]).min(axis=1)
    assert to_boundary[1:][~full].max(initial=0) < 1e-3
    bends = np.linalg.norm(np.diff(steps, axis=0), axis=1) > 1e-9
    assert to_boundary[1:-1][bends].max() < 0.05
    assert (~bends).sum() > 15


def test_return_when_the_arm_leaves_the_direction():
    """alpha < 0: sample kept, target reset to the previous observed configuration."""
    answers = [(-0.7, -0.7), (-0.6, -0.8), (-0.65, -0.75), (-0.7, -0.7)]
    learner = Recorder()
    quiet = ExplorationSettings(home_probability=0.0, noise=0.0, step_width=0.1)
    for seed in range(10):
        learner = Recorder()
        exploration, _ = constrained(seed, learner, ScriptedArm(answers), settings=quiet)
        steps = list(exploration.steps(4))
        assert len(learner.samples) == 4
        if steps[1].turned:
            assert np.linalg.norm(steps[2].target - [-0.7, -0.7]) == pytest.approx(0.1)
        else:
            assert np.linalg.norm(steps[2].target - steps[1].target) == pytest.approx(0.1)
    opposite = [s for s in steps if s.turned]
    assert all(s.alpha < 0 for s in opposite)


def test_limits_are_marked_and_not_learned():
    """A limit: torque marked, nothing learned, next direction starts from where the arm is."""
    static_torques = TrueStaticTorques()
    learner = Recorder()
    answers = [(-0.7, -0.7), None, (-0.1, -0.1), (-0.1, -0.2)]
    exploration, _ = constrained(
        0,
        learner,
        ScriptedArm(answers),
        static_torques=static_torques,
        settings=ExplorationSettings(home_probability=0.0, step_width=0.1),
    )
    steps = list(exploration.steps(3))
    assert not steps[1].learned
    assert len(learner.samples) == 2
    assert len(static_torques.marked) == 1
    assert np.linalg.norm(steps[2].target) == pytest.approx(0.1)
    assert exploration.counts.inadmissible == 1


def test_home_visits_are_single_steps():
    """With probability 1 every target is home; with 0 none is; in between about as many."""
    share = {}
    for probability in (0.0, 0.2, 1.0):
        exploration, _ = constrained(1, settings=ExplorationSettings(home_probability=probability))
        steps = list(exploration.steps(300))[1:]
        visits = [s for s in steps if s.phase is Phase.HOME]
        assert all(np.array_equal(s.target, exploration.home) for s in visits)
        share[probability] = len(visits) / len(steps)
    assert share[0.0] < 0.02
    assert share[1.0] == 1.0
    assert 0.13 < share[0.2] < 0.28


def test_learns_the_torque_map_and_sees_the_whole_domain():
    """Starting from one torque, the arm learns its torques on the whole torus."""
    rng = np.random.default_rng(0)
    explored = ExploredShare(ToyDomain().sample(rng, 400), 0.25, planar_arm.group())
    exploration, learner = constrained(0, explored=explored)
    steps = list(exploration.steps(600))
    shares = [s.explored for s in steps]
    assert shares == sorted(shares)
    assert shares[-1] > 0.95
    assert rmse(learner) < 0.1
    assert exploration.counts.inadmissible == 0


def test_stops_when_the_error_stays_low():
    """Ends after the asked number of iterations below e_max, not before."""
    wanted = ExplorationSettings(target_error=0.2, window=50, windows_below=2)
    exploration, _ = constrained(0, settings=wanted)
    errors = [s.window_error for s in exploration.steps(3000) if s.window_error is not None]
    assert exploration.finished
    assert max(errors[-2:]) <= 0.2
    assert len(errors) == 2 or errors[-3] > 0.2
    assert exploration.counts.settled == 50 * len(errors)
    assert not list(exploration.steps(10))


def test_does_not_stop_before_the_domain_is_explored():
    """A required share that is never reached keeps the exploration going."""
    explored = ExploredShare(np.array([[0.5, 0.5]]), 1e-6)
    exploration, _ = constrained(
        0,
        explored=explored,
        settings=ExplorationSettings(
            target_error=5.0, window=20, windows_below=1, required_share=1.0
        ),
    )
    assert len(list(exploration.steps(200))) == 200


def test_the_same_seed_gives_the_same_exploration_in_one_go_or_two():
    """Deterministic, and going on later changes nothing."""
    whole, _ = constrained(7)
    pieces, _ = constrained(7)
    first = [s.torque for s in whole.steps(120)]
    second = [s.torque for s in pieces.steps(50)] + [s.torque for s in pieces.steps(70)]
    assert np.array_equal(first, second)


def test_free_joints_are_left_alone():
    """A joint without torque range gets zero torque and no part of any direction."""
    arm = ScriptedArm([(0.0, 0.01 * i) for i in range(100)])
    exploration = DirectionSampling(
        arm, Recorder(), np.random.default_rng(0), torque_range=[0.0, 5.0]
    )
    steps = list(exploration.steps(50))
    assert not np.any([s.torque[0] for s in steps])
    assert np.ptp([s.target[0] for s in steps]) == 0.0
    assert np.std([s.torque[1] for s in steps]) > 0


def test_steps_are_measured_in_weighted_units():
    """Eq. 13 with w: the weighted norm of a step is epsilon."""
    answers = [(0.0, 0.0)] + [(1e-3 * i, 1e-3 * i) for i in range(50)]
    exploration = DirectionSampling(
        ScriptedArm(answers),
        Recorder(),
        np.random.default_rng(0),
        torque_range=[1.0, 1.0],
        settings=ExplorationSettings(
            joint_weights=(1.0, 5.0), home_probability=0.0, turn_angle=np.pi, step_width=0.2
        ),
    )
    targets = np.array([s.target for s in exploration.steps(30)])
    lengths = np.linalg.norm(np.diff(targets, axis=0) * [1.0, 5.0], axis=1)
    assert lengths == pytest.approx(0.2)


def test_a_home_torque_that_does_not_hold_is_refused():
    exploration, _ = constrained(0, home_torque=[100.0, 0.0])
    with pytest.raises(InputError, match="home torque"):
        next(exploration.steps(1))


@pytest.mark.parametrize(
    "wrong",
    [
        {"torque_range": [0.0, 0.0]},
        {"torque_range": [np.nan, 1.0]},
        {"home_torque": [1.0]},
        {"settings": {"step_width": 0.0}},
        {"settings": {"noise": np.nan}},
        {"settings": {"home_probability": 1.5}},
        {"settings": {"target_error": -1.0}},
        {"settings": {"window": np.inf}},
    ],
)
def test_refuses_unusable_input(wrong):
    """Every unusable number is named."""
    name = next(iter(wrong.get("settings", wrong)))
    make = ExplorationSettings if "settings" in wrong else constrained
    with pytest.raises(InputError, match=name):
        make(**wrong.get("settings", wrong))


def test_guided_sampling_visits_every_target_and_measures_there():
    """Placed and held: outcomes are the targets, labels the measured torques, nothing is lost."""

    class Guided(planar_arm.IdealArm):
        def place(self, q):
            assert np.abs(q).max() <= np.pi
            self.q = np.array(q)

        def hold(self):
            return Settled(self.q.copy(), planar_arm.torque(self.q)[0], 0.0)

    learner = RecursiveLeastSquares(group=planar_arm.group())
    exploration = GuidedDirectionSampling(
        Guided(), learner, np.random.default_rng(0), domain=ToyDomain(), torque_range=RANGE
    )
    steps = list(exploration.steps(100))
    for step in steps[1:]:
        assert np.abs(step.outcome.q - step.target).max() < 1e-12
        assert ToyDomain().contains(step.target)
        assert not step.projected
    assert rmse(learner) < 0.0053


def test_without_constraints_torques_are_inadmissible_and_learned():
    """The original runs into limits and its model suffers (Fig. 7)."""
    learner = LocalLinearMap(0.25, group=planar_arm.group(), inner_iterations=None)
    exploration = DirectionSampling(
        planar_arm.IdealArm(),
        learner,
        np.random.default_rng(0),
        torque_range=RANGE,
        home_torque=HOME,
        settings=ExplorationSettings(learn_inadmissible=True),
    )
    steps = list(exploration.steps(600))
    assert exploration.counts.inadmissible > 0.1 * len(steps)
    assert exploration.counts.projected == 0
    assert rmse(learner) > 0.5


def test_goal_babbling_walks_to_its_goals():
    """Targets lie on straight paths of equal steps between home and goals."""
    goals = np.array([[-1.2, -0.2], [-0.3, -2.0]])
    learner = LocalLinearMap(0.25, group=planar_arm.group(), inner_iterations=None, replay=2)
    exploration = ConstrainedGoalBabbling(
        planar_arm.IdealArm(),
        learner,
        np.random.default_rng(0),
        goals,
        static_torques=TrueStaticTorques(),
        domain=ToyDomain(),
        torque_range=RANGE,
        home_torque=HOME,
        settings=ExplorationSettings(step_width=0.1, home_probability=0.0),
    )
    targets = np.array([s.target for s in exploration.steps(300)])
    assert np.linalg.norm(np.diff(targets, axis=0), axis=1).max() < 0.1 + 1e-9
    for goal in goals:
        assert np.linalg.norm(targets - goal, axis=1).min() < 1e-12
    reached = learner.predict(goals) - planar_arm.torque(goals)
    assert np.abs(reached).max() < 0.2


def test_goals_outside_the_domain_are_refused():
    with pytest.raises(InputError, match="goal"):
        list(
            ConstrainedGoalBabbling(
                planar_arm.IdealArm(),
                Recorder(),
                np.random.default_rng(0),
                [[1.0, 1.0]],
                static_torques=TrueStaticTorques(),
                domain=ToyDomain(),
                torque_range=RANGE,
                home_torque=HOME,
            ).steps(1)
        )


def test_unconstrained_goal_babbling_and_motor_babbling_command_what_they_like():
    """No set of static torques: nothing is projected; motor babbling covers the torque box."""
    for make in (
        lambda **o: GoalBabbling(
            planar_arm.IdealArm(), Recorder(), np.random.default_rng(0), [[-1.0, -1.0]], **o
        ),
        lambda **o: MotorBabbling(planar_arm.IdealArm(), Recorder(), np.random.default_rng(0), **o),
    ):
        exploration = make(torque_range=RANGE, home_torque=HOME)
        steps = list(exploration.steps(400))
        assert exploration.counts.projected == 0
        assert exploration.counts.commands == 400
    torques = np.array([s.torque for s in steps[1:]])
    assert all(s.phase is Phase.MOTOR and s.target is None for s in steps[1:])
    assert np.abs(torques).max(axis=0) == pytest.approx(RANGE, rel=0.05)
    assert 0.2 < exploration.counts.inadmissible / 400 < 0.9
