"""Results of a simulated arm beside outcomes: its settings, its state, and tests on it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.settings import (
    EngineName,
    PhysicsMode,
    SensorNoise,
    SettleRule,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SimulationSettings:
    """Everything beside the robot that decides what a simulated arm does.

    Attributes
    ----------
    physics : PhysicsMode
        Physics mode.
    engine : EngineName
        Engine.
    damping, coulomb : tuple of n floats
        Viscous damping [N m s/rad] and Coulomb friction [N m].
    limits : tuple of n pairs
        Joint limits [rad].
    home : tuple of n floats
        Home configuration [rad].
    rule : SettleRule
        When the arm counts as settled.
    noise : SensorNoise
        Errors of the sensors.
    """

    physics: PhysicsMode
    engine: EngineName
    damping: tuple[float, ...]
    coulomb: tuple[float, ...]
    limits: tuple[tuple[float, float], ...]
    home: tuple[float, ...]
    rule: SettleRule
    noise: SensorNoise

    def as_json(self) -> dict[str, Any]:
        """Return the settings as a JSON document; a joint without limit has null there."""
        document = asdict(self)
        document["limits"] = [[x if np.isfinite(x) else None for x in pair] for pair in self.limits]
        return document


@dataclass(frozen=True)
class ArmState:
    """The full state of a simulated arm between two commands.

    Attributes
    ----------
    q, v : tuple of n floats
        True joint angles [rad] and velocities [rad/s].
    observed : tuple of n floats
        Joint angles as last observed [rad].
    generator : dict or None
        State of the random generator; None for an arm that has none.

    Notes
    -----
    ``json.loads(json.dumps(dataclasses.asdict(state)))`` loses nothing: restored from it, an arm
    goes on bit for bit as it would have.
    """

    q: tuple[float, ...]
    v: tuple[float, ...]
    observed: tuple[float, ...]
    generator: dict[str, Any] | None

    @classmethod
    def from_json(cls, document: dict[str, Any]) -> ArmState:
        """Read a state from the JSON document of `dataclasses.asdict`."""
        return cls(
            tuple(document["q"]),
            tuple(document["v"]),
            tuple(document["observed"]),
            document["generator"],
        )


@dataclass(frozen=True, eq=False)
class Hold:
    """Whether a torque reaches and maintains a configuration (the paper's tests).

    Attributes
    ----------
    held : bool
        Whether the arm, placed at rest at the configuration, was still near it at the end.
    distance : float
        Euclidean distance from the configuration at the end [rad]; infinite after a limit hit.
    q : (n,) array
        Joint angles at the end [rad].
    """

    held: bool
    distance: float
    q: Array


@dataclass(frozen=True, eq=False)
class Release:
    """First motion of an arm that is released at rest under a torque.

    Attributes
    ----------
    acceleration : (n,) array
        Initial acceleration [rad/s^2].
    balanced : bool
        Whether no joint's exceeds the bound: an equilibrium, stable or not.
    """

    acceleration: Array
    balanced: bool
