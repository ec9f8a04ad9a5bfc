"""The gate before learning: too few relations stop a run, unless it was asked to go on."""

from __future__ import annotations

import json
import sqlite3

import pytest

from isotorque.cli.main import status

SHORT = ("--set", "scheme.max_targets=4")
"""A gate that is never passed ends after so many torques."""


def motions(directory):
    with sqlite3.connect(directory / "run.sqlite") as database:
        ((count,),) = database.execute("select count(*) from command")
    return count


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """A run that needs more relations than a pendulum has."""
    directory = tmp_path_factory.mktemp("gate") / "run"
    needs = ["--n-min", "99", *SHORT, "--samples", "60", "--quiet"]
    assert status(["run", "pendulum", "--out", str(directory), *needs]) == 1
    return directory, needs


def test_a_run_stops_before_learning_and_says_so(stopped):
    directory, _ = stopped
    report = json.loads((directory / "report.json").read_text())
    assert report["passed"] is False
    assert report["model"] is None
    assert report["exploration"] is None
    assert report["discovery"]["settled"] > 0
    assert "gate of 99 relations before learning: not passed, nothing learned" in report["summary"]
    refuted = [v["claim"] for v in report["verdicts"] if not v["passed"]]
    assert refuted == ["at least 99 relations are known and confirmed before learning"]
    assert not (directory / "model.json").exists()
    page = (directory / "report.html").read_text()
    assert page.index("not passed, nothing learned") < page.index("<h2>")
    assert "nothing was learned" in page


def test_it_goes_on_where_it_was_when_asked_to(stopped, capsys):
    directory, needs = stopped
    before = motions(directory)
    command = ["run", "pendulum", "--out", str(directory), *needs, "--learn-anyway"]
    assert status(command) == 0
    said = capsys.readouterr().out
    assert said.startswith("passed: relations: 4 of 4 known, none false; gate of 99 relations")
    assert "not passed, learned anyway" in said
    assert motions(directory) >= before + 60  # the discovery was not made anew
    report = json.loads((directory / "report.json").read_text())
    assert report["passed"]
    assert "--learn-anyway" in report["setup"]["command"]
    with sqlite3.connect(directory / "run.sqlite") as database:
        recorded = [text for (text,) in database.execute("select options from part")]
    assert [json.loads(text).get("learn_anyway", False) for text in recorded] == [False, True]


@pytest.mark.parametrize("strategy", ["direction-sampling", "lattice"])
def test_learn_stops_too(tmp_path, capsys, strategy):
    command = ["learn", "pendulum", "--out", str(tmp_path), "--n-min", "99", "--samples", "20"]
    command += [*SHORT, "--strategy", strategy, "--quiet", "--json"]
    assert status(command) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["model"] is None
    assert document["rmse_torque"] is None
    assert document["samples"] == 0
    assert "99 relations needed, 4 known" in document["remarks"][-1]
    assert "--learn-anyway" in document["remarks"][-1]
    assert not (tmp_path / "model.json").exists()
    assert status([*command, "--learn-anyway"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["rmse_torque"] < 1.0
    assert document["largest_error"] >= document["rmse_torque"]


@pytest.mark.parametrize("which", ["exact", "none"])
def test_where_no_relations_are_learned_none_are_waited_for(tmp_path, which):
    command = ["learn", "pendulum", "--out", str(tmp_path), "--n-min", "99", "--samples", "20"]
    assert status([*command, *SHORT, "--symmetries", which, "--quiet"]) == 0
