"""Components of graphs, against SciPy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.sparse import csgraph

from isotorque.symbolic.common.connected_components import connected_components


@given(
    st.integers(0, 12).flatmap(
        lambda n: arrays(bool, (n, n), elements=st.integers(0, 9).map(lambda x: x == 0))
    )
)
def test_labels_are_those_of_scipy(linked):
    np.testing.assert_array_equal(
        connected_components(linked), csgraph.connected_components(linked, directed=False)[1]
    )


def test_a_long_path_is_one_component():
    assert not connected_components(np.eye(200, k=1)).any()
