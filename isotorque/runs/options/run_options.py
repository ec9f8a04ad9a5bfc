"""Options of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from isotorque.learning.exploration.registry import DIRECTIONS, EXPLORATIONS
from isotorque.learning.learners.registry import BATCH_LEARNERS, LEADER, LearningTask
from isotorque.learning.simulator.settings import PhysicsMode, SettleMode
from isotorque.runs.options.settings import Settings, check_learner_settings
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions

LATTICE = "lattice"
STRATEGIES = (*EXPLORATIONS, LATTICE)
LATTICE_SAMPLES, ONLINE_SAMPLES, BATCH_SAMPLES = 255, 3000, 500
"""Samples by default: the paper's lattice; learned one by one; collected for one fit."""
CHAIN = "rigid-chain"
CHAIN_SAMPLES = 100
"""Samples by default where a rigid chain leads: it knows the torque, they try it."""

LARGEST_SEED = 2**63 - 1
"""What a recording can hold."""
MOST_SAMPLES = 10_000_000
"""More would not fit into memory."""


FEW_JOINTS = 3
"""Up to so many joints the paper's learners are the default: it has no arm with more."""


def default_learner(strategy: str, joints: int = 1) -> str:
    """Return the learner where none is named: the paper's for online and for batch learning.

    With more joints than the paper's arms, local models would need very many samples: a Gaussian
    process takes their place.
    """
    if joints > FEW_JOINTS:
        return "gaussian-process"
    return "network" if strategy == LATTICE else "local-linear-map-it"


def default_samples(strategy: str, learner: str) -> int:
    """Return the number of samples where none is given."""
    if strategy == LATTICE:
        return LATTICE_SAMPLES
    if learner == CHAIN:
        return CHAIN_SAMPLES
    return BATCH_SAMPLES if learner in BATCH_LEARNERS else ONLINE_SAMPLES


@dataclass(frozen=True)
class ArmOptions:
    """Options of a simulated arm and its randomness.

    Attributes
    ----------
    seed : int
        Seed of all random choices.
    physics, engine, settle : str
        Of the simulation.
    angle_noise, torque_noise, encoder_step : float
        Errors of the sensors: standard deviations [rad], [N m], and the step that angles are
        rounded to [rad].
    """

    seed: int = 0
    physics: str = "open_loop"
    engine: str = "compiled"
    settle: str = "finished"
    angle_noise: float = 0.0
    torque_noise: float = 0.0
    encoder_step: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.seed <= LARGEST_SEED:
            raise InputError("run", "--seed", self.seed, f"0 to {LARGEST_SEED}")

    @property
    def is_exact(self) -> bool:
        """Whether samples have no errors that a learner should not learn."""
        sensors = self.angle_noise or self.torque_noise or self.encoder_step
        moves = self.settle == SettleMode.RAW or self.physics == PhysicsMode.GEARED
        return not (sensors or moves)


@dataclass(frozen=True)
class RunOptions:
    """Options of a run; two runs with equal options are equal, bit for bit.

    Attributes
    ----------
    robot : RobotOptions
        Built-in name or file, and which part of it is meant; a name alone will do.
    arm : ArmOptions
        The simulated arm.
    n_min : int
        Relations needed before learning begins.
    samples : int
        Torques commanded, or configurations visited, while learning.
    learner : str
        Name of the learner.
    symmetries : str
        ``learned``, ``exact`` or ``none``.
    strategy : str
        Which samples are taken: an exploration, or ``lattice``.
    discovery_arm : ArmOptions or None
        The simulated arm of the discovery, where it is another.
    confirm : int
        Torques at the end of the discovery that are chosen to say most about the relations.
    learn_anyway : bool
        Whether to learn although fewer relations than ``n_min`` are known and confirmed.
    tolerance : float or None
        Torque error that the model is judged with [N m]; None: `default_tolerance`.
    guided_by_need : bool
        Whether the arm was found not to hold itself anywhere, and is guided for that.
    chain : bool
        Whether the model is to be a rigid chain learned from everything that settles, where one is
        accepted; ``learner`` is then what is learned beside it, or, with more joints than the
        paper's arms, what takes its place where none is.
    chain_samples : int
        Samples of the exploration that such a chain leads.
    settings : Settings
        Settings of discovery, exploration, scheme and learner that differ from the usual ones.
    """

    robot: RobotOptions
    arm: ArmOptions = field(default_factory=ArmOptions)
    n_min: int = 2
    samples: int = 3000
    learner: str = "local-linear-map-it"
    symmetries: str = "learned"
    strategy: str = DIRECTIONS
    discovery_arm: ArmOptions | None = None
    confirm: int = 0
    learn_anyway: bool = False
    tolerance: float | None = None
    guided_by_need: bool = False
    chain: bool = False
    chain_samples: int = CHAIN_SAMPLES
    settings: Settings = field(default_factory=Settings)

    def __post_init__(self) -> None:
        object.__setattr__(self, "robot", RobotOptions.of(self.robot))
        check_symmetries(self.symmetries)
        if not 1 <= self.samples <= MOST_SAMPLES:
            raise InputError("run", "--samples", self.samples, f"1 to {MOST_SAMPLES}")
        if self.n_min < 1:
            raise InputError("run", "--n-min", self.n_min, "at least 1")
        if self.confirm < 0:
            raise InputError("run", "--confirm", self.confirm, "at least 0")
        if self.tolerance is not None and not 0 <= self.tolerance < math.inf:
            raise InputError("run", "--tolerance", self.tolerance, "a number >= 0 [N m]")
        if self.strategy not in STRATEGIES:
            raise InputError("run", "--strategy", self.strategy, ", ".join(STRATEGIES))
        if self.strategy == LATTICE and self.arm.physics != PhysicsMode.GUIDED:
            accepted = "guided (a lattice visits what an arm cannot hold by itself)"
            raise InputError("run", "--physics with --strategy lattice", self.arm.physics, accepted)
        chosen = self.settings.learner
        if chosen and self.learner == CHAIN:
            accepted = "nothing: a run decides how it looks for a rigid chain"
            raise InputError("command line", "--set", f"learner.{next(iter(chosen))}", accepted)
        check_learner_settings(self.learner, chosen, LearningTask(robot=self.robot))

    @property
    def discovering(self) -> ArmOptions:
        """The simulated arm of the discovery."""
        return self.arm if self.discovery_arm is None else self.discovery_arm

    @property
    def leader(self) -> str:
        """The learner that estimates the torques of an exploration."""
        if self.chain and self.learner == CHAIN:  # it has learned already
            return CHAIN
        return LEADER if self.learner in BATCH_LEARNERS else self.learner

    @property
    def is_guided(self) -> bool:
        """Whether the arm is guided along the directions of an exploration, not driven."""
        return self.strategy == DIRECTIONS and self.arm.physics == PhysicsMode.GUIDED

    def task(self, joints: int) -> LearningTask:
        """Return what batch learners are told beforehand."""
        return LearningTask(
            joints,
            self.samples,
            not self.arm.is_exact,
            self.robot,
            self.arm.seed,
            parameters=self.settings.learner,
        )


def check_symmetries(which: str) -> str:
    """Return which symmetries are exploited, checked.

    Raises
    ------
    InputError
        For another word than learned, exact or none.
    """
    if which not in ("learned", "exact", "none"):
        raise InputError("run", "--symmetries", which, "learned, exact or none")
    return which
