"""Errors made of waves of any speed are climbed; lies with huge entries do not stay unseen."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.verify_claims import Claim, Oracle
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.relations.ball_bounds import certified_error
from isotorque.verify.relations.residual import Residual
from isotorque.verify.relations.verify_relation import verify_relation
from isotorque.verify.relations.wave_search import WaveSearch
from isotorque.verify.verdict import Status

FEW = settings(
    max_examples=25, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
ORACLES = {name: Oracle(load_robot(name).tree) for name in ("2r", "3r")}
speeds = st.integers(21, 150).flatmap(lambda bits: st.integers(2**bits, 2 ** (bits + 1)))


@FEW
@given(st.lists(speeds, min_size=1, max_size=3), st.data())
def test_waves_of_independent_phases_meet(fast, data):
    """cos(F_j q_j) and cos q_j, weighted, can all be 1 together: the bound is what there is."""
    n = len(fast)
    weights = data.draw(st.lists(st.floats(0.1, 2.0), min_size=n, max_size=n))
    U = TrigonometricPolynomial(np.eye(n, dtype=int), [0.0] * n, weights)
    A = [[fast[i] if i == j else 0 for j in range(n)] for i in range(n)]
    error = Residual.of(A, [0] * n, [-1] * n, U)
    for joint in range(n):
        q = WaveSearch(error).highest(joint)
        found = certified_error(A, [0] * n, [-1] * n, U, q)[joint]
        assert 0.999 * 2 * weights[joint] < found <= error.bound()[joint]
        assert np.abs(q).max() <= np.pi


@FEW
@given(st.integers(-(2**149), 2**149), st.sampled_from(["2r", "3r"]), st.integers(0, 7), st.data())
def test_no_lie_with_a_huge_entry_passes_below_what_an_oracle_finds(arms, entry, name, at, data):
    arm = arms[name]
    true = arm.group[at]
    i, j = (data.draw(st.integers(0, true.n - 1)) for _ in range(2))
    A = true.A.copy()
    A[i, j] += float(entry)
    lie = SymmetryRelation(A, true.d, true.Y)
    truth = ORACLES[name].judge(
        Claim("entry", A.tolist(), true.d.tolist(), true.Y.astype(int).tolist(), 0.0)
    )
    rng = np.random.default_rng(0)
    seen = max(truth.errors(q)[k] for q, k in truth.worst(rng))
    if not seen > 1e-6:  # the entry is one that no torque feels
        return
    verdict = verify_relation(lie, arm.gravity, 0.999 * float(seen), simplify=False)
    assert verdict.status is Status.REFUTED
    assert max(truth.errors(verdict.counterexample.tolist())) > 0.999 * seen


@pytest.mark.parametrize("entry", [2.0**21, 2.0**40, 2.0**63, 1e45])
def test_a_lie_that_only_the_fast_wave_shows_is_refuted(arms, entry):
    """The tolerance is all but the largest error: the slow and the fast wave must both peak."""
    true = arms["2r"].group[0]
    A = true.A.copy()
    A[1, 0] += entry
    lie = SymmetryRelation(A, true.d, true.Y)
    bound = 2 * 6.13125
    verdict = verify_relation(lie, arms["2r"].gravity, 0.999 * bound)
    assert verdict.status is Status.REFUTED
    with mpmath.workdps(80):
        q1, q2 = (mpmath.mpf(x) for x in verdict.counterexample.tolist())
        there = mpmath.cos(q1 + entry * q1 + q2) - mpmath.cos(q1 + q2)
        assert abs(there) * mpmath.mpf("6.13125") > 0.999 * bound
