"""Scores of torques: perfect is 1, and errors at any joint cost, whether it moves or not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import r2_score

from isotorque.learning.learners.registry import LEARNERS, LearningTask, learner_by_name
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.torque_score import TorqueRegressor, torque_score
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot


def samples(seed, joints, still):
    y = np.random.default_rng(seed).normal(size=(30, joints)) * np.linspace(1.0, 5.0, joints)
    y[:, list(still)] = 0.0
    return y


@given(st.integers(0, 2**20), st.integers(1, 5), st.data())
def test_errors_at_any_joint_cost_and_rounding_does_not(seed, joints, data):
    still = data.draw(st.sets(st.integers(0, joints - 1), max_size=joints - 1))
    y = samples(seed, joints, still)
    assert torque_score(y, y) == 1.0
    assert torque_score(y, y + 1e-14 * np.sin(y + 1.0)) == pytest.approx(1.0, abs=1e-12)
    joint = data.draw(st.integers(0, joints - 1))
    offset = np.zeros(joints)
    offset[joint] = data.draw(st.floats(0.5, 50.0))
    wrong = torque_score(y, y + offset)
    assert wrong < 0.99
    assert torque_score(y, y + 2 * offset) < wrong
    # nor does a joint that is right because nothing happens there hide errors elsewhere
    moving = y[:, [j for j in range(joints) if j not in still]]
    assert torque_score(y, 0.5 * y) == pytest.approx(torque_score(moving, 0.5 * moving))


@given(st.integers(0, 2**20), st.booleans())
def test_it_is_the_usual_score_where_every_joint_varies(seed, weighted):
    y = samples(seed, 3, ())
    rng = np.random.default_rng(seed + 1)
    guess, weight = (
        y + rng.normal(size=y.shape),
        rng.uniform(0.1, 2.0, len(y)) if weighted else None,
    )
    assert torque_score(y, guess, weight) == pytest.approx(r2_score(y, guess, sample_weight=weight))
    assert torque_score(y[:, 0], guess[:, 0], weight) == pytest.approx(
        r2_score(y[:, 0], guess[:, 0], sample_weight=weight)
    )


def test_torques_that_never_vary_are_right_or_wrong():
    assert torque_score(np.ones((4, 2)), np.ones((4, 2))) == 1.0
    assert torque_score(np.ones((4, 2)), np.full((4, 2), 1.1)) == 0.0


def test_a_perfect_model_of_an_arm_with_a_vertical_joint_scores_one():
    gravity = GravityModel(load_robot("panda"))
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (40, 7))

    class Perfect(TorqueRegressor):
        def predict(self, X):
            return gravity.torque(X) + 1e-13

    assert r2_score(gravity.torque(q), Perfect().predict(q)) < 0.9
    assert Perfect().score(q, gravity.torque(q)) == pytest.approx(1.0, abs=1e-9)


def test_every_learner_scores_by_it():
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (60, 2))
    torque = np.stack([np.sin(q[:, 0]), 0 * q[:, 0]], axis=1)
    assert EquivariantTrigonometric().fit(q, torque).score(q, torque) == pytest.approx(1.0)
    for name in LEARNERS:
        learner = learner_by_name(name, None, LearningTask(2, 60, False, "2r"))
        assert type(learner).score is TorqueRegressor.score, name
