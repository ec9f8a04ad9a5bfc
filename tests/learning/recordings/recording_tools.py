"""An arm, an algorithm and pictures of a file, for the tests of recordings."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.learning.arm import LimitHit, Outcome, Playback, Settled, TimedOut, Vector
from isotorque.learning.files.run_info import RunInfo, generator_state

NAMES = ("shoulder", "elbow")
INFO = RunInfo("toy", "0123abcd", NAMES, seed=1, options={"steps": 40})


class ToyArm:
    """A deterministic two-joint arm with memory: the next angles depend on the last in every bit.

    Its measurement noise comes from a generator of its own; some torques hit limits or time out.
    """

    def __init__(self, seed: int = 5) -> None:
        self._rng = np.random.default_rng(seed)
        self._true = np.zeros(2)
        self._seen = np.zeros(2)
        self.motions = 0

    @property
    def q(self) -> Vector:
        return self._seen.copy()

    def apply(self, torque: Vector) -> Outcome:
        self.motions += 1
        moved = np.sin(3.7 * self._true + np.asarray(torque) + 0.3)
        seen = moved + 1e-3 * self._rng.standard_normal(2)
        felt = torque + 1e-3 * self._rng.standard_normal(2)
        seconds = float(abs(moved).sum())
        if abs(moved).max() > 0.98:
            self.go_home()
            return (LimitHit if moved[0] > 0 else TimedOut)(seen, felt, seconds)
        self._true, self._seen = moved, seen
        return Settled(seen.copy(), felt, seconds)

    def go_home(self) -> None:
        self.motions += 1
        self._true = np.zeros(2)
        self._seen = 1e-3 * self._rng.standard_normal(2)

    def play(self, torques: Vector, step_seconds: float) -> Playback:
        count = 1 + len(torques) // 2
        q = np.array([self.apply(torque).q for torque in torques[:count]])
        outcome = self.apply(torques[-1])
        times = step_seconds * np.arange(1.0, count + 1)
        return Playback(outcome, times, q, np.array(torques[:count]))

    def state(self) -> dict[str, Any]:
        return {
            "true": self._true.tolist(),
            "seen": self._seen.tolist(),
            "generator": generator_state(self._rng),
        }

    def restore(self, state: dict[str, Any]) -> None:
        self._true = np.array(state["true"])
        self._seen = np.array(state["seen"])
        self._rng.bit_generator.state = state["generator"]


def explore(arm: Any, commands: Sequence[str], seed: int) -> Iterator[bytes]:
    """Give commands whose torques depend on all that was seen before; yield what came of each."""
    rng = np.random.default_rng(seed)
    memory = np.zeros(2)
    for command in commands:
        torque = 0.5 * memory + rng.uniform(-2.0, 2.0, 2)
        if command == "apply":
            outcome = arm.apply(torque)
            seen = [*outcome.q, *outcome.torque, outcome.seconds]
            word = outcome.kind.value
        elif command == "play":
            played = arm.play(np.linspace(memory, torque, int(rng.integers(1, 6))), 0.25)
            seen = [*played.times, *played.q.ravel(), *played.torques.ravel(), *played.outcome.q]
            word = played.outcome.kind.value
        else:
            arm.go_home()
            seen, word = [], "home"
        memory = np.tanh(memory + arm.q + sum(seen))
        yield word.encode() + np.array([*seen, *arm.q, *memory]).tobytes()


def files(path: Path) -> dict[str, bytes]:
    """Every file of a recording, bit for bit (not the index of the log, which is scratch)."""
    scratch = (path.name + "-shm", path.name + ".lock")
    return {
        entry.name: entry.read_bytes()
        for entry in sorted(path.parent.iterdir())
        if entry.name.startswith(path.name) and entry.name not in scratch
    }


def tables(path: Path) -> dict[str, list[tuple[Any, ...]]]:
    """All that a recording says, but for when and with what software it was opened."""
    connection = sqlite3.connect(path)
    try:
        names = ("robot", "part", "command", "motion", "arm_state", "checkpoint")
        return {name: connection.execute(f"select * from {name}").fetchall() for name in names}
    finally:
        connection.close()
