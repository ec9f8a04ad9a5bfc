"""``isotorque discover``: recorded, resumed, with torques chosen to confirm relations."""

import json
import sqlite3

import pytest

from isotorque.cli.main import status
from isotorque.learning.recordings.recording_reader import RecordingReader


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


NOISE = ["--angle-noise", "0.005", "--quiet", "--json"]


def outcome(capsys, *arguments):
    code = status([str(argument) for argument in arguments])
    return code, json.loads(capsys.readouterr().out)


@pytest.fixture(scope="module")
def confirmed(tmp_path_factory):
    out = tmp_path_factory.mktemp("confirmed")
    assert status(["discover", "2r", "--out", str(out), "--confirm", "4", *NOISE]) == 0
    return out


def motions(out):
    with RecordingReader(out / "run.sqlite") as reader:
        return [bytes(row[4]) for row in reader._rows(None, "discovery")]


def test_chosen_torques_follow_the_profiles(confirmed, tmp_path, capsys):
    plain = tmp_path / "plain"
    code, without = outcome(capsys, "discover", "2r", "--out", plain, *NOISE)
    assert code == 0
    code, document = outcome(capsys, "discover", "2r", "--out", confirmed, "--confirm", 4, *NOISE)
    assert code == 0
    counted = ("settled", "limit_hits", "timeouts")
    assert sum(document[k] for k in counted) == sum(without[k] for k in counted) + 4
    recorded = motions(confirmed)
    assert recorded[: len(motions(plain))] == motions(plain)
    assert document["relations"] == 8


def test_the_same_command_resumes_and_another_number_is_refused(confirmed, capsys):
    before = motions(confirmed)
    assert outcome(capsys, "discover", "2r", "--out", confirmed, "--confirm", 4, *NOISE)[0] == 0
    assert motions(confirmed) == before
    assert status(["discover", "2r", "--out", str(confirmed), "--confirm", "5", *NOISE]) == 2
    assert "confirm" in capsys.readouterr().err


def test_learning_goes_on_from_it(confirmed, capsys):
    code, document = outcome(
        capsys, "learn", "2r", "--out", confirmed, "--samples", 20, "--quiet", "--json"
    )
    assert (code, document["samples"]) == (0, 20)


def test_a_run_makes_the_same_discovery(confirmed, tmp_path, capsys):
    short = ["--out", tmp_path, "--samples", 20]
    _, document = outcome(capsys, "run", "2r", "--confirm", 4, *short, *NOISE)
    assert motions(tmp_path) == motions(confirmed)
    assert "--confirm 4" in document["setup"]["command"]


def test_fewer_than_none_is_refused(tmp_path, capsys):
    assert status(["discover", "2r", "--out", str(tmp_path), "--confirm", "-1"]) == 2
    assert "--confirm" in capsys.readouterr().err


def test_confirmation_that_a_chain_makes_needless_is_said(tmp_path, capsys):
    assert status(["discover", "ur5", "--confirm", "2", "--out", str(tmp_path), "--quiet"]) == 0
    said = capsys.readouterr().out
    assert "no torques were chosen to confirm the relations: relations are those of a rigid" in said
