"""Files that cannot be continued are refused in one clear line, and left as they were."""

import dataclasses
import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.recordings.database.schema import SCHEMA_VERSION
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.symbolic.common.errors import InputError
from tests.learning.recordings.recording_tools import INFO, ToyArm, explore, files, tables

ROOT = Path(__file__).parents[4]


def record(path, steps=12, info=INFO):
    with Recording.create(path, info) as recording:
        arm = RecordedArm(ToyArm(), recording)
        list(explore(arm, ["apply", "play", "home"] * (steps // 3), 1))
        arm.save_checkpoint("net", {"w": np.arange(3.0)})


def refused(path, info, message):
    """Open for writing must fail with this message in one line, and change nothing."""
    before = files(path)
    listing = {p.name for p in path.parent.iterdir()} - {path.name + ".lock"}
    with pytest.raises(RecordingError, match=message) as caught:
        Recording.open(path, info)
    assert isinstance(caught.value, InputError)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    assert files(path) == before
    assert {p.name for p in path.parent.iterdir()} == listing


OTHERS = {
    "digest": (
        {"robot": "other", "digest": "ffff"},
        r"robot of part 'run' is toy \(digest 0123abcd\); accepted: other",
    ),
    "joint_names": ({"joint_names": ("elbow", "shoulder")}, "joint_names of part 'run' is"),
    "seed": ({"seed": 2}, "seed of part 'run' is 1; accepted: 2"),
    "physics": ({"physics": "geared"}, "physics of part 'run' is open_loop; accepted: geared"),
    "engine": ({"engine": "pinocchio"}, "engine of part 'run' is compiled"),
    "option": ({"options": {"steps": 41}}, "option 'steps' of part 'run' is 40; accepted: 41"),
    "new option": ({"options": {"steps": 40, "x": None}}, "option 'x' .* is not given"),
    "type": ({"options": {"steps": 40.0}}, "option 'steps' .* is 40; accepted: 40.0"),
    "generator": ({"generator": {"state": 1}}, "generator of part 'run' is None"),
    "other part": ({"part": "learn", "digest": "ffff"}, "robot is toy"),
}


@pytest.mark.parametrize("other", OTHERS)
def test_another_robot_or_other_options(tmp_path, other):
    path = tmp_path / "run.sqlite"
    record(path)
    changes, message = OTHERS[other]
    refused(path, dataclasses.replace(INFO, **changes), message)


def test_the_name_of_a_robot_does_not_matter_its_digest_does(tmp_path):
    path = tmp_path / "run.sqlite"
    record(path)
    Recording.open(path, dataclasses.replace(INFO, robot="renamed.urdf")).close()


def test_the_log_of_a_killed_run_is_left_too(tmp_path):
    path = tmp_path / "run.sqlite"
    script = (
        "import os, sys; from pathlib import Path\n"
        "from isotorque.learning.recordings.recorded_arm import RecordedArm\n"
        "from isotorque.learning.recordings.recording import Recording\n"
        "from tests.learning.recordings.recording_tools import INFO, ToyArm\n"
        "arm = RecordedArm(ToyArm(), Recording.create(Path(sys.argv[1]), INFO))\n"
        "arm.apply([0.5, 0.25]); os._exit(9)\n"
    )
    assert subprocess.run([sys.executable, "-c", script, path], cwd=ROOT).returncode == 9
    assert len(files(path)["run.sqlite-wal"]) > 1000
    refused(path, dataclasses.replace(INFO, seed=2), "seed")
    with Recording.open(path, INFO) as recording:
        assert recording.length == 2


def test_a_newer_schema(tmp_path):
    path = tmp_path / "run.sqlite"
    record(path)
    connection = sqlite3.connect(path)
    connection.execute(f"pragma user_version = {SCHEMA_VERSION + 1}")
    connection.close()
    message = f"schema version is {SCHEMA_VERSION + 1}; accepted: {SCHEMA_VERSION}; a newer"
    refused(path, INFO, message)
    with pytest.raises(RecordingError, match=message):
        RecordingReader(path)


@pytest.mark.parametrize("content", [b"", b"q1,tau1\n0,1\n", b"SQLite format 3\0", bytes(5000)])
def test_not_a_recording(tmp_path, content):
    path = tmp_path / "run.sqlite"
    path.write_bytes(content)
    refused(path, INFO, "an Isotorque recording|damaged")
    with pytest.raises(RecordingError, match=r"an Isotorque recording|damaged"):
        RecordingReader(path)
    assert path.read_bytes() == content


def test_the_database_of_another_program(tmp_path):
    path = tmp_path / "run.sqlite"
    connection = sqlite3.connect(path)
    connection.execute("create table part (id integer)")
    connection.close()
    refused(path, INFO, "file is an SQLite file of another program")


def test_missing_files_and_directories(tmp_path):
    for path in (tmp_path / "none.sqlite", tmp_path):
        with pytest.raises(RecordingError, match="file is missing"):
            Recording.open(path, INFO)
        with pytest.raises(RecordingError, match="file is missing"):
            RecordingReader(path)
    for make in (Recording.open, Recording.create):
        with pytest.raises(RecordingError, match=r"directory .* is not usable"):
            make(tmp_path / "none" / "run.sqlite", INFO)
    assert list(tmp_path.iterdir()) == []


def test_creating_over_an_existing_file(tmp_path):
    path = tmp_path / "run.sqlite"
    record(path)
    before = files(path)
    with pytest.raises(RecordingError, match="file is there already"):
        Recording.create(path, INFO)
    assert files(path) == before


def test_the_log_of_a_removed_recording_is_not_mixed_into_a_new_one(tmp_path):
    log = tmp_path / "run.sqlite-wal"
    log.write_bytes(b"something of another run")
    with pytest.raises(RecordingError, match="log is left over"):
        Recording.create(tmp_path / "run.sqlite", INFO)
    assert log.read_bytes() == b"something of another run"


@pytest.fixture(scope="module")
def intact(tmp_path_factory):
    path = tmp_path_factory.mktemp("intact") / "run.sqlite"
    record(path)
    with RecordingReader(path) as reader:
        assert len(list(reader.commands())) == 13
    return path


@settings(max_examples=150)
@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 7), st.sampled_from("fffc"))
def test_damage_is_refused_or_harmless(tmp_path_factory, intact, where, bit, how):
    content = bytearray(intact.read_bytes())
    at = int(where * len(content))
    if how == "c":
        del content[at:]
    else:
        content[at] ^= 1 << bit
    path = tmp_path_factory.mktemp("damaged") / "run.sqlite"
    path.write_bytes(content)
    refusal = None
    try:
        with Recording.open(path, INFO) as recording:
            list(recording.rows())
    except RecordingError as error:
        refusal = str(error)
    if refusal is None:
        assert tables(path) == tables(intact)  # the damage was in unused space
    else:
        assert "\n" not in refusal
        assert path.read_bytes() == content


def test_a_missing_command_is_damage(tmp_path):
    path = tmp_path / "run.sqlite"
    for table, message in (("command", "commands are missing"), ("motion", "motions of")):
        record(path)
        connection = sqlite3.connect(path)
        connection.execute(f"delete from {table} where number = 2")
        connection.commit()
        connection.close()
        refused(path, INFO, message)
        path.unlink()


def test_a_second_writer_in_the_same_process(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        arm.apply([0.1, 0.2])
        message = f"being written by process {os.getpid()}; accepted: one writer at a time"
        for make in (Recording.open, Recording.create, Recording.open_or_create):
            with pytest.raises(RecordingError, match=message):
                make(path, INFO)
        arm.apply([0.3, 0.2])
        assert recording.length == 3
    Recording.open(path, INFO).close()


def test_a_second_writer_in_another_process(tmp_path):
    path = tmp_path / "run.sqlite"
    script = (
        "import sys; from pathlib import Path\n"
        "from isotorque.learning.recordings.recording import Recording\n"
        "from tests.learning.recordings.recording_tools import INFO\n"
        "Recording.open(Path(sys.argv[1]), INFO)\n"
    )
    command = [sys.executable, "-c", script, path]
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        arm.apply([0.1, 0.2])
        other = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        assert other.returncode != 0
        assert f"being written by process {os.getpid()}" in other.stderr
        arm.apply([0.3, 0.2])
    assert subprocess.run(command, cwd=ROOT).returncode == 0


def test_a_lock_file_left_by_a_killed_writer_locks_nobody_out(tmp_path):
    path = tmp_path / "run.sqlite"
    record(path)
    (tmp_path / "run.sqlite.lock").write_text("999999\n")
    Recording.open(path, INFO).close()
    assert [p.name for p in tmp_path.iterdir()] == ["run.sqlite"]


@pytest.fixture
def unprivileged():
    """Lay down root's rights, before which no directory is read-only."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def locked_directory(tmp_path):
    """Set up a recording that everybody may read and nobody may write."""
    record(tmp_path / "run.sqlite")
    (tmp_path / "run.sqlite").chmod(0o444)
    tmp_path.chmod(0o555)
    opened = []
    for parent in tmp_path.parents:  # pytest makes its directories for their owner alone
        mode = parent.stat().st_mode
        if parent.stat().st_uid == os.geteuid() and not mode & 0o001:
            parent.chmod(mode | 0o055)
            opened.append((parent, mode))
    yield tmp_path
    tmp_path.chmod(0o755)
    for parent, mode in opened:
        parent.chmod(mode)


def test_a_read_only_directory(locked_directory, unprivileged):
    path = locked_directory / "run.sqlite"
    refused(path, INFO, "directory .* is not usable .Permission denied.")
    with pytest.raises(RecordingError, match="is not usable"):
        Recording.create(locked_directory / "new.sqlite", INFO)
    with RecordingReader(path) as reader:  # reading is not writing
        assert len(list(reader.commands())) == 13
    assert [p.name for p in locked_directory.iterdir()] == ["run.sqlite"]


def test_a_read_only_file(locked_directory):
    path = locked_directory / "run.sqlite"
    if os.geteuid() == 0:
        os.chown(locked_directory, 65534, 65534)
        os.seteuid(65534)
    try:
        locked_directory.chmod(0o755)
        refused(path, INFO, "file is not writable")
    finally:
        if os.getuid() == 0:
            os.seteuid(0)
