"""Snapping: what is special is found, what is not stays, and both are said."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.structure.snapping import LEVEL
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import chain_of_tree, random_chain, random_poses


def fitted(chain, poses, seed, noise=0.0):
    rng = np.random.default_rng(seed)
    q = random_poses(rng, poses, chain.n)
    torque = chain.torque(q) + noise * rng.normal(size=q.shape)
    return RigidChain(torque_noise=noise or None).fit(q, torque)


@pytest.mark.parametrize("n", range(2, 7))
def test_a_generic_chain_keeps_its_numbers(n):
    chain = random_chain(np.random.default_rng(n), n)
    learner = fitted(chain, 9, 0)
    found = learner.snapped()
    assert not found.hypotheses
    q = random_poses(np.random.default_rng(1), 20, n)
    assert np.abs(found.chain.torque(q) - chain.torque(q)).max() < 1e-8


def test_right_angles_of_an_arm_are_found_in_noise():
    """All twists of the ur5, and a torque nearer to the truth than without."""
    gravity = GravityModel(load_robot("ur5"))
    chain = chain_of_tree(load_robot("ur5").tree)
    better, right = 0, 0
    for seed in range(6):
        learner = fitted(chain, 30, seed, 0.05)
        found = learner.snapped()
        twists = np.rad2deg(found.form.twists[:4]) % 180
        right += bool(np.abs(twists - [0, 90, 0, 0]).max() < 1e-12)
        assert found.p_value > 1e-6
        q = random_poses(np.random.default_rng(99), 200, 6)
        error = [
            np.sqrt(np.mean((c.torque(q) - gravity.torque(q)) ** 2))
            for c in (found.chain, learner.chain_)
        ]
        better += error[0] < error[1]
    assert better >= 5
    assert right >= 5


@pytest.mark.parametrize("tilt", [0.0, 0.5, 3.0])
def test_a_tilt_is_kept_when_it_is_seen(tilt):
    """Half a degree of the second axis: far more than the noise hides."""
    rotations = chain_of_tree(load_robot("3r").tree).rotations.copy()
    levers = chain_of_tree(load_robot("3r").tree).levers
    c, s = np.cos(np.deg2rad(tilt)), np.sin(np.deg2rad(tilt))
    rotations[2] = rotations[2] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    learner = fitted(ChainParameters.of(rotations, levers), 40, 1, 0.01)
    found = learner.snapped()
    (twist,) = [h for h in found.hypotheses if h.kind == "twist" and h.joint == 2] or [None]
    assert (twist is not None) == (tilt == 0.0)
    if twist is not None:
        assert np.rad2deg(twist.visible) < 0.5


def test_a_lever_too_small_to_be_seen_is_named_with_what_would_have_been():
    chain = chain_of_tree(load_robot("2r").tree)
    levers = chain.levers.copy()
    small = np.argmin(np.abs(levers[1]))
    levers[1, small] = 0.01
    learner = fitted(chain.with_levers(levers), 25, 0, 0.05)
    found = learner.snapped()
    gone = [h for h in found.hypotheses if h.kind.startswith("lever") and h.joint == 1]
    assert gone
    assert all(0.01 < h.visible < 0.3 for h in gone)
    assert found.smallest_visible_lever >= gone[0].visible
    assert "would have been seen" in str(gone[0])


@pytest.mark.parametrize("deviation", [3.8, 4.2, 4.6])
@pytest.mark.parametrize("what", ["twist", "lever"])
def test_nothing_is_set_that_its_own_test_contradicts(what, deviation):
    """About four standard errors off: the likelihood ratio forbids each, together they pass."""
    plain = chain_of_tree(load_robot("3r").tree)

    def bent(size):
        rotations, levers = plain.rotations.copy(), plain.levers.copy()
        if what == "twist":
            c, s = np.cos(size), np.sin(size)
            rotations[2] = rotations[2] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        else:
            levers[2, np.argmin(np.abs(levers[2]))] += size
        return ChainParameters.of(rotations, levers)

    noise, size = 0.05, 1e-3
    q = random_poses(np.random.default_rng(0), 40, 3)
    seen = np.sqrt(np.sum((bent(size).torque(q) - plain.torque(q)) ** 2)) / noise / size
    for seed in range(3):
        found = fitted(bent(deviation / seen), 40, seed, noise).snapped()
        assert found.hypotheses
        assert all(hypothesis.p_value >= LEVEL for hypothesis in found.hypotheses)


def test_what_would_have_been_seen_is_seen_as_often_as_stated():
    """A lever of the size that is called visible is kept in about 95 % of recordings."""
    chain = chain_of_tree(load_robot("2r").tree)
    small = int(np.argmin(np.abs(chain.levers[1])))
    learner = fitted(chain, 25, 0, 0.05)
    kind = f"lever {'xy'[small]}"
    (found,) = [h for h in learner.snapped().hypotheses if (h.joint, h.kind) == (1, kind)]
    levers = chain.levers.copy()
    levers[1, small] += found.visible
    kept = 0
    for seed in range(12):
        again = fitted(chain.with_levers(levers), 25, seed, 0.05).snapped()
        kept += not any((h.joint, h.kind) == (1, kind) for h in again.hypotheses)
    assert kept >= 9
