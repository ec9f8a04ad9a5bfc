"""The benchmark of groups: both ways find the same, and it refuses what it cannot judge."""

import pytest

from benchmarks import derive, groups
from benchmarks.batch import __main__ as batch
from benchmarks.groups import measure
from isotorque.symbolic.common.errors import InputError


def test_both_ways_find_the_same():
    row = measure("2r", 1)
    assert row["order"] == 8
    assert row["same"]
    assert row["ratio"] > 0


def test_free_joints_are_refused():
    with pytest.raises(InputError, match=r"ur5.*free"):
        measure("ur5", 1)


@pytest.mark.parametrize("benchmark", [batch, derive, groups])
def test_an_unknown_robot_is_refused_in_one_line(benchmark, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["benchmark", "no-such-arm"])
    assert benchmark.main() == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert "no-such-arm" in error
    assert "2r" in error
