"""A recorded arm that can also be placed, held and tested, as a simulated one can."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.arm import Outcome
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recorded_command import (
    CommandKind,
    Row,
    outcome_in,
    to_array,
    to_bytes,
)
from isotorque.learning.simulator.results import Hold, Release


class RecordedSimulation(RecordedArm):
    """A ``RecordedArm`` around a ``SimulatedArm``.

    Parameters and errors are those of ``RecordedArm``.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from isotorque.learning.recordings.recording import Recording
    >>> from isotorque.learning.files.run_info import RunInfo
    >>> from isotorque.learning.simulator.simulated_arm import SimulatedArm
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> robot = load_robot("2r")
    >>> arm = SimulatedArm(robot, physics="guided")
    >>> options = {"arm": arm.settings.as_json()}
    >>> info = RunInfo(robot.name, robot.digest, robot.joint_names, arm.physics, options=options)
    >>> directory = tempfile.TemporaryDirectory()
    >>> with Recording.create(Path(directory.name) / "run.sqlite", info) as recording:
    ...     recorded = RecordedSimulation(arm, recording)
    ...     recorded.place([0.0, 0.0])
    ...     print(recorded.hold().torque.round(3))
    [24.525  6.131]
    >>> directory.cleanup()
    """

    def place(self, q: ArrayLike) -> None:
        """Place the arm at rest at joint angles q (n,) [rad] and hold it there."""
        sent = self._vector("q", q)
        if self._recorded(CommandKind.PLACE, sent) is None:
            self._begin("place")(to_array(sent))
            self._record(CommandKind.PLACE, sent, None)

    def hold(self) -> Outcome:
        """Measure the torque that holds the arm where it is."""
        row = self._recorded(CommandKind.HOLD, b"")
        if row is not None:
            return outcome_in(row)
        outcome = self._observed(self._begin("hold")())
        self._record(CommandKind.HOLD, b"", outcome)
        return outcome

    def place_and_hold(
        self, q: ArrayLike, torque: ArrayLike, seconds: float = 5.0, tolerance: float = 0.05
    ) -> Hold:
        """Test whether a torque (n,) [N m] reaches and maintains a configuration q (n,) [rad]."""
        where, what = self._vector("q", q), self._vector("torque", torque)
        sent = where + what + to_bytes([seconds, tolerance])
        row = self._recorded(CommandKind.PLACE_AND_HOLD, sent)
        if row is not None:
            found = _result(row)
            return Hold(bool(found[0]), float(found[1]), found[2:])
        test = self._begin("place_and_hold")
        hold: Hold = test(to_array(where), to_array(what), seconds, tolerance)
        result = to_bytes([hold.held, hold.distance, *hold.q])
        self._record(CommandKind.PLACE_AND_HOLD, sent, None, result=result)
        return hold

    def release_test(
        self, q: ArrayLike, torque: ArrayLike, acceleration: float | None = None
    ) -> Release:
        """Test whether a torque (n,) [N m] balances a configuration q (n,) [rad]."""
        where, what = self._vector("q", q), self._vector("torque", torque)
        sent = where + what + to_bytes([math.nan if acceleration is None else acceleration])
        row = self._recorded(CommandKind.RELEASE_TEST, sent)
        if row is not None:
            found = _result(row)
            return Release(found[1:], bool(found[0]))
        test = self._begin("release_test")
        release: Release = test(to_array(where), to_array(what), acceleration)
        result = to_bytes([release.balanced, *release.acceleration])
        self._record(CommandKind.RELEASE_TEST, sent, None, result=result)
        return release


def _result(row: Row) -> np.ndarray:
    return to_array(row[10])
