"""An arm whose every command is recorded, and which takes a stopped run up where it ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import is_dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.arm import Arm, Outcome, OutcomeKind, Playback, Vector
from isotorque.learning.recordings.database.queries import playback_of
from isotorque.learning.recordings.recorded_command import (
    CommandKind,
    Row,
    outcome_in,
    outcome_of,
    q_after,
    to_array,
    to_bytes,
)
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.symbolic.common.errors import InputError


class RecordedArm:
    """Stands in for an arm: commits each command and its outcome before it returns.

    On a recording that has commands already, the first commands are answered from it, without
    moving anything; then the arm is put back into its recorded state and moves on. An algorithm
    that is deterministic (its only randomness a seeded generator of its own) thus resumes, and
    ends, bit for bit as if it had never been stopped, and needs no code for it.

    Parameters
    ----------
    arm
        The arm: anything that satisfies ``Arm``. ``state()`` and
        ``restore(state)``, where it has them, put it back exactly; the state is plain data, or a
        frozen dataclass of plain data with ``from_json(mapping)``. Without them the arm goes home
        when a run is resumed. None replays only. Measurement noise must come from a generator of
        the arm's own, not from the algorithm's.
    recording
        Where to record; open for writing.
    phase
        What the commands are for, so that samples are counted apart; ``phase`` can be set at
        any time.
    start
        Number of a checkpoint: an algorithm that goes on from there asks for the commands after
        it.
    trajectories
        Keep what ``play`` observes on the way. If not, playbacks have no rows.

    Attributes
    ----------
    phase : str
        Phase of the commands to come.
    label : int or None
        Group of the commands to come, if they are to have one.
    position : int
        Commands given so far.

    Raises
    ------
    RecordingError
        From every command: if it is not the recorded one (the run was made with other options or
        another version), if it cannot be recorded, or if one before it was interrupted.

    Notes
    -----
    ``q`` is what was observed right after the last command, once; asking again does not measure
    again, so that noise does not depend on how often somebody looks.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from isotorque.learning.arm import Settled
    >>> from isotorque.learning.files.run_info import RunInfo
    >>> class Spring:
    ...     q = np.zeros(1)
    ...
    ...     def apply(self, torque):
    ...         print("moves")
    ...         self.q = torque / 8.0
    ...         return Settled(self.q, torque, 1.5)
    >>> directory = tempfile.TemporaryDirectory()
    >>> path = Path(directory.name) / "run.sqlite"
    >>> info = RunInfo("spring", "c0ffee", ("hinge",))
    >>> with Recording.create(path, info) as recording:
    ...     print(RecordedArm(Spring(), recording).apply([2.0]).q)
    moves
    [0.25]
    >>> with Recording.open(path, info) as recording:
    ...     print(RecordedArm(Spring(), recording).apply([2.0]).q)
    [0.25]
    >>> directory.cleanup()
    """

    def __init__(
        self,
        arm: Arm | None,
        recording: Recording,
        *,
        phase: str = "learning",
        start: int = 0,
        trajectories: bool = True,
    ) -> None:
        self.phase = phase
        self.label: int | None = None
        self.position = start
        self._arm = arm
        self._arm_state: Callable[[], Any] | None = getattr(arm, "state", None)
        self._recording = recording
        self._n = recording.info.n
        self._trajectories = trajectories
        self._stopped = False
        self._live = recording.length == 0
        if self._live:
            self._record_start()
        rows = recording.rows(start)
        here = next(rows, None)
        if here is None or start < 0:
            accepted = f"0 to {recording.length - 1}"
            raise RecordingError(recording.path, "number to start from", start, accepted)
        self._q = q_after(here)
        self._rows = iter(()) if self._live else rows

    @property
    def q(self) -> Vector:
        """Joint angles [rad], (n,), as observed right after the last command."""
        return self._q.copy()

    @property
    def is_replaying(self) -> bool:
        """Whether the next command can still be answered from the recording."""
        return self.position < self._recording.length - 1

    def apply(self, torque: ArrayLike) -> Outcome:
        """Apply a constant torque (n,) [N m] from the present configuration and wait."""
        sent = self._vector("torque", torque)
        row = self._recorded(CommandKind.APPLY, sent)
        if row is not None:
            return outcome_in(row)
        outcome = self._observed(self._begin("apply")(to_array(sent)))
        self._record(CommandKind.APPLY, sent, outcome)
        return outcome

    def go_home(self) -> None:
        """Return to the home configuration, at rest."""
        if self._recorded(CommandKind.GO_HOME, b"") is None:
            self._begin("go_home")()
            self._record(CommandKind.GO_HOME, b"", None)

    def play(self, torques: ArrayLike, step_seconds: float) -> Playback:
        """Apply ``torques`` (T, n) [N m] one after the other, then wait under the last one."""
        profile = np.array(torques, dtype=np.float64)
        if profile.ndim != 2 or profile.shape[1] != self._n or not len(profile):
            raise InputError("arm", "shape of torques", profile.shape, f"(T, {self._n})")
        if not np.all(np.isfinite(profile)):
            raise InputError("arm", "torques", "not finite", "finite numbers [N m]")
        sent, last = to_bytes(profile), to_bytes(profile[-1])
        row = self._recorded(CommandKind.PLAY, last)
        if row is not None:
            motion = self._recording.motion(row[0])
            if motion is None or motion[:2] != (float(step_seconds), sent):
                self._stopped = True
                raise self._other_run("the torques or step of a profile", "those recorded")
            return playback_of(outcome_in(row), motion)
        played: Playback = self._begin("play")(profile.copy(), step_seconds)
        outcome = self._observed(played.outcome)
        seen: Row = (None, None, None)
        if self._trajectories:
            felt = to_bytes(played.torques)
            seen = (to_bytes(played.times), to_bytes(played.q), None if felt == sent else felt)
        motion = (float(step_seconds), sent, *seen)
        self._record(CommandKind.PLAY, last, outcome, motion)
        return playback_of(outcome, motion)

    def save_checkpoint(self, name: str, arrays: Mapping[str, ArrayLike]) -> None:
        """Keep named arrays with the recording, see ``Recording.save_checkpoint``."""
        self._recording.save_checkpoint(name, arrays, self.position)

    def finish(self) -> None:
        """Note that the run came to its end.

        Raises
        ------
        RecordingError
            If the recording has commands that this run did not give.
        """
        if self.is_replaying:
            raise self._other_run("the end of the run", "more commands, as recorded")
        self._recording.finish()

    def _recorded(self, kind: CommandKind, sent: bytes) -> Row | None:
        """Return the next row of the recording, checked; None when the arm itself has to move."""
        if self._stopped:
            wanted = "no interruption; open the recording again to resume"
            raise RecordingError(self._recording.path, "last command", "interrupted", wanted)
        self._stopped = True  # stays so if ctrl-C or a contradiction comes in between
        row = next(self._rows, None)
        if row is not None:
            asked = (self.phase, self.label, kind.value, sent)
            if row[1:5] != asked:
                raise self._other_run(_spoken(*asked), _spoken(*row[1:5]))
            self.position += 1
            self._q = q_after(row)
        elif not self._live:
            self._go_live()
        self._stopped = False
        return row

    def _go_live(self) -> None:
        """Put the arm where the recording ends."""
        self._live = True
        state = self._recording.arm_state()
        restore = getattr(self._arm, "restore", None)
        if state is not None and restore is not None and self._arm_state is not None:
            from_json = getattr(self._arm_state(), "from_json", None)
            restore(state if from_json is None else from_json(state))
        elif self._arm is not None and self._recording.length > 1:
            self._arm.go_home()
            self._q = self._observed_q()

    def _begin(self, command: str) -> Callable[..., Any]:
        """Return the arm's method; until its answer is recorded, no other command is taken."""
        method: Callable[..., Any] | None = getattr(self._arm, command, None)
        if method is None:
            path, number = self._recording.path, self.position + 1
            found = f"{command}, which the recording does not answer"
            raise RecordingError(path, f"command {number}", found, f"an arm that can {command}")
        self._stopped = True
        return method

    def _record(
        self,
        kind: CommandKind,
        sent: bytes,
        outcome: Outcome | None,
        motion: Row | None = None,
        result: bytes | None = None,
    ) -> None:
        q = self._observed_q()
        extras = {"label": self.label, "result": result, "motion": motion, "state": self._state()}
        self._recording.append(self.phase, kind, sent, outcome, q, **extras)
        self._q = q
        self.position += 1
        self._stopped = False

    def _record_start(self) -> None:
        if self._arm is None:
            raise RecordingError(self._recording.path, "recording", "empty", "a recorded run")
        q = self._observed_q()
        self._recording.append(self.phase, CommandKind.START, b"", None, q, state=self._state())

    def _state(self) -> Any:
        """State of the arm as plain data; None if it tells none."""
        state = None if self._arm_state is None else self._arm_state()
        return vars(state) if is_dataclass(state) else state

    def _vector(self, name: str, values: ArrayLike) -> bytes:
        array = np.asarray(values, dtype=np.float64)
        if array.shape != (self._n,):
            raise InputError("arm", f"shape of {name}", array.shape, f"({self._n},)")
        if not all(map(math.isfinite, array.tolist())):  # a tenth of NumPy's time for few joints
            raise InputError("arm", name, array, "finite numbers")
        return to_bytes(array)

    def _observed_q(self) -> Vector:
        assert self._arm is not None
        return to_array(self._vector("observed q", self._arm.q))

    def _observed(self, outcome: Outcome) -> Outcome:
        """Copy of an outcome as a replay will give it, whatever numbers the arm answered with."""
        q = to_array(self._vector("observed q", outcome.q))
        torque = to_array(self._vector("observed torque", outcome.torque))
        return outcome_of(OutcomeKind(outcome.kind), q, torque, float(outcome.seconds))

    def _other_run(self, asked: str, recorded: str) -> RecordingError:
        where = f"{self._recording.path}, command {self.position + 1}"
        accepted = f"{recorded}; the recording was made with other options or another version"
        return RecordingError(where, "what the run asks for", asked, accepted)


def _spoken(phase: str, label: int | None, kind: str, sent: bytes) -> str:
    group = "" if label is None else f", label {label}"
    return f"{kind} {to_array(sent).tolist()} ({phase}{group})"
