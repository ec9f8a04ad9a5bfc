"""Full disks and power failures: clear errors, and what was recorded before stays readable."""

import itertools
import math
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.database.commit_log import CommitLog
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError, translated
from isotorque.learning.recordings.recording_reader import RecordingReader
from tests.learning.recordings.recording_tools import INFO, NAMES, ToyArm, explore, tables

ROOT = Path(__file__).parents[4]
COMMANDS = ["apply", "apply", "play", "home"] * 100


def resumed(path):
    with Recording.open_or_create(path, INFO) as recording:
        return list(explore(RecordedArm(ToyArm(), recording), COMMANDS, 1))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "run.sqlite"
    resumed(path)
    return path


@pytest.mark.parametrize("pages", [16, 20, 30])
def test_a_file_that_may_not_grow(tmp_path, whole, pages):
    path = tmp_path / "run.sqlite"
    seen = []
    with Recording.create(path, INFO) as recording:
        # SQLite then answers just as it does on a full disk.
        recording._log.connection.execute(f"pragma max_page_count = {pages}")
        arm = RecordedArm(ToyArm(), recording)
        with pytest.raises(RecordingError, match=r"disk is full .*a disk with free space"):
            seen.extend(explore(arm, COMMANDS, 1))
        with pytest.raises(RecordingError, match="last command is interrupted"):
            arm.apply([0.0, 0.0])
    with RecordingReader(path) as reader:
        assert reader.parts[0].commands == len(seen) > 3
    everything = resumed(path)
    assert everything[: len(seen)] == seen
    assert tables(path) == tables(whole)


def test_a_process_that_may_not_write_more(tmp_path, whole):
    path = tmp_path / "run.sqlite"
    script = (
        "import sys; from pathlib import Path\n"
        "from tests.learning.recordings.failures.test_full_disks import resumed\n"
        "resumed(Path(sys.argv[1]))\n"
    )

    def limit_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))

    child = subprocess.run(
        [sys.executable, "-B", "-c", script, path],
        cwd=ROOT,
        preexec_fn=limit_files,
        capture_output=True,
        text=True,
    )
    assert child.returncode == 1
    assert "RecordingError" in child.stderr
    assert "accepted: a disk with free space" in child.stderr
    with RecordingReader(path) as reader:
        assert 3 < reader.parts[0].commands < len(COMMANDS)
    resumed(path)
    assert tables(path) == tables(whole)


def test_a_disk_too_full_for_a_new_file_leaves_nothing_behind(tmp_path):
    script = (
        "import sys; from pathlib import Path\n"
        "from isotorque.learning.recordings.recording import Recording\n"
        "from tests.learning.recordings.recording_tools import INFO\n"
        "Recording.create(Path(sys.argv[1]), INFO)\n"
    )
    child = subprocess.run(
        [sys.executable, "-B", "-c", script, tmp_path / "run.sqlite"],
        cwd=ROOT,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000)),
        capture_output=True,
        text=True,
    )
    assert "RecordingError" in child.stderr
    assert "a disk with free space" in child.stderr
    assert not (tmp_path / "run.sqlite").exists()
    Recording.create(tmp_path / "run.sqlite", INFO).close()


def test_running_out_of_space_outside_sqlite_is_said_as_well():
    error = translated(Path("run.sqlite"), OSError(28, "No space left on device"))
    assert str(error).startswith("run.sqlite: disk is full (No space left on device); accepted:")


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """Files of a run that is still going on, nothing of it moved out of the log yet."""
    path = tmp_path_factory.mktemp("running") / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        list(itertools.islice(explore(arm, COMMANDS, 1), 60))
        for suffix in ("", "-wal"):
            shutil.copy(f"{path}{suffix}", f"{path}.copy{suffix}")
    return path.with_name("run.sqlite.copy")


@settings(max_examples=80)
@given(st.floats(0.0, 1.0), st.sampled_from(["cut", "zeros", "garbage"]), st.integers(0, 9))
def test_a_power_failure_leaves_a_beginning_of_the_run(
    tmp_path_factory, running, whole, where, how, seed
):
    # What had not reached the disk is missing, zero, or (a torn write) arbitrary.
    path = tmp_path_factory.mktemp("failed") / "run.sqlite"
    shutil.copy(running, path)
    log = bytearray(Path(f"{running}-wal").read_bytes())
    at = int(where * len(log))
    rest = {
        "cut": b"",
        "zeros": bytes(len(log) - at),
        "garbage": np.random.default_rng(seed).bytes(len(log) - at),
    }[how]
    Path(f"{path}-wal").write_bytes(log[:at] + rest)
    with Recording.open(path, INFO) as recording:
        rows = list(recording.rows())
    assert len(rows) <= 61
    assert rows == [row[2:-1] for row in tables(whole)["command"][: len(rows)]]
    if where == 1.0:
        assert len(rows) == 61


def waits(sync_seconds, times, path):
    """Which commits at these times waited for the disk, as SQLite was told."""
    clock = iter(times)
    log = CommitLog(path, sync_seconds, clock=lambda: next(clock))
    mode = "normal"
    found = []

    def watch(statement):
        nonlocal mode
        if statement.startswith("pragma synchronous"):
            mode = statement.split()[-1]
        elif statement == "commit":
            found.append(mode == "full")

    log.connection.set_trace_callback(watch)
    try:
        for number in range(len(times)):
            log.commit([("insert into session values (1, ?, '', '')", (number,))])
    finally:
        log.close()
    return found


def test_a_commit_waits_for_the_disk_when_the_last_wait_is_long_ago(tmp_path):
    path = tmp_path / "run.sqlite"
    Recording.create(path, INFO).close()
    times = [0.0, 0.5, 0.9, 1.0, 1.5, 7.0, 7.1, 7.9, 8.1]
    long_ago = [True, False, False, True, False, True, False, False, True]
    assert waits(1.0, times, path) == long_ago
    assert all(waits(0.0, times, path))
    assert not any(waits(math.inf, times, path)[1:])


def test_the_settings_of_sqlite_are_the_documented_ones(tmp_path):
    with Recording.create(tmp_path / "run.sqlite", INFO) as recording:
        ask = recording._log.connection.execute
        assert ask("pragma journal_mode").fetchone() == ("wal",)
        assert ask("pragma synchronous").fetchone() == (1,)  # normal
        recording.save_checkpoint("a", {})
        assert ask("pragma synchronous").fetchone() == (1,)


def test_a_failed_checkpoint_leaves_the_one_before(tmp_path):
    info = RunInfo("toy", "0123abcd", NAMES)
    with Recording.create(tmp_path / "run.sqlite", info) as recording:
        recording.save_checkpoint("net", {"w": np.ones(3)})
        recording._log.connection.execute("pragma max_page_count = 16")
        with pytest.raises(RecordingError, match="disk is full"):
            recording.save_checkpoint("net", {"w": np.ones(100_000)})
        np.testing.assert_array_equal(recording.load_checkpoint("net").arrays["w"], np.ones(3))
