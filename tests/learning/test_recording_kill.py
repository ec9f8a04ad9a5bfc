"""SIGKILL at random moments loses no committed command, and the resumed run ends the same."""

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from learning.recording_reader import RecordingReader
from tests.learning.recording_tools import files, tables

ROOT = Path(__file__).parents[2]


def start(path, result, steps):
    arguments = [sys.executable, "-m", "tests.learning.recording_child", path, result, str(steps)]
    return subprocess.Popen(arguments, cwd=ROOT, stdout=subprocess.PIPE, text=True)


def run_whole(directory, steps):
    with start(directory / "whole.sqlite", directory / "whole.txt", steps) as child:
        assert child.wait() == 0 or pytest.fail("the uninterrupted run failed")
    return (directory / "whole.txt").read_text(), tables(directory / "whole.sqlite")


def kill_and_resume(directory, kills, steps, longest_wait, seed):
    """Kill runs at random moments until enough kills hit a running run; return hits per run."""
    digest, content = run_whole(directory, steps)
    chance = random.Random(seed)
    done, hits, grown = 0, 0, 0
    while hits < kills:
        path, result = directory / f"run{done}.sqlite", directory / f"run{done}.txt"
        known = 0
        while not result.exists():
            with start(path, result, steps) as child:
                if hits < kills:
                    if chance.random() < 0.8:
                        child.stdout.readline()  # else it may die before it has begun
                    time.sleep(chance.uniform(0.0, longest_wait))
                    if child.poll() is None:
                        hits += 1
                        child.kill()
                child.wait()
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
    assert kill_and_resume(tmp_path, kills=5, steps=3000, longest_wait=0.1, seed=1) > 2


@pytest.mark.slow
def test_a_hundred_kills(tmp_path):
    assert kill_and_resume(tmp_path, kills=100, steps=6000, longest_wait=0.2, seed=2) > 30
