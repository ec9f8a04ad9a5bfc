"""Relations by a rigid chain where few samples are no obstacle, and silence where it is none."""

import numpy as np
import pytest

from isotorque.learning.relations.chain_identification import identify_by_chain, with_chain
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def recording(name, count, noise=0.0, seed=0):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, gravity.n))
    return gravity, q, gravity.torque(q) + noise * rng.normal(size=q.shape)


@pytest.mark.parametrize(("name", "count"), [("3r", 6), ("ur5", 7), ("panda", 9)])
def test_the_whole_group_from_a_handful_of_samples(name, count):
    gravity, q, tau = recording(name, count)
    exact = primary_symmetries(gravity.potential)
    found = identify_by_chain(q, tau)
    assert found.order == exact.order
    assert all(relation in exact for relation in found.group)
    assert found.missing is None
    assert max(r.relation.bound.max() for r in found.relations) < 1e-6


def test_bounds_hold_for_the_arm_that_was_measured():
    gravity, q, tau = recording("ur5", 40, 0.05)
    found = identify_by_chain(q, tau, noise=MeasurementNoise(0.0, 0.05))
    test = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, 6))
    truth = gravity.torque(test)
    for entry in found.relations:
        relation = entry.relation
        error = np.abs(gravity.torque(relation.configuration(test)) - relation.Y * truth)
        assert np.all(error.max(axis=0) <= relation.bound + 1e-12)


def test_it_speaks_only_where_others_lack_samples():
    _, q, tau = recording("panda", 12)
    alone = learn_relations(q, tau)
    assert alone.missing is not None
    assert with_chain(alone, q, tau).method == "rigid chain"
    _, q, tau = recording("2r", 20)
    enough = learn_relations(q, tau)
    assert with_chain(enough, q, tau) is enough


@pytest.mark.parametrize("spoil", ["few", "zero", "spring", "rough"])
def test_no_chain_no_relations(spoil):
    _, q, tau = recording("panda", 12)
    if spoil == "few":
        q, tau = q[:3], tau[:3]
    elif spoil == "zero":
        tau = 0.0 * tau
    elif spoil == "spring":
        tau = tau + 5.0 * q
    else:  # so much noise that no relation would mean anything
        tau = tau + 3.0 * np.random.default_rng(1).normal(size=q.shape)
    assert identify_by_chain(q, tau) is None


@pytest.mark.parametrize(("constant", "claimed"), [(0.0, True), (0.5, False)])
def test_nothing_is_claimed_where_a_constant_torque_passes_for_noise(constant, claimed):
    gravity = GravityModel(load_robot("panda"))
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (40, 7))
    tau = gravity.torque(q) + 0.05 * rng.normal(size=q.shape)
    tau[:, 3] += constant
    assert (identify_by_chain(q, tau) is not None) is claimed


@pytest.mark.parametrize("seed", range(3))
def test_no_relation_is_claimed_that_could_be_wrong_by_a_twentieth(seed):
    """Whatever the noise that is stated: what is claimed is known to 5 % of the largest torque."""
    gravity = GravityModel(load_robot("ur5"))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (14, 6))
    torque = gravity.torque(q)
    claimed = []
    for noise in (0.01, 0.3, 1.0, 3.0):
        measured = torque + noise * rng.normal(size=q.shape)
        found = identify_by_chain(q, measured, noise=MeasurementNoise(0.0, noise))
        claimed.append(found is not None)
        for relation in found.group if found is not None else ():
            assert relation.bound.max() <= 0.05 * np.abs(measured).max()
    assert claimed[0]
    assert not all(claimed)
