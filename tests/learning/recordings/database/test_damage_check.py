"""Commands that are missing, or stand elsewhere than they say, are damage; whole rows too."""

import sqlite3

import pytest

from isotorque.learning.recordings.database.damage_check import check_content
from isotorque.learning.recordings.database.schema import checksum, command_id
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from tests.learning.recordings.recording_tools import INFO, ToyArm, explore


@pytest.fixture
def connection(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        list(explore(RecordedArm(ToyArm(), recording), ["apply"] * 6, 1))
    opened = sqlite3.connect(path, isolation_level=None)
    opened.execute("delete from arm_state")  # which would tell as well
    check_content(opened, path)
    yield opened
    opened.close()


def rewrite(connection, number, *, new_number, new_id=None):
    """Change where a command stands, with a checksum that fits."""
    where = command_id(1, number)
    row = list(connection.execute("select * from command where id = ?", (where,)).fetchone())
    row[0], row[2] = where if new_id is None else new_id, new_number
    row[-1] = checksum(*row[:-1])
    connection.execute("delete from command where id = ?", (where,))
    marks = ", ".join("?" * len(row))
    connection.execute(f"insert into command values ({marks})", row)


def test_a_command_with_another_number_is_damage(connection, tmp_path):
    last = connection.execute("select max(number) from command").fetchone()[0]
    rewrite(connection, last, new_number=last + 5)
    with pytest.raises(RecordingError, match="commands are missing"):
        check_content(connection, tmp_path)


def test_a_command_in_another_place_is_damage(connection, tmp_path):
    last = connection.execute("select max(number) from command").fetchone()[0]
    rewrite(connection, last, new_number=last, new_id=command_id(1, last + 5))
    with pytest.raises(RecordingError, match="commands are missing"):
        check_content(connection, tmp_path)


@pytest.mark.parametrize("which", ["first", "middle"])
def test_a_command_that_is_gone_is_damage(connection, tmp_path, which):
    place = command_id(1, 0 if which == "first" else 3)
    connection.execute("delete from command where id = ?", (place,))
    with pytest.raises(RecordingError, match="commands are missing"):
        check_content(connection, tmp_path)
