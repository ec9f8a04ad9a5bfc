"""The whole command in processes of its own: killed and resumed, and every figure drawn."""

import json
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.slow
FIGURES = ("1", "2a", "2b", "3", "4", "5", "6", "7a", "7b", "9", "10", "11", "12a", "12b", "13")
MORE = ("14a", "14b", "15a", "15b")


def start(part, out):
    command = [sys.executable, "-m", "isotorque", "paper", part, "--quick", "--quiet", "--json"]
    return subprocess.Popen(
        [*command, "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def rows(text):
    return [row for row in json.loads(text)["rows"] if not row["timed"]]


def test_killed_and_resumed_it_gives_the_same_table(tmp_path):
    whole = start("3r", tmp_path / "whole")
    text, error = whole.communicate()
    assert whole.returncode == 0, error
    cut = start("3r", tmp_path / "cut")
    parts = tmp_path / "cut" / "parts"
    while not (parts.is_dir() and list(parts.glob("*.json"))):
        assert cut.poll() is None, cut.communicate()[1]
        time.sleep(0.01)
    cut.send_signal(signal.SIGKILL)
    cut.communicate()
    kept = {path.name: path.stat().st_mtime_ns for path in parts.glob("*.json")}
    resumed = start("3r", tmp_path / "cut")
    again, error = resumed.communicate()
    assert resumed.returncode == 0, error
    assert rows(again) == rows(text)
    assert {name: (parts / name).stat().st_mtime_ns for name in kept} == kept


def test_interrupted_it_says_so_and_keeps_what_is_done(tmp_path):
    running = start("all", tmp_path)  # much is left to do when the first piece is done
    parts = tmp_path / "parts"
    while not (parts.is_dir() and list(parts.glob("*.json"))):
        assert running.poll() is None, running.communicate()[1]
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    _, error = running.communicate(timeout=120)
    assert running.returncode == 130
    assert error == "interrupted: everything recorded so far is kept\n"
    assert all(json.loads(path.read_text()) for path in parts.glob("*.json"))


def test_every_figure_and_every_row(tmp_path):
    running = start("all", tmp_path)
    text, error = running.communicate()
    assert running.returncode == 0, error
    assert len(rows(text)) > 60
    page = (tmp_path / "paper.html").read_text()
    for number in FIGURES + MORE:
        assert f'id="fig{number}"' in page
        for ending in ("svg", "pdf"):
            assert (tmp_path / "figures" / f"fig{number}.{ending}").stat().st_size > 1000
