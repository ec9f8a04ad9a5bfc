"""The benchmark of groups: both ways find the same, and it refuses what it cannot judge."""

import pytest

from benchmarks.groups import measure
from symbolic.errors import InputError


def test_both_ways_find_the_same():
    row = measure("2r", 1)
    assert row["order"] == 8
    assert row["same"]
    assert row["ratio"] > 0


def test_free_joints_are_refused():
    with pytest.raises(InputError, match=r"ur5.*free"):
        measure("ur5", 1)
