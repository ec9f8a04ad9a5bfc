"""Samples that were measured elsewhere, put into a recording beside an arm's own."""

from __future__ import annotations

import math

import numpy as np

from isotorque.learning.arm import Settled
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.recordings.recorded_command import CommandKind, row_of, to_bytes
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.symbolic.common.errors import InputError


def record_samples(recording: Recording, samples: StaticSamples, phase: str = "learning") -> None:
    """Record samples as a part of their own, in one commit: all or none.

    Parameters
    ----------
    recording
        An empty part, or one that holds just these samples (then nothing is written).
    samples
        m configurations [rad] and torques [N m] of this robot, as ``read_csv`` gives them.
    phase
        What they are for.

    Raises
    ------
    RecordingError
        If the part has other commands or samples already, or cannot be written.
    InputError
        If the samples are of another number of joints.

    Notes
    -----
    ``RecordingReader.samples`` gives them like samples of an arm that settled, with unknown
    (nan) seconds.
    """
    n = recording.info.n
    if samples.q.shape[1:] != (n,) or samples.tau.shape != samples.q.shape:
        found = f"{samples.q.shape} and {samples.tau.shape}"
        raise InputError("samples", "shapes of q and tau", found, f"twice (m, {n})")
    part = recording.part_id
    start = row_of(part, 0, phase, None, CommandKind.START, b"", None, np.empty(0))
    rows = [start]
    for number, (q, tau) in enumerate(zip(samples.q, samples.tau, strict=True), 1):
        outcome = Settled(q, tau, math.nan)
        rows.append(row_of(part, number, phase, None, CommandKind.DATA, to_bytes(tau), outcome, q))
    if recording.length == 0:
        recording.append_rows(rows)
    elif list(recording.rows()) != [row[2:-1] for row in rows]:
        found = f"recorded with {recording.length - 1} other commands or samples"
        raise RecordingError(
            recording.path, f"part {recording.info.part!r}", found, "the same data"
        )
