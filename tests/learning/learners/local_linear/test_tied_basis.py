"""Tied local linear functions are equivariant for any group, prototypes and weights."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from tests.learning.learners.random_groups import groups, worst_asymmetry


def with_random_weights(group, rng):
    """A learner that has learned nothing but has prototypes and weights."""
    learner = RecursiveLeastSquares(0.8, kernel_width=1.0, group=group)
    q = rng.uniform(-np.pi, np.pi, (4, group.n))
    learner.fit(q, rng.normal(size=q.shape))
    learner._solved.solution = [rng.normal(size=part.shape) for part in learner._solve()]
    return learner


@settings(max_examples=25, deadline=None)
@given(group=groups(), seed=st.integers(0, 2**32 - 1))
def test_exactly_equivariant_whatever_the_weights(group, seed):
    rng = np.random.default_rng(seed)
    learner = with_random_weights(group, rng)
    q = rng.uniform(-np.pi, np.pi, (5, group.n))
    assert worst_asymmetry(learner.predict, group, q) < 1e-12


@settings(max_examples=10, deadline=None)
@given(group=groups(), seed=st.integers(0, 2**32 - 1))
def test_what_is_exported_is_equivariant_too(group, seed):
    rng = np.random.default_rng(seed)
    form = torque_form(with_random_weights(group, rng))
    q = rng.uniform(-np.pi, np.pi, (3, group.n))
    assert worst_asymmetry(lambda x: evaluate(form, x), group, q) < 1e-12
