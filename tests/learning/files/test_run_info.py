"""What a run was made with is compared by what a file can hold."""

import dataclasses
import json
import math
from enum import StrEnum

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import isotorque
from isotorque.learning.files.run_info import RunInfo, generator_state
from isotorque.learning.files.software_versions import software_versions
from isotorque.symbolic.common.errors import InputError

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=8,
)


@settings(max_examples=50)
@given(st.dictionaries(st.text(), PLAIN))
def test_options_survive_json_and_equal_themselves(options):
    info = RunInfo("r", "d", ("a",), options=options)
    again = dataclasses.replace(info, options=json.loads(json.dumps(dict(info.options))))
    assert info == again
    assert list(info.differences(again)) == []


def test_enumerations_arrays_and_infinite_limits_become_plain():
    class Mode(StrEnum):
        FAST = "fast"

    options = {"mode": Mode.FAST, "limits": ((-math.inf, math.inf),), "home": np.array([1.0])}
    info = RunInfo("r", "d", ["a"], physics=Mode.FAST, options=options)
    assert info.options == {"mode": "fast", "limits": [["-inf", "inf"]], "home": [1.0]}
    assert type(info.physics) is str
    assert info.joint_names == ("a",)


@pytest.mark.parametrize("value", [math.nan, object(), {1, 2}, {"a": b"x"}])
def test_options_that_are_not_plain_are_refused(value):
    with pytest.raises(InputError, match="options is"):
        RunInfo("r", "d", ("a",), options={"x": value})


def test_a_run_needs_joints_and_a_name():
    with pytest.raises(InputError, match="joint_names"):
        RunInfo("r", "d", ())
    with pytest.raises(InputError, match="part"):
        RunInfo("r", "d", ("a",), part="")


@pytest.mark.parametrize("kind", ["PCG64", "MT19937", "Philox", "SFC64", "PCG64DXSM"])
def test_every_generator_continues_from_its_recorded_state(kind):
    rng = np.random.Generator(getattr(np.random, kind)(1))
    rng.random(3)
    rng.integers(0, 5, dtype=np.int32)
    info = RunInfo("r", "d", ("a",), generator=generator_state(rng))
    other = np.random.Generator(getattr(np.random, kind)(2))
    other.bit_generator.state = json.loads(json.dumps(info.generator))
    np.testing.assert_array_equal(other.random(9), rng.random(9))


def test_versions_name_what_decides_the_digits():
    versions = software_versions()
    assert versions["numpy"] == np.__version__
    assert {"python", "pin", "numba"} <= versions.keys()
    assert versions["isotorque"] == isotorque.__version__  # whatever an old installation says
