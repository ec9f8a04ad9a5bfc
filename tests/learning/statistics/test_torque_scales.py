"""Scales and signs of single torques are named; noise and other causes are not called so."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.potential.potential_fit import all_frequencies
from isotorque.learning.statistics.misfit_advice import misfit_advice
from isotorque.learning.statistics.torque_scales import torque_scales
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot


@pytest.fixture(scope="module")
def arms():
    return {name: GravityModel(load_robot(name)) for name in ("2r", "3r")}


def recorded(arm, poses, seed, noise=0.02):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, arm.n))
    return q, arm.torque(q) + noise * rng.normal(size=q.shape)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("name", "poses"), [("2r", 20), ("3r", 30)])
def test_a_wrong_scale_of_one_joint_is_found_with_its_error(arms, name, poses, seed):
    q, tau = recorded(arms[name], poses, seed)
    joint, scale = seed % q.shape[1], (1.3, -1.0, 0.5, 10.0)[seed]
    tau[:, joint] *= scale
    found = torque_scales(q, tau, all_frequencies(q.shape[1]))
    truth = np.ones(q.shape[1])
    truth[joint] = scale
    if q.shape[1] == 2:  # only the ratio shows
        truth /= truth[np.argmin(np.abs(found.scales - 1.0))]
    assert found.joints.tolist() == list(range(q.shape[1]))
    assert np.all(np.abs(found.scales - truth) <= 5.0 * found.errors)
    assert found.errors.max() < 0.03 * np.abs(truth).max()
    assert ("wrong sign" in str(found)) == (scale == -1.0)


@pytest.mark.parametrize("seed", range(5))
def test_rigid_arms_springs_and_offsets_have_no_wrong_scale(arms, seed):
    for name, poses in (("2r", 20), ("3r", 30)):
        q, tau = recorded(arms[name], poses, seed, noise=0.2)
        frequencies = all_frequencies(q.shape[1])
        for measured in (tau, tau + 0.5 * np.arange(q.shape[1]), tau + 0.3 * q):
            assert torque_scales(q, measured, frequencies) is None
            assert misfit_advice(q, measured, frequencies) == ""


def test_joints_that_are_not_coupled_have_no_common_scale():
    q = np.random.default_rng(0).uniform(-2.0, 2.0, (30, 2))
    tau = np.cos(q) * [5.0, -3.0]
    assert torque_scales(q, tau, all_frequencies(2)) is None


def test_a_gain_is_named_and_breaks_no_relation(arms):
    q, tau = recorded(arms["2r"], 60, 1)
    found = learn_relations(q, tau * [1.3, 1.0])
    assert found.missing is None
    assert found.order == 8
    assert "beside gravity the samples show a gain of" in found.note


def test_more_samples_are_not_asked_for_where_a_scale_is_wrong(arms):
    q, tau = recorded(arms["2r"], 60, 1)
    missing = learn_relations(q, tau * [1.0, -1.0]).missing
    assert "wrong sign" in missing
    assert "more samples will not help" in missing
    assert "about" not in missing


def test_nor_where_nothing_known_explains_the_torques(arms):
    q, tau = recorded(arms["2r"], 60, 2)
    swapped = learn_relations(q, tau[:, ::-1]).missing
    degrees = learn_relations(np.rad2deg(q), tau).missing
    for missing in (swapped, degrees):
        assert "more samples will not help" in missing
        assert "order of columns, degrees" in missing


def test_more_samples_are_asked_for_where_only_noise_is_large(arms):
    q, tau = recorded(arms["2r"], 12, 3, noise=0.5)
    missing = learn_relations(q, tau).missing
    assert "more samples" in missing
    assert "will not help" not in missing
