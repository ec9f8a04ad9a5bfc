"""The explorations beside the constrained one: guided, without constraints, goals, babbling."""

import numpy as np
import pytest

from isotorque.learning.arm import Settled
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
    Cell,
    Recorder,
    TrueStaticTorques,
    rmse,
)
from tests.learning.learners import planar_arm


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
        Guided(), learner, np.random.default_rng(0), domain=Cell(), torque_range=RANGE
    )
    steps = list(exploration.steps(100))
    for step in steps[1:]:
        assert np.abs(step.outcome.q - step.target).max() < 1e-12
        assert Cell().contains(step.target)
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
        domain=Cell(),
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
                domain=Cell(),
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
