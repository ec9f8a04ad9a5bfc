"""SIGKILL at random moments loses no committed command, and the resumed run ends the same."""

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from isotorque.learning.recordings.recording_reader import RecordingReader
from tests.learning.recordings.recording_tools import files, tables

ROOT = Path(__file__).parents[4]


def start(path, result, steps):
    arguments = [
        sys.executable,
        "-m",
        "tests.learning.recordings.recording_child",
        path,
        result,
        str(steps),
    ]
    return subprocess.Popen(arguments, cwd=ROOT, stdout=subprocess.PIPE, text=True)


def run_whole(directory, steps):
    with start(directory / "whole.sqlite", directory / "whole.txt", steps) as child:
        child.communicate()
        assert child.returncode == 0
    return (directory / "whole.txt").read_text(), tables(directory / "whole.sqlite")


def kill_at(child, target, chance):
    """Kill a run some moments after it has told of a step from the target on."""
    for line in child.stdout:
        if int(line) >= target:
            break
    time.sleep(chance.uniform(0.0, 0.005))
    was_running = child.poll() is None
    child.kill()
    return was_running


def kill_and_resume(directory, kills, steps, stride, seed):
    """Kill runs at random moments and resume them, all ending like the uninterrupted one.

    Returns how many of the kills came after new commands had been recorded.
    """
    digest, content = run_whole(directory, steps)
    chance = random.Random(seed)
    done, hits, grown = 0, 0, 0
    while hits < kills:
        path, result = directory / f"run{done}.sqlite", directory / f"run{done}.txt"
        known = 0
        while not result.exists():
            with start(path, result, steps) as child:
                if hits >= kills:
                    child.communicate()
                elif chance.random() < 0.2:  # while it starts, opens or begins
                    time.sleep(chance.uniform(0.0, 0.5))
                    hits += child.poll() is None
                    child.kill()
                else:
                    hits += kill_at(child, known + chance.randrange(stride), chance)
            if path.exists():
                with RecordingReader(path) as reader:
                    count = sum(part.commands for part in reader.parts)
                assert count >= known  # nothing that was there is ever gone
                grown += count > known
                known = count
        assert result.read_text() == digest
        assert tables(path) == content
        assert set(files(path)) == {path.name}  # no log left behind by a run that ended well
        done += 1
    return grown


def test_killed_runs_end_as_uninterrupted_ones(tmp_path):
    assert kill_and_resume(tmp_path, kills=5, steps=2000, stride=600, seed=1) >= 3


@pytest.mark.slow
def test_a_hundred_kills(tmp_path):
    assert kill_and_resume(tmp_path, kills=100, steps=4000, stride=800, seed=2) >= 60
