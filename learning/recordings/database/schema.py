"""Tables of a recording: one SQLite file per run."""

from __future__ import annotations

import sqlite3
import zlib
from pathlib import Path
from typing import Any

from isotorque.learning.recordings.recording_error import RecordingError

APPLICATION_ID = 0x49534F54
"""Marks the SQLite file as ours: "ISOT"."""

SCHEMA_VERSION = 1
"""Counts up when tables change; a file of a newer version is refused."""

PAGE_BYTES = 1024
"""A commit writes at least the page it changed, so small pages make small commits."""

# All arrays are blobs of float64, little endian, row by row. A checksum covers the other columns of
# its row, so that damage SQLite cannot see (a flipped bit of a number) is noticed.
TABLES = """
create table robot (
    name text not null, digest text not null, joint_names text not null, checksum integer not null
);
create table part (
    id integer primary key, name text not null unique, physics text not null,
    engine text not null, seed text not null, options text not null, generator text not null,
    finished integer not null, checksum integer not null
);
create table session (
    part integer not null, first_number integer not null, opened text not null,
    versions text not null
);
create table command (
    id integer primary key, part integer not null, number integer not null,
    phase text not null, label integer, kind text not null, argument blob not null,
    outcome text, seconds, q blob, torque blob, q_after blob, result blob,
    checksum integer not null
);
create table motion (
    part integer not null, number integer not null, step_seconds, commanded blob not null,
    times blob, q blob, torques blob, checksum integer not null,
    primary key (part, number)
);
create table arm_state (
    part integer primary key, number integer not null, state text not null,
    checksum integer not null
);
create table checkpoint (
    part integer not null, name text not null, number integer not null, arrays blob not null,
    checksum integer not null,
    primary key (part, name)
);
"""

COMMAND = "insert into command values (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
MOTION = "insert into motion values (?, ?, ?, ?, ?, ?, ?, ?)"
STATE = "insert or replace into arm_state values (?, ?, ?, ?)"
# A replay takes its checkpoints again: they must not replace later ones, nor write for nothing.
CHECKPOINT = """
insert into checkpoint values (?, ?, ?, ?, ?)
on conflict (part, name) do update
set number = excluded.number, arrays = excluded.arrays, checksum = excluded.checksum
where excluded.number >= number and excluded.checksum != checksum
"""
ROBOT = "insert into robot values (?, ?, ?, ?)"
PART = "insert or replace into part values (?, ?, ?, ?, ?, ?, ?, ?, ?)"
SESSION = "insert into session values (?, ?, ?, ?)"


def command_id(part: int, number: int) -> int:
    """Key of the table ``command``: appending to an integer key writes the fewest pages."""
    return part * 2**40 + number


def checksum(*values: Any) -> int:
    """CRC-32 of numbers, texts, blobs and None, telling types apart.

    Examples
    --------
    >>> checksum(1, "a") == checksum(1.0, "a")
    False
    """
    crc = 0
    for value in values:
        # Spelled in ASCII: the same in every version of Python and of Unicode.
        crc = zlib.crc32(value if type(value) is bytes else ascii(value).encode(), crc)
    return crc


def checked(text: str, values: tuple[Any, ...]) -> tuple[str, tuple[Any, ...]]:
    """Pair a statement with its values and their checksum."""
    return text, (*values, checksum(*values))


def connect(path: Path, mode: str) -> sqlite3.Connection:
    """Open the file: ``mode`` is SQLite's ``ro``, ``rw`` or ``rwc``, or ``immutable``.

    ``immutable`` is for files that nobody is writing, and leaves no trace in the directory.
    """
    query = "mode=ro&immutable=1" if mode == "immutable" else f"mode={mode}"
    connection = sqlite3.connect(
        f"{path.absolute().as_uri()}?{query}",
        uri=True,
        isolation_level=None,  # transactions are begun and committed by name, here alone
        timeout=20.0,
    )
    connection.execute("pragma trusted_schema = off")
    connection.execute("pragma cell_size_check = on")
    return connection


def create_tables(connection: sqlite3.Connection) -> None:
    """Write the tables of the present schema into an empty file; the caller waits for the disk."""
    connection.execute(f"pragma page_size = {PAGE_BYTES}")
    connection.execute("pragma synchronous = off")
    connection.executescript(f"""
        begin;
        pragma application_id = {APPLICATION_ID};
        pragma user_version = {SCHEMA_VERSION};
        {TABLES}
        commit;
    """)
    connection.execute("pragma journal_mode = wal")


def check_schema(connection: sqlite3.Connection, path: Path) -> None:
    """Refuse a file that is no recording, or one of a version this program does not know.

    Raises
    ------
    RecordingError
        Says which of the two.
    """
    (application,) = connection.execute("pragma application_id").fetchone()
    if application != APPLICATION_ID:
        found = "an SQLite file of another program, or an empty one"
        raise RecordingError(path, "file", found, "an Isotorque recording")
    (version,) = connection.execute("pragma user_version").fetchone()
    if version != SCHEMA_VERSION:
        wanted = f"{SCHEMA_VERSION}; a newer Isotorque may read the file"
        raise RecordingError(path, "schema version", version, wanted)
