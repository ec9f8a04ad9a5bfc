"""File of a recording: made anew, or looked at before it is written to."""

from __future__ import annotations

import os
from pathlib import Path

from isotorque.learning.files.run_info import RunInfo, canonical_json
from isotorque.learning.recordings.database.commit_log import Statement
from isotorque.learning.recordings.database.damage_check import check_content
from isotorque.learning.recordings.database.queries import RecordedPart, read_parts, read_robot
from isotorque.learning.recordings.database.schema import (
    PART,
    ROBOT,
    checked,
    connect,
    create_tables,
)
from isotorque.learning.recordings.recording_error import RecordingError


def part_statement(part: RecordedPart) -> Statement:
    """Write what a part was made with, in place of what was written before."""
    info = part.info
    texts = (canonical_json(value) for value in (info.seed, info.options, info.generator))
    values = (part.id, info.part, info.physics, info.engine, *texts, int(part.finished))
    return checked(PART, values)


def write_new_file(path: Path, info: RunInfo) -> None:
    """Write an empty recording of a robot; the file appears whole or not at all.

    Parameters
    ----------
    path
        The file, which must not exist; the caller holds its lock.
    info
        The robot, and what the first part is made with.

    Raises
    ------
    RecordingError
        If the file exists, or the log of a removed one is left (SQLite would mix the two).
    """
    if path.exists():
        wanted = "a new file, or the options the existing one was made with"
        raise RecordingError(path, "file", "there already", wanted)
    log = path.with_name(path.name + "-wal")
    if log.exists() and log.stat().st_size:
        wanted = "no such file; it belongs to a recording that was removed or moved"
        raise RecordingError(path, "log", f"left over ({log.name})", wanted)
    fresh = path.with_name(f".{path.name}.new")
    for suffix in ("", "-wal", "-shm"):
        fresh.with_name(fresh.name + suffix).unlink(missing_ok=True)
    connection = connect(fresh, "rwc")
    try:
        create_tables(connection)
        robot = (info.robot, info.digest, canonical_json(info.joint_names))
        connection.execute(*checked(ROBOT, robot))
        connection.execute(*part_statement(RecordedPart(1, info, 0, finished=False)))
    finally:
        connection.close()
    _wait_for_disk(fresh)
    os.replace(fresh, path)
    _wait_for_disk(path.parent)  # else a power failure may forget the file's name


def _wait_for_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def check_before_writing(path: Path, expected: RunInfo) -> None:
    """Refuse a file that cannot be continued, without changing a bit of it.

    Parameters
    ----------
    path
        The file; the caller holds its lock.
    expected
        What the run is made with now.

    Raises
    ------
    RecordingError
        If the file is missing, no recording, newer, damaged, not writable, of another robot, or
        made with other options.
    """
    if not path.is_file():
        raise RecordingError(path, "file", "missing", "an Isotorque recording")
    if not os.access(path, os.W_OK, effective_ids=os.access in os.supports_effective_ids):
        raise RecordingError(path, "file", "not writable", "a file this user may write")
    log = path.with_name(path.name + "-wal")
    # Without a log there is no writer and no reader, and nothing needs to be made beside the file.
    connection = connect(path, "ro" if log.exists() else "immutable")
    try:
        check_content(connection, path)
        robot = read_robot(connection)
        parts = {part.info.part: part.info for part in read_parts(connection)}
    finally:
        connection.close()
    # A part that is not there yet has no options to compare, but the robot must be the same.
    recorded = parts.get(expected.part, RunInfo(*robot, part=expected.part))
    for what, found, wanted in recorded.differences(expected):
        if expected.part in parts or what in ("robot", "joint_names"):
            accepted = f"{wanted}, as asked for now; other runs need files of their own"
            field = what if expected.part not in parts else f"{what} of part {expected.part!r}"
            raise RecordingError(path, field, found, accepted)
