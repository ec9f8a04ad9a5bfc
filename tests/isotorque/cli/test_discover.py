"""Discovery and relations from the command line; relations come from data alone."""

import json
import sqlite3

import pytest

from isotorque.cli.main import status


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("discovered")
    assert status(["discover", "2r", "--out", str(out), "--quiet", "--json"]) == 0
    return out


def test_discover_counts_what_happened(run, capsys):
    # the same command again replays the recording
    assert status(["discover", "2r", "--out", str(run), "--quiet", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["relations"] == 8
    assert len(found["torques"]) >= 2
    with sqlite3.connect(run / "run.sqlite") as database:
        query = "select outcome, count(*) from command where outcome is not null group by outcome"
        recorded = dict(database.execute(query))
    assert found["settled"] == recorded["settled"]
    assert found["limit_hits"] == recorded.get("limit", 0)


def test_relations_are_learned_written_and_judged(run, capsys):
    assert status(["relations", str(run), "--json", "--quiet"]) == 0
    learned = json.loads(capsys.readouterr().out)
    assert learned["order"] == 8
    assert learned["missing"] is None
    for relation in learned["relations"]:
        assert {"known", "standard_error", "support"} <= set(relation)
    assert json.loads((run / "relations.json").read_text())["relations"] == learned["relations"]
    arguments = ["verify", str(run / "relations.json"), "--robot", "2r", "--tolerance", "1e-6"]
    assert status([*arguments, "--json"]) == 0


@pytest.mark.parametrize(
    ("changes", "word"), [(["--seed", "5"], "seed"), (["--n-min", "8"], "n_min")]
)
def test_other_options_are_refused(run, capsys, changes, word):
    assert status(["discover", "2r", "--out", str(run), "--quiet", *changes]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert word in message


def test_another_robot_is_refused(run, capsys):
    assert status(["discover", "pendulum", "--out", str(run), "--quiet"]) == 2
    assert "robot" in capsys.readouterr().err


def test_a_directory_without_a_recording(tmp_path, capsys):
    assert status(["relations", str(tmp_path)]) == 2
    assert "run.sqlite" in capsys.readouterr().err
