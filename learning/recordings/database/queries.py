"""Queries of a recording's tables, as the types of the toolkit; for readers and the writer."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from isotorque.learning.arm import Outcome, Playback
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.database.schema import command_id
from isotorque.learning.recordings.recorded_checkpoint import Checkpoint, unpack_arrays
from isotorque.learning.recordings.recorded_command import Row, outcome_in, to_array


@dataclass(frozen=True)
class RecordedPart:
    """One part of a run as the file has it.

    Attributes
    ----------
    id : int
        Its number in the tables of the file.
    info : RunInfo
        What it was made with.
    commands : int
        Commands recorded so far, the start not counted.
    finished : bool
        Whether it ran to its end.
    """

    id: int
    info: RunInfo
    commands: int
    finished: bool


def read_robot(connection: sqlite3.Connection) -> tuple[str, str, tuple[str, ...]]:
    """Read name, digest and joint names of the robot."""
    query = "select name, digest, joint_names from robot"
    name, digest, joints = connection.execute(query).fetchone()
    return name, digest, tuple(json.loads(joints))


def read_parts(connection: sqlite3.Connection) -> tuple[RecordedPart, ...]:
    """Read what the parts of the run were made with, in the order they were begun."""
    query = """
        select id, name, physics, engine, seed, options, generator, finished,
            (select count(*) from command where part = part.id and number > 0)
        from part order by id
    """
    robot = read_robot(connection)
    parts = []
    for row in connection.execute(query):
        id, name, physics, engine, seed, options, generator, finished, commands = row
        seed, options, generator = (json.loads(text) for text in (seed, options, generator))
        info = RunInfo(*robot, physics, engine, seed, options, name, generator)
        parts.append(RecordedPart(id, info, commands, bool(finished)))
    return tuple(parts)


def read_rows(
    connection: sqlite3.Connection, condition: str, values: Sequence[Any]
) -> Iterator[Row]:
    """Yield rows of the table ``command``, without ``part``, in order.

    Parameters
    ----------
    connection
        The open file.
    condition, values
        SQL after ``where``, and the values of its question marks.
    """
    columns = "number, phase, label, kind, argument, outcome, seconds, q, torque, q_after, result"
    query = f"select {columns} from command where {condition} order by id"
    # Not `yield from`: it would close the cursor, which an already closed file does not allow.
    for row in connection.execute(query, values):  # noqa: UP028
        yield row


def read_motion(connection: sqlite3.Connection, part: int, number: int) -> Row | None:
    """Read (step_seconds, commanded, times, q, torques) of a profile, or None if there is none."""
    row: Row | None = connection.execute(
        "select step_seconds, commanded, times, q, torques from motion"
        " where part = ? and number = ?",
        (part, number),
    ).fetchone()
    return row


def read_playback(connection: sqlite3.Connection, part: int, number: int) -> Playback | None:
    """Read the trajectory of a profile, empty if it was not kept; None if there was no profile."""
    motion = read_motion(connection, part, number)
    rows = list(read_rows(connection, "id = ?", (command_id(part, number),)))
    if motion is None or not rows:
        return None
    return playback_of(outcome_in(rows[0]), motion)


def playback_of(outcome: Outcome, motion: Row) -> Playback:
    """Join an outcome and the row of its motion."""
    _, commanded, times, q, torques = motion
    n = len(outcome.q)
    if times is None:
        commanded = times = q = b""
    return Playback(
        outcome,
        to_array(times),
        to_array(q).reshape(-1, n),
        to_array(commanded if torques is None else torques).reshape(-1, n),
    )


def read_state(connection: sqlite3.Connection, part: int) -> Any:
    """Read the arm's state after its last command, or None if it tells none."""
    query = "select state from arm_state where part = ?"
    row = connection.execute(query, (part,)).fetchone()
    return None if row is None else json.loads(row[0])


def read_checkpoint(connection: sqlite3.Connection, part: int, name: str) -> Checkpoint | None:
    """Read a checkpoint, or None if there is none of that name."""
    query = "select number, arrays from checkpoint where part = ? and name = ?"
    row = connection.execute(query, (part, name)).fetchone()
    return None if row is None else Checkpoint(name, row[0], unpack_arrays(row[1]))
