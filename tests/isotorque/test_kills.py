"""SIGKILL of whole commands at random moments: resumed, they end as if never interrupted.

ISOTORQUE_KILLS=100 kills each command that often; 5 by default.
"""

import json
import os
import random
import sqlite3
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.slow
KILLS = int(os.environ.get("ISOTORQUE_KILLS", "5"))


def start(arguments):
    command = [sys.executable, "-m", "isotorque", *map(str, arguments), "--json"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def result(text):
    document = json.loads(text)
    document.get("totals", {}).pop("seconds", None)
    for stage in document.get("stages", ()):
        stage.pop("seconds")
    return document


def recorded(path):
    with sqlite3.connect(path) as database:
        columns = [r[1] for r in database.execute("pragma table_info(command)")]
        return list(database.execute(f"select {', '.join(columns)} from command order by 1, 2"))


@pytest.mark.parametrize(
    "arguments",
    [["discover", "2r"], ["run", "2r", "--samples", 200]],
    ids=["discover", "run"],
)
def test_killed_commands_end_as_uninterrupted_ones(arguments, tmp_path):
    whole = start([*arguments, "--out", tmp_path / "whole"])
    began = time.perf_counter()
    text, error = whole.communicate()
    duration = time.perf_counter() - began
    assert whole.returncode == 0, error
    expected, content = result(text), recorded(tmp_path / "whole" / "run.sqlite")
    chance = random.Random(len(arguments))
    kills = grown = number = 0
    while kills < KILLS:
        out, known = tmp_path / str(number), 0
        number += 1
        while True:
            child = start([*arguments, "--out", out])
            # the first second is spent on imports: most moments shall lie within the motion
            moment = chance.uniform(0.3, 1.0) * duration if chance.random() < 0.9 else 0.1
            try:
                text, error = child.communicate(timeout=moment if kills < KILLS else None)
            except subprocess.TimeoutExpired:
                child.kill()
                child.communicate()
                kills += 1
                if (out / "run.sqlite").exists():
                    count = len(recorded(out / "run.sqlite"))
                    assert count >= known  # nothing that was there is ever gone
                    grown += count > known
                    known = count
                continue
            assert child.returncode == 0, error
            break
        assert result(text) == expected
        assert recorded(out / "run.sqlite") == content
    assert grown >= 1
