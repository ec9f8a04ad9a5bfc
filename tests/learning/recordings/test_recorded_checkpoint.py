"""Checkpoints hold named arrays exactly, and nothing that needs pickle."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays, scalar_dtypes

from isotorque.learning.recordings.recorded_checkpoint import pack_arrays, unpack_arrays
from isotorque.symbolic.common.errors import InputError

NAMES = st.text(st.characters(codec="utf-8", exclude_characters="\x00"), min_size=1, max_size=8)


@given(st.dictionaries(NAMES, arrays(scalar_dtypes(), array_shapes(min_dims=0, min_side=0))))
def test_arrays_come_back_bit_for_bit(named):
    blob = pack_arrays(named)
    again = unpack_arrays(blob)
    assert again.keys() == named.keys()
    for name, array in named.items():
        assert again[name].dtype == array.dtype
        assert again[name].shape == array.shape
        assert again[name].tobytes() == array.tobytes()
    assert pack_arrays(named) == blob


def test_numpy_reads_them():
    blob = pack_arrays({"file": [1.0], "text": ["a", "bc"]})
    with np.load(io.BytesIO(blob)) as archive:
        assert sorted(archive.files) == ["file", "text"]


def test_objects_are_refused():
    with pytest.raises(InputError, match="net is of type object"):
        pack_arrays({"net": np.array([{}])})
