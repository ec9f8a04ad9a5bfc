"""``learn`` goes on from a discovery; what it saves is judged by ``verify``."""

import json

import pytest

from isotorque.cli.main import status


@pytest.fixture(scope="module")
def learned(tmp_path_factory):
    out = tmp_path_factory.mktemp("learned")
    assert status(["discover", "2r", "--out", str(out), "--seed", "3", "--quiet"]) == 0
    arguments = ["--learner", "recursive-least-squares", "--samples", "120", "--quiet"]
    assert status(["learn", "2r", "--out", str(out), *arguments]) == 0
    return out


def test_learning_goes_on_from_the_recorded_discovery(learned, capsys):
    arguments = ["--learner", "recursive-least-squares", "--samples", "120", "--quiet", "--json"]
    assert status(["learn", "2r", "--out", str(learned), *arguments]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["samples"] == 120
    assert document["rmse_torque"] < 0.0053  # what the paper has after 54,000 samples
    assert len(document["rmse_by_joint"]) == 2
    assert document["curve"][-1]["rmse"] == pytest.approx(document["rmse_torque"])


def test_the_saved_model_is_judged(learned, capsys):
    model = str(learned / "model.json")
    assert status(["verify", model, "--robot", "2r", "--tolerance", "0.0053", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["passed"]
    assert status(["verify", model, "--robot", "2r", "--tolerance", "1e-9", "--json"]) == 1
    assert not json.loads(capsys.readouterr().out)["passed"]
    assert status(["verify", model, "--robot", "3r"]) == 2
    assert "joints" in capsys.readouterr().err


def test_a_report_of_the_judgement_is_written(learned, tmp_path, capsys):
    page = tmp_path / "verdicts.html"
    assert status(["verify", str(learned), "--robot", "2r", "--report", str(page)]) == 0
    assert "tested" in page.read_text()


def test_an_empty_directory_has_nothing_to_judge(tmp_path, capsys):
    assert status(["verify", str(tmp_path), "--robot", "2r"]) == 2
    assert "relations.json or model.json" in capsys.readouterr().err
