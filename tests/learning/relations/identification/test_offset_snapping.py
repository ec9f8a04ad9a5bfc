import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.identification.offset_snapping import snapped_offsets
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup
from tests.learning.static_data import known_potential


def shifted(group, x):
    exact = CandidateGroup(group.basis, group.A_sat, group.d_sat, group.Y)
    moved = exact.d + np.einsum("gij,j->gi", np.eye(len(x)) - exact.A, x)
    return exact, CandidateGroup(exact.basis, exact.A, wrap(moved), exact.Y)


@given(st.integers(0, 2**32 - 1))
def test_offsets_within_their_errors_are_rounded(seed):
    rng = np.random.default_rng(seed)
    exact, measured = shifted(known_potential("2r")[1], rng.uniform(-1e-3, 1e-3, 2))
    rounded = snapped_offsets(measured, np.full(exact.d.shape, 2e-3))
    np.testing.assert_allclose(wrap(rounded.d - exact.d), 0.0, atol=1e-12)


@given(st.floats(0.05, 0.7), st.floats(1e-6, 1e-2))
def test_offsets_that_disagree_are_left(angle, error):
    exact, measured = shifted(known_potential("2r")[1], np.array([angle, 0.0]))
    assert snapped_offsets(measured, np.full(exact.d.shape, error)) is None


def test_blurred_offsets_are_left():
    exact, measured = shifted(known_potential("2r")[1], np.zeros(2))
    assert snapped_offsets(measured, np.full(exact.d.shape, 0.1)) is None
