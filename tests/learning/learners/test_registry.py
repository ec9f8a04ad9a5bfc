"""Learners by name: what they are told, and batch learners behind an online one."""

import numpy as np
import pytest

from isotorque.learning.learners.memory.collected_samples import CollectedSamples
from isotorque.learning.learners.registry import (
    BATCH_LEARNERS,
    LEARNERS,
    ONLINE_LEARNERS,
    LearningTask,
    check_learner,
    learner_by_name,
    online_learner,
)
from isotorque.symbolic.common.errors import InputError


@pytest.mark.parametrize("name", sorted(LEARNERS))
def test_online_learners_are_those_that_learn_one_by_one(name):
    learner = learner_by_name(name, None, LearningTask(2, 10, robot="2r"))
    # a rigid chain takes them one by one too, but estimates nothing from the first few
    assert hasattr(learner, "partial_fit") == (name in ONLINE_LEARNERS or name == "rigid-chain")
    assert (name in BATCH_LEARNERS) == (name not in ONLINE_LEARNERS)
    assert hasattr(learner, "fit")
    assert learner.group is None


def test_noise_is_estimated_or_validated_where_there_is_any():
    exact, noisy = LearningTask(2, 50), LearningTask(2, 50, noisy=True)
    assert learner_by_name("gaussian-process", None, exact).noise == 0.0
    assert learner_by_name("gaussian-process", None, noisy).noise is None
    assert learner_by_name("network", None, exact).validation_fraction == 0.0
    assert learner_by_name("network", None, noisy).validation_fraction > 0.0


def test_unknown_names_are_refused_with_those_that_are_known():
    with pytest.raises(InputError, match=r"gaussian-process.*parametric"):
        check_learner("parrot")
    with pytest.raises(InputError, match="local-linear-map"):
        online_learner("network", None)


def test_a_parametric_learner_needs_a_robot():
    learner = learner_by_name("parametric", None, LearningTask(2, 10))
    with pytest.raises(InputError, match="robot"):
        learner.fit(np.zeros((2, 2)), np.zeros((2, 2)))


def test_collected_samples_are_all_fitted_once_and_unweighted():
    fits, taught = [], []

    class Batch:
        def fit(self, q, torque):
            fits.append((q.tolist(), torque.tolist()))
            return self

    class Leader:
        def partial_fit(self, q, torque, weights):
            taught.append(weights)

        def predict(self, q):
            return np.full(np.shape(q), 7.0)

    collected = CollectedSamples(Leader(), Batch)
    collected.partial_fit([[1.0]], [[2.0]], [0.5])
    buffer = np.array([[3.0]])
    collected.partial_fit(buffer, [[4.0]], [0.0])
    buffer[:] = 9.0  # what was given may change afterwards
    assert collected.fitted_learner() is collected.fitted_learner()
    assert fits == [([[1.0], [3.0]], [[2.0], [4.0]])]
    assert taught == [[0.5], [0.0]]
    assert collected.predict([[0.0]]).tolist() == [[7.0]]
    collected.partial_fit([[5.0]], [[6.0]])
    collected.fitted_learner()
    assert len(fits) == 2
    assert fits[1][0] == [[1.0], [3.0], [5.0]]
