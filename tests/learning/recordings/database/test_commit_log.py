"""All statements of a commit, or none."""

import sqlite3

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.recordings.database.commit_log import CommitLog
from isotorque.learning.recordings.recording_error import RecordingError

INSERT = "insert into kept values (?)"


@given(st.lists(st.integers(0, 9), max_size=6), st.integers(0, 6))
@settings(max_examples=20)
def test_a_commit_of_which_one_statement_fails_leaves_nothing(tmp_path_factory, values, place):
    path = tmp_path_factory.mktemp("log") / "file.sqlite"
    connection = sqlite3.connect(path)
    connection.execute("create table kept (value integer not null check (value >= 0))")
    connection.close()
    log = CommitLog(path)
    good = [(INSERT, (value,)) for value in values]
    log.commit(good)
    spoiled = [*good[:place], (INSERT, (-1,)), *good[place:]]
    with pytest.raises(RecordingError):
        log.commit(spoiled)
    log.commit([(INSERT, (7,))])  # and it goes on
    found = [value for (value,) in log.connection.execute("select value from kept order by rowid")]
    log.close()
    assert found == [*values, 7]
