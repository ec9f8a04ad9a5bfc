import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.linear_model import LinearRegression

from isotorque.learning.export.forms.torque_form import evaluate, largest_difference
from isotorque.learning.export.forms.waves import Waves
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.strategies import known_arms
from tests.learning.export.fitted_models import QUICK, fitted_learner, samples


@given(arm=known_arms(max_joints=3), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=15, deadline=None)
def test_networks_in_the_domain_of_any_group(arm, seed):
    """The copy deepest in the domain is the representative that the fold finds."""
    group = arm.group
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (6, group.n))
    learner = FeedForwardNetwork(2, symmetries="canonical", group=group, **QUICK)
    learner.fit(q, rng.normal(size=q.shape))
    queries = rng.uniform(-9.0, 9.0, (20, group.n))
    expected = learner.predict(queries)
    found = evaluate(torque_form(learner), queries)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_processes_of_long_length_scale_are_waves_alone():
    """Three joints of the ur5 never feel gravity: no kernels for them."""
    q, torque = samples("ur5", 64)
    group = primary_symmetries(GravityModel(load_robot("ur5")).potential)
    learner = SymmetricGaussianProcess(group=group).fit(q, torque)
    form = torque_form(learner)
    assert isinstance(form, Waves)
    assert largest_difference(form, learner.predict) < 1e-12 * np.abs(torque).max()


def test_representatives_lie_in_the_domain():
    learner = fitted_learner("canonical", "3r")
    form = torque_form(learner)
    domain = FundamentalDomain(primary_symmetries(GravityModel(load_robot("3r")).potential))
    assert len(form.copies.linear) < 20 * domain.order


@given(seed=st.integers(0, 2**32 - 1), joints=st.integers(1, 4))
@settings(max_examples=30, deadline=None)
def test_three_angles_per_joint_determine_multi_affine_torques(seed, joints):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (3**joints, joints))
    learner = EquivariantTrigonometric(potential=False).fit(q, rng.normal(size=q.shape))
    grid = np.stack(np.meshgrid(*[np.arange(3) * 2 * np.pi / 3] * joints, indexing="ij"), axis=-1)
    torques = learner.predict(grid.reshape(-1, joints)).reshape(*[3] * joints, joints)
    size = max(1.0, np.abs(torques).max())
    assert largest_difference(Waves.of_samples_on_grid(torques), learner.predict) < 1e-12 * size


def test_the_parametric_model_becomes_few_waves():
    form = torque_form(fitted_learner("parametric"))
    k = form.frequencies[np.abs([form.cos, form.sin]).max(axis=(0, 2)) > 1e-9]
    assert sorted(map(tuple, k.tolist())) == [(1, 0), (1, 1)]


def test_other_learners_are_refused_by_name():
    with pytest.raises(InputError, match="LinearRegression"):
        torque_form(LinearRegression())


def test_an_unfitted_learner_is_refused():
    with pytest.raises(Exception, match="fit"):
        torque_form(EquivariantTrigonometric())
