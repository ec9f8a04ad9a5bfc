"""How your own hardware stands in for the simulator, and how its samples are recorded.

Everything in `learning` sees an arm through three things: ``q``, ``apply(torque) -> Outcome`` and
``go_home()`` (`Arm`). Write a class with these three for your arm and hand it to
whatever takes an arm. ``TorqueDrivenArm`` below is such a class; what it needs of your motor
electronics is a ``Drive``. So that this file runs without an arm, ``BenchPendulum`` plays the
drive of a single hanging rod.

    python examples/own_hardware.py pendulum.sqlite

Stop it with ctrl-C, or pull the plug, and run it again: it goes on where it was stopped.
"""

from __future__ import annotations

import math
import sys
from collections import deque
from pathlib import Path
from typing import Protocol

import numpy as np

from isotorque.learning.arm import LimitHit, Outcome, Settled, TimedOut, Vector
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording


class Drive(Protocol):
    """Your motor electronics: the only part that has to be written anew for every arm."""

    def angles(self) -> Vector:
        """Read the joint angles now [rad], shape (n,)."""
        ...

    def command(self, torque: Vector) -> None:
        """Command these joint torques [N m], shape (n,), until the next call."""
        ...

    def wait(self, seconds: float) -> None:
        """Let that much time pass on the arm."""
        ...


class TorqueDrivenArm:
    """An arm that is moved by constant torques alone (`Arm`).

    Parameters
    ----------
    drive
        The motor electronics.
    limits : (n, 2) array
        Lowest and highest angle of each joint [rad]; stay clear of the mechanical stops.
    period
        Time between two looks at the angles [s].
    still, dwell
        At rest when no angle changed by more than ``still`` [rad] over ``dwell`` [s].
    patience
        A torque that has not led to rest after this time is given up [s].

    Notes
    -----
    Home is where the unpowered arm hangs at rest, so that going home needs no controller.

    ``state()`` and ``restore()``, by which a simulated arm is put back exactly, are left out: no
    program can put back real hardware to the last bit. A resumed run therefore starts from home,
    and its ``q`` says so. If your arm has position control, give it both: ``state`` returns the
    angles, ``restore`` drives there and hands over to torques.
    """

    def __init__(
        self,
        drive: Drive,
        limits: Vector,
        *,
        period: float = 0.01,
        still: float = 1e-4,
        dwell: float = 0.5,
        patience: float = 30.0,
    ) -> None:
        self._drive = drive
        self._limits = np.asarray(limits, dtype=float)
        self._period = period
        self._still = still
        self._looks = math.ceil(dwell / period) + 1
        self._patience = patience

    @property
    def q(self) -> Vector:
        """Joint angles now [rad]."""
        return self._drive.angles()

    def apply(self, torque: Vector) -> Outcome:
        """Apply a constant torque and wait for rest, a limit, or the end of patience."""
        torque = np.asarray(torque, dtype=float)
        self._drive.command(torque)
        recent: deque[Vector] = deque(maxlen=self._looks)
        seconds = 0.0
        while seconds < self._patience:
            self._drive.wait(self._period)
            seconds += self._period
            q = self._drive.angles()
            if np.any(q < self._limits[:, 0]) or np.any(q > self._limits[:, 1]):
                self.go_home()
                return LimitHit(q, torque, seconds)
            recent.append(q)
            if len(recent) == self._looks and np.all(np.ptp(recent, axis=0) < self._still):
                return Settled(q, torque, seconds)
        self.go_home()
        return TimedOut(q, torque, seconds)

    def go_home(self) -> None:
        """Switch the torques off and wait until the arm hangs at rest."""
        self._drive.command(np.zeros(len(self._limits)))
        recent: deque[Vector] = deque([self._drive.angles()], maxlen=self._looks)
        while len(recent) < self._looks or np.any(np.ptp(recent, axis=0) >= self._still):
            self._drive.wait(self._period)
            recent.append(self._drive.angles())


class BenchPendulum:
    """Plays the drive of a damped rod, so that this file runs without hardware.

    m l^2 a = tau - m g l sin(q) - d v with m g l = 2.4 N m, m l^2 = 0.06 kg m^2,
    d = 0.5 N m s/rad.
    """

    def __init__(self) -> None:
        self._q, self._velocity, self._torque = 0.0, 0.0, 0.0

    def angles(self) -> Vector:
        """Read the angle as an encoder of 2^16 counts does [rad]."""
        count = 2 * math.pi / 2**16
        return np.array([round(self._q / count) * count])

    def command(self, torque: Vector) -> None:
        """Hold this torque [N m]."""
        self._torque = float(torque[0])

    def wait(self, seconds: float) -> None:
        """Move for that long [s]."""
        for _ in range(max(1, round(seconds / 1e-3))):
            pull = self._torque - 2.4 * math.sin(self._q) - 0.5 * self._velocity
            self._velocity += 1e-3 * pull / 0.06
            self._q += 1e-3 * self._velocity


def main(path: Path) -> None:
    """Record ten torques and write what was learned as a CSV file beside the recording."""
    torques = np.random.default_rng(1).uniform(-3.0, 3.0, size=(10, 1))
    # The digest is the arm's identity: a run is continued on no other arm. For an arm with a
    # robot file take `load_robot(file).digest`.
    info = RunInfo(
        robot="bench pendulum",
        digest="serial number 0001",
        joint_names=("hinge",),
        physics="hardware",
        engine="bench",
        seed=1,
        options={"torques": len(torques)},
    )
    arm = TorqueDrivenArm(BenchPendulum(), np.array([[-2.5, 2.5]]))
    # sync_seconds=0: every command is on the disk before the next motion, power failure or not.
    with Recording.open_or_create(path, info, sync_seconds=0.0) as recording:
        recorded = RecordedArm(arm, recording)
        for torque in torques:
            again = recorded.is_replaying
            outcome = recorded.apply(torque)
            note = ", as recorded" if again else ""
            print(f"{torque[0]:6.2f} N m: {outcome.kind} at {outcome.q[0]:6.3f} rad{note}")
        recorded.finish()
        with recording.reader() as reader:
            samples = reader.samples()
    write_csv(path.with_suffix(".csv"), samples, info.joint_names)
    print(f"{len(samples.q)} settled samples in {path.with_suffix('.csv')}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "pendulum.sqlite"))
