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


def start(arguments, output=subprocess.PIPE):
    command = [sys.executable, "-m", "isotorque", *map(str, arguments), "--json"]
    return subprocess.Popen(command, stdout=output, stderr=output, text=True)


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


def motions(path):
    """How many motions are on disk; reading never disturbs who writes."""
    if not path.exists():
        return 0
    try:
        with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as database:
            return database.execute("select count(*) from command").fetchone()[0]
    except sqlite3.OperationalError:  # not yet a database
        return 0


def killed(child, path, enough):
    """Kill the child with SIGKILL once so many motions are on disk; False if it ends before."""
    while child.poll() is None:
        if motions(path) >= enough:
            child.kill()
            child.wait()
            return True
        time.sleep(0.001)
    return False


@pytest.mark.parametrize(
    "arguments",
    [["discover", "2r"], ["run", "2r", "--samples", 200, "--tolerance", 30]],
    ids=["discover", "run"],
)
def test_killed_commands_end_as_uninterrupted_ones(arguments, tmp_path):
    whole = start([*arguments, "--out", tmp_path / "whole"])
    text, error = whole.communicate()
    assert whole.returncode == 0, error
    expected, content = result(text), recorded(tmp_path / "whole" / "run.sqlite")
    chance = random.Random(len(arguments))
    kills = number = 0
    while kills < KILLS:
        out, known = tmp_path / str(number), 0
        number += 1
        # a run is killed again and again, ever further on, then left to end
        while kills < KILLS and known < len(content):
            child = start([*arguments, "--out", out], output=subprocess.DEVNULL)
            # often beyond what is recorded, at times before anything of it was read again
            enough = chance.randint(known, len(content)) if chance.random() < 0.9 else 0
            if not killed(child, out / "run.sqlite", enough):
                assert child.returncode == 0
                break
            kills += 1
            if (out / "run.sqlite").exists():
                count = motions(out / "run.sqlite")
                assert count >= max(known, enough)  # nothing that was there is ever gone
                known = count
        text, error = start([*arguments, "--out", out]).communicate()
        assert result(text) == expected, error
        assert recorded(out / "run.sqlite") == content
