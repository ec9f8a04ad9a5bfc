"""The distance to the average over a group bounds what the average changes, and is no less."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.reynolds_average import symmetric_part_error
from isotorque.verify.testing.strategies import known_arms


@given(known_arms(max_joints=3), st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_averaging_changes_no_torque_by_more(arm, seed):
    """The average is taken here point by point: of Y g(A q + d), which is A^T of its gradient."""
    rng = np.random.default_rng(seed)
    group, true = arm.group, arm.gravity.potential.to_float()
    m = len(true)
    U = TrigonometricPolynomial(
        true.frequencies, true.cos + rng.normal(size=m), true.sin + rng.normal(size=m)
    )
    q = rng.uniform(-np.pi, np.pi, (100, group.n))
    average = np.mean([r.torque(U.gradient(r.configuration(q))) for r in group], axis=0)
    error = symmetric_part_error(U, group.basis, group.A_sat, group.d_sat, group.Y)
    change = np.abs(U.gradient(q) - average).max(axis=0)
    assert (change <= error + 1e-9).all()


@given(st.floats(-5.0, 5.0), st.floats(1e-3, 5.0))
def test_of_one_wave_the_odd_part_is_lost(even, odd):
    """a cos q + b sin q under q -> -q: b sin q goes, and with it a torque of up to b."""
    U = TrigonometricPolynomial([[1]], [even], [odd])
    A, Y = np.array([[[1.0]], [[-1.0]]]), np.array([[1.0], [-1.0]])
    error = symmetric_part_error(U, np.eye(1, dtype=np.int64), A, np.zeros((2, 1)), Y)
    np.testing.assert_allclose(error, [odd], rtol=1e-12)


@given(st.floats(1e-3, 0.02), st.floats(1.5, 8.0))
@settings(max_examples=8)
def test_no_group_is_found_below_the_error_of_its_relations(phase, factor):
    """A wave that is out of step by a phase: the eight relations of the 2R arm cost something."""
    U = TrigonometricPolynomial([[1, 0], [1, 1], [2, 1]], [0.0, 0.0, 6.0 * phase], [18.4, 6.1, 0.0])
    whole = maximal_groups(U, 10.0)[0]
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (2000, 2))
    torque = U.gradient(q)
    worst = max(np.abs(U.gradient(r.configuration(q)) - r.torque(torque)).max() for r in whole)
    for group in maximal_groups(U, worst / factor):
        for relation in group:
            error = np.abs(U.gradient(relation.configuration(q)) - relation.torque(torque))
            assert error.max() <= worst / factor + 1e-12
