"""What a run is made with."""

from __future__ import annotations

from dataclasses import dataclass, field

from learning.learners.by_name import online_learner
from symbolic.errors import InputError


@dataclass(frozen=True)
class ArmOptions:
    """Which simulated arm, and with which randomness.

    Attributes
    ----------
    seed : int
        Seed of all random choices.
    physics, engine, settle : str
        Of the simulation.
    snap : bool
        Whether rounded angles in the robot file are snapped.
    angle_noise, torque_noise, encoder_step : float
        Errors of the sensors: standard deviations [rad], [N m], and the step that angles are
        rounded to [rad].
    """

    seed: int = 0
    physics: str = "open_loop"
    engine: str = "compiled"
    settle: str = "finished"
    snap: bool = True
    angle_noise: float = 0.0
    torque_noise: float = 0.0
    encoder_step: float = 0.0


@dataclass(frozen=True)
class RunOptions:
    """What a run is made with; two runs with equal options are equal, bit for bit.

    Attributes
    ----------
    robot : str
        Built-in name or file.
    arm : ArmOptions
        The simulated arm.
    n_min : int
        Relations needed before learning begins.
    samples : int
        Torques commanded while learning.
    learner : str
        Name of the online learner.
    symmetries : str
        ``learned``, ``exact`` or ``none``.
    """

    robot: str
    arm: ArmOptions = field(default_factory=ArmOptions)
    n_min: int = 2
    samples: int = 3000
    learner: str = "local-linear-map-it"
    symmetries: str = "learned"

    def __post_init__(self) -> None:
        if self.symmetries not in ("learned", "exact", "none"):
            raise InputError("run", "--symmetries", self.symmetries, "learned, exact or none")
        if self.samples < 1:
            raise InputError("run", "--samples", self.samples, "at least 1")
        if self.n_min < 1:
            raise InputError("run", "--n-min", self.n_min, "at least 1")
        online_learner(self.learner, None)
