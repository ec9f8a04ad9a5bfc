"""Joint limits that are missing, and the angles to draw from in their place."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.joint_limits import TURN, finite_limits, one_turn, read_limits

ENDS = st.floats(-10.0, 10.0)


@st.composite
def limits(draw):
    rows = []
    for _ in range(draw(st.integers(1, 4))):
        low = draw(ENDS)
        high = low + draw(st.floats(0.01, 20.0))
        rows.append(
            [-np.inf if draw(st.booleans()) else low, np.inf if draw(st.booleans()) else high]
        )
    return np.array(rows)


@given(limits(), st.integers(0, 2**32 - 1))
def test_every_place_within_limits_is_also_within_the_finite_ones(box, seed):
    finite = finite_limits(box)
    assert np.isfinite(finite).all()
    both = np.isfinite(box).all(axis=1)
    np.testing.assert_array_equal(finite[both], box[both])
    assert (finite[:, 0] >= box[:, 0]).all()
    assert (finite[:, 1] <= box[:, 1]).all()
    assert np.allclose(np.ptp(finite[~both], axis=1), TURN)


@given(limits())
def test_one_turn_lies_within_the_limits_and_is_a_turn_where_they_allow_it(box):
    turn = one_turn(box)
    assert (turn[:, 0] >= box[:, 0] - 1e-9).all()
    assert (turn[:, 1] <= box[:, 1] + 1e-9).all()
    width = np.minimum(box[:, 1] - box[:, 0], TURN)
    assert np.allclose(turn[:, 1] - turn[:, 0], width)
    inner = np.clip([-np.pi, np.pi], box[:, :1], box[:, 1:])
    whole = (box[:, 0] <= -np.pi) & (box[:, 1] >= np.pi)
    np.testing.assert_allclose(turn[whole], inner[whole])


def test_what_a_file_means_by_no_limits():
    for lower, upper in ((None, None), (0.0, 0.0), (-1e16, 1e16), (-1.8e308, 1.8e308)):
        assert read_limits(lower, upper) == (-np.inf, np.inf)
    assert read_limits(0.0, 1.0) == (0.0, 1.0)
