import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.pairing.free_regression import regress_relation
from isotorque.symbolic.common.angles import wrap
from isotorque.verify.testing.strategies import known_arms


@given(known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_exact_pairs_give_the_relation_back(arm, seed):
    rng = np.random.default_rng(seed)
    n = arm.group.n
    relation = arm.group[int(rng.integers(arm.group.order))]
    q_r = rng.uniform(-np.pi, np.pi, (n + 5, n))
    q_s = wrap(relation.configuration(q_r))
    found = regress_relation(q_r, q_s, relation.A, relation.d)
    np.testing.assert_allclose(found.A, relation.A, atol=1e-9)
    np.testing.assert_allclose(wrap(found.d - relation.d), 0.0, atol=1e-9)
    paper_form = q_r @ found.M.T + q_s @ found.N.T - found.d
    np.testing.assert_allclose(wrap(paper_form), 0.0, atol=1e-8)
    assert found.pairs == n + 5


def test_standard_errors_are_those_of_repeated_experiments():
    A, d = np.array([[-1.0, 0.0], [2.0, 1.0]]), np.array([0.0, np.pi])
    rng = np.random.default_rng(0)
    q_r = rng.uniform(-1.5, 1.5, (30, 2))
    found = [
        regress_relation(q_r, wrap(q_r @ A.T + d + 0.01 * rng.normal(size=q_r.shape)), A, d)
        for _ in range(400)
    ]
    np.testing.assert_allclose(np.std([f.A for f in found], axis=0), found[0].A_error, rtol=0.45)
    np.testing.assert_allclose(
        np.std([wrap(f.d - d) for f in found], axis=0), found[0].d_error, rtol=0.45
    )


def test_too_few_or_flat_pairs_give_none():
    A, d = np.eye(2), np.zeros(2)
    q = np.random.default_rng(1).normal(size=(3, 2))
    assert regress_relation(q, q, A, d) is None
    flat = np.stack([np.linspace(0, 1, 9), np.full(9, 0.3)], axis=1)
    assert regress_relation(flat, flat, A, d) is None
