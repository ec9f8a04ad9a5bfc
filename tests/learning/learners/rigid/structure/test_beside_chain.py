"""What samples leave room for beside a chain covers what is there."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.structure.beside_chain import (
    CABLE,
    COMPLIANCE,
    CONSTANT,
    SCALE,
    SPRING,
    beside_chain,
)
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import KINDS, random_chain, random_poses

NOISE = 0.05


def torque_beside(kind, q, joint, size):
    values = {CONSTANT: np.ones_like(q), SPRING: q, CABLE: np.sin(2.0 * q + 0.4)}[kind]
    return size * values * np.eye(q.shape[1])[joint]


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sampled_from(KINDS), st.booleans())
@settings(max_examples=30)
def test_exact_chains_have_nothing_beside_them(seed, n, kind, noisy):
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n, kind)
    q = random_poses(rng, 25, n)
    tau = chain.torque(q) + noisy * 1e-3 * rng.normal(size=q.shape)
    learner = RigidChain(torque_noise=1e-3 if noisy else None).fit(q, tau)
    if not learner.verdict_.accepted:
        return
    found = beside_chain(learner.fit_, 3.0)
    assert all(np.isfinite(term.largest).all() for term in found.terms)
    if not noisy:
        assert max(term.largest.max() for term in found.terms) < 1e-6 * max(np.abs(tau).max(), 1.0)


def test_what_is_allowed_for_covers_what_is_there():
    covered = []
    gravity = GravityModel(load_robot("2r"))
    for seed in range(30):
        rng = np.random.default_rng(seed)
        q = random_poses(rng, 25, 2)
        tau = gravity.torque(q) + torque_beside(CONSTANT, q, seed % 2, 0.03)
        learner = RigidChain(torque_noise=NOISE).fit(q, tau + NOISE * rng.normal(size=q.shape))
        constant = next(t for t in beside_chain(learner.fit_, 3.0).terms if t.kind == CONSTANT)
        covered.append(constant.largest[seed % 2] >= 0.03)
    assert all(covered)


def test_relations_are_missed_where_they_turn_a_joint_round():
    gravity = GravityModel(load_robot("2r"))
    q = random_poses(np.random.default_rng(0), 20, 2)
    tau = gravity.torque(q) + NOISE * np.random.default_rng(1).normal(size=q.shape)
    terms = {t.kind: t for t in beside_chain(RigidChain().fit(q, tau).fit_, 3.0).terms}
    odd = SymmetryRelation(-np.eye(2), [0.0, 0.0], [-1.0, -1.0])
    shifted = SymmetryRelation(np.eye(2), [np.pi, 0.0], [1.0, 1.0])
    assert (terms[CONSTANT].missed(odd) == 2.0 * terms[CONSTANT].largest).all()
    assert not terms[CONSTANT].missed(shifted).any()
    assert not terms[SPRING].missed(odd).any()
    assert terms[SPRING].missed(shifted)[0] > 0.0
    assert terms[SPRING].missed(shifted)[1] == 0.0
    assert (terms[CABLE].missed(odd) > 0.0).all()
    unit = SymmetryRelation(np.eye(2), [0.0, 0.0], [1.0, 1.0])
    for kind in (SCALE, COMPLIANCE):
        assert (terms[kind].missed(odd) == 2.0 * terms[kind].largest).all()
        assert not terms[kind].missed(unit).any()
