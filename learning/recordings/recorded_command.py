"""Command of a recording: what was asked of the arm and what came of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from isotorque.learning.arm import LimitHit, Outcome, OutcomeKind, Settled, TimedOut, Vector
from isotorque.learning.recordings.database.schema import checksum, command_id

FLOATS = np.dtype("<f8")

Row = tuple[Any, ...]
"""Columns of the table ``command``, in order, from ``number`` to ``result``."""


class CommandKind(StrEnum):
    """Kind of a command to the arm."""

    START = "start"
    """Nothing yet: the arm as it was found."""
    APPLY = "apply"
    PLAY = "play"
    GO_HOME = "go_home"
    PLACE = "place"
    HOLD = "hold"
    PLACE_AND_HOLD = "place_and_hold"
    RELEASE_TEST = "release_test"
    DATA = "data"
    """Not asked at all: a sample that came from elsewhere."""


def to_bytes(values: Any) -> bytes:
    """Pack numbers as float64, little endian."""
    return np.ascontiguousarray(values, dtype=FLOATS).tobytes()


def to_array(blob: bytes) -> Vector:
    """Unpack what ``to_bytes`` packed, as a flat array that may be written to."""
    return np.frombuffer(blob, dtype=FLOATS).astype(np.float64)


def outcome_of(kind: str, q: Vector, torque: Vector, seconds: float) -> Outcome:
    """Build the outcome that a kind names."""
    if kind == OutcomeKind.SETTLED:
        return Settled(q, torque, seconds)
    return (LimitHit if kind == OutcomeKind.LIMIT else TimedOut)(q, torque, seconds)


@dataclass(frozen=True, eq=False)
class RecordedCommand:
    """A command and its outcome.

    Attributes
    ----------
    number : int
        0 for the start of a part, then 1, 2, ...
    phase : str
        What the command was for, so that samples are counted apart: ``discovery``,
        ``learning``, ``test``, ...
    label : int or None
        Group the command belongs to, where its maker gave one.
    kind : CommandKind
        What was asked.
    argument : (k,) array
        Torque [N m] of ``apply`` and ``data``, last torque of ``play``, configuration [rad] of
        ``place``; for ``place_and_hold`` and ``release_test`` configuration, torque and the
        other arguments in order (nan for None); empty for the others.
    outcome : Outcome or None
        What came of it; None where the command has no outcome.
    q_after : (n,) array
        Joint angles observed after it [rad] (home, after a limit was hit).
    result : (k,) array or None
        What a test found: of ``place_and_hold`` held (1 or 0), distance [rad], configuration
        [rad]; of ``release_test`` balanced (1 or 0), acceleration [rad/s^2].
    """

    number: int
    phase: str
    label: int | None
    kind: CommandKind
    argument: Vector
    outcome: Outcome | None
    q_after: Vector
    result: Vector | None = None

    @staticmethod
    def from_row(row: Row) -> RecordedCommand:
        """Read a row of the table ``command``."""
        number, phase, label, kind, argument, how, *_, result = row
        return RecordedCommand(
            number,
            phase,
            label,
            CommandKind(kind),
            to_array(argument),
            None if how is None else outcome_in(row),
            q_after(row),
            None if result is None else to_array(result),
        )


def outcome_in(row: Row) -> Outcome:
    """Outcome that a row tells of, which must be of a command that has one."""
    argument, how, seconds, q, torque = row[4:9]
    return outcome_of(
        how,
        to_array(q),
        to_array(argument if torque is None else torque),
        math.nan if seconds is None else seconds,
    )


def q_after(row: Row) -> Vector:
    """Joint angles observed after the command of a row [rad]."""
    return to_array(row[7] if row[9] is None else row[9])


def row_of(
    part: int,
    number: int,
    phase: str,
    label: int | None,
    kind: CommandKind,
    argument: bytes,
    outcome: Outcome | None,
    q_after: Vector,
    result: bytes | None = None,
) -> Row:
    """Make a row of the table ``command``, from ``id`` to ``checksum``.

    What repeats is left out: the observed torque where it is the commanded one, the
    configuration afterwards where it is the outcome's.
    """
    after: bytes | None = to_bytes(q_after)
    how = seconds = q = torque = None
    if outcome is not None:
        how = outcome.kind.value
        seconds = None if math.isnan(outcome.seconds) else float(outcome.seconds)
        q = to_bytes(outcome.q)
        torque = to_bytes(outcome.torque)
        if torque == argument:
            torque = None
        if after == q:
            after = None
    # Plain text, as the file will give it back: an enumeration's spelling is another one.
    names = (str(phase), None if label is None else int(label), kind.value)
    key = (command_id(part, number), part, number)
    row = (*key, *names, argument, how, seconds, q, torque, after, result)
    return (*row, checksum(*row))
