"""Tests of the dictionary with a fixed budget, and of learners taught from it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.neighbors import KNeighborsRegressor

from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.memory.dictionary_learner import DictionaryLearner
from isotorque.learning.learners.memory.sample_dictionary import SampleDictionary
from isotorque.symbolic.common.errors import InputError
from tests.learning.learners import planar_arm

GROUP = planar_arm.group()


def orbit_distance(a, b, group):
    """Distance of two orbits by brute force (differences wrapped by component)."""
    if group is None:
        return np.linalg.norm((a - b + np.pi) % (2 * np.pi) - np.pi)
    metric = sum(A.T @ A for A in group.A_sat)
    isometry = np.linalg.cholesky(metric / np.sqrt(np.linalg.det(metric))).T
    return min(
        np.linalg.norm(isometry @ ((a - A @ b - d + np.pi) % (2 * np.pi) - np.pi))
        for A, d in zip(group.A_sat, group.d_sat, strict=True)
    )


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), symmetric=st.booleans())
def test_replacement_follows_the_rule(seed, symmetric):
    """Against the rule applied by brute force to a plain list."""
    rng = np.random.default_rng(seed)
    group = GROUP if symmetric else None
    kept = SampleDictionary(6, group)
    plain = []
    for age, q in enumerate(rng.uniform(-np.pi, np.pi, (25, 2))):
        if len(plain) == 6:
            union = [x for x, _ in plain] + [q]
            crowd = [
                sum(
                    sorted(orbit_distance(union[j], union[i], group) for j in range(7) if j != i)[
                        :2
                    ]
                )
                for i in range(6)
            ]
            slot = int(np.argmin(crowd))
            plain[slot] = (q, age)
        else:
            plain.append((q, age))
        kept.add(q, np.array([float(age)]))
        assert np.array_equal(kept.q, [x for x, _ in plain])
        assert kept.torque[:, 0].tolist() == [a for _, a in plain]


def test_lingering_does_not_crowd_out_what_is_far():
    """Thousands of samples in one place: the others stay."""
    kept = SampleDictionary(20)
    rng = np.random.default_rng(0)
    far = rng.uniform(-3, 3, (10, 2))
    for q in far:
        kept.add(q, q)
    for q in rng.normal(0, 1e-3, (3000, 2)):
        kept.add(q, q)
    assert len(kept) == 20
    distances = np.linalg.norm(kept.q[:, None] - far[None], axis=2).min(axis=0)
    assert (distances < 0.05).all()


def test_saved_and_restored_dictionary_goes_on_alike():
    rng = np.random.default_rng(1)
    kept = SampleDictionary(15, GROUP)
    for q in rng.uniform(-3, 3, (40, 2)):
        kept.add(q, 2 * q, 0.5)
    again = SampleDictionary(15, GROUP)
    again.restore(kept.to_arrays())
    for q in rng.uniform(-3, 3, (40, 2)):
        kept.add(q, 2 * q)
        again.add(q, 2 * q)
    for name, values in kept.to_arrays().items():
        assert np.array_equal(values, again.to_arrays()[name])


def test_draws_come_from_the_dictionary():
    kept = SampleDictionary(5)
    for x in range(5):
        kept.add(np.array([x / 5]), np.array([float(x)]), x / 10)
    q, torque, weights = kept.draw(np.random.default_rng(0), 200)
    assert set(torque[:, 0]) == {0.0, 1.0, 2.0, 3.0, 4.0}
    assert np.allclose(q[:, 0], torque[:, 0] / 5)
    assert np.allclose(weights, torque[:, 0] / 10)


def test_no_budget_is_refused():
    with pytest.raises(InputError, match="budget"):
        SampleDictionary(0)


def test_teaching_from_the_dictionary_helps_an_online_learner():
    """The same samples with and without replay: the local linear map gains."""
    rng = np.random.default_rng(2)
    sums = np.stack([rng.uniform(-np.pi / 2, 0, 300), rng.uniform(-np.pi, 0, 300)], axis=1)
    q = np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)
    dense = rng.uniform(-np.pi, np.pi, (500, 2))
    errors = []
    for replay in (0, 10):
        learner = DictionaryLearner(
            LocalLinearMap(0.3, kernel_width=1.5, inner_iterations=None, group=GROUP),
            budget=200,
            replay=replay,
            group=GROUP,
        ).fit(q, planar_arm.torque(q))
        error = learner.predict(dense) - planar_arm.torque(dense)
        errors.append(np.sqrt(np.mean(error**2)))
    assert errors[1] < 0.5 * errors[0]


def test_a_batch_regressor_learns_online():
    """Nearest neighbours, refitted on demand; one torque per sample as a flat array works too."""
    q = np.linspace(-1, 1, 300)[:, None]
    learner = DictionaryLearner(KNeighborsRegressor(2, weights="distance"), budget=50)
    for i in range(300):
        learner.partial_fit(q[i : i + 1], np.sin(q[i]))
    assert learner.predict(q).shape == (300,)
    assert np.abs(learner.predict(q) - np.sin(q[:, 0])).max() < 0.05
    assert len(learner.dictionary_) == 50


def test_negative_replay_is_refused():
    with pytest.raises(InputError, match="replay"):
        DictionaryLearner(LocalLinearMap(), replay=-1).fit([[0.0]], [[0.0]])
