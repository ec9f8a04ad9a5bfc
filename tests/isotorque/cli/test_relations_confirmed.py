"""``discover --confirm``: chosen torques are recorded, resumed, and known to ``learn``."""

import json

import pytest

from isotorque.cli.main import status
from isotorque.learning.recordings.recording_reader import RecordingReader

NOISE = ["--angle-noise", "0.005", "--quiet", "--json"]


def run(capsys, *arguments):
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
    code, without = run(capsys, "discover", "2r", "--out", plain, *NOISE)
    assert code == 0
    code, document = run(capsys, "discover", "2r", "--out", confirmed, "--confirm", 4, *NOISE)
    assert code == 0
    counted = ("settled", "limit_hits", "timeouts")
    assert sum(document[k] for k in counted) == sum(without[k] for k in counted) + 4
    recorded = motions(confirmed)
    assert recorded[: len(motions(plain))] == motions(plain)
    assert document["relations"] == 8


def test_the_same_command_resumes_and_another_number_is_refused(confirmed, capsys):
    before = motions(confirmed)
    assert run(capsys, "discover", "2r", "--out", confirmed, "--confirm", 4, *NOISE)[0] == 0
    assert motions(confirmed) == before
    assert status(["discover", "2r", "--out", str(confirmed), "--confirm", "5", *NOISE]) == 2
    assert "confirm" in capsys.readouterr().err


def test_learning_goes_on_from_it(confirmed, capsys):
    code, document = run(
        capsys, "learn", "2r", "--out", confirmed, "--samples", 20, "--quiet", "--json"
    )
    assert (code, document["samples"]) == (0, 20)


def test_a_run_makes_the_same_discovery(confirmed, tmp_path, capsys):
    short = ["--out", tmp_path, "--samples", 20]
    _, document = run(capsys, "run", "2r", "--confirm", 4, *short, *NOISE)
    assert motions(tmp_path) == motions(confirmed)
    assert "--confirm 4" in document["setup"]["command"]


def test_fewer_than_none_is_refused(tmp_path, capsys):
    assert status(["discover", "2r", "--out", str(tmp_path), "--confirm", "-1"]) == 2
    assert "--confirm" in capsys.readouterr().err
