"""The whole scheme on a simulated robot: from the robot to what was learned and its judgement."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from learning.arm import OutcomeKind
from learning.exploration_settings import ExplorationSettings
from learning.exploration_step import ExplorationStep
from learning.learners.by_name import online_learner
from learning.recorded_simulation import RecordedSimulation
from learning.recording import Recording
from learning.run_info import RunInfo
from learning.scheme import Discovery, Scheme, SchemeSettings
from learning.simulation import SimulatedArm
from symbolic.errors import InputError
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup
from symbolic.robots import Robot, load_robot
from symbolic.symmetries import primary_symmetries
from verify.targets import dense_targets

Array = NDArray[np.float64]
Progress = Callable[[str, int, int, str], None]

CURVE_POINTS = 40
"""Points of a learning curve."""


@dataclass(frozen=True)
class RunOptions:
    """What a run is made with; two runs with equal options are equal, bit for bit.

    Attributes
    ----------
    robot : str
        Built-in name or file.
    seed : int
        Seed of all random choices.
    samples : int
        Torques commanded while learning.
    learner : str
        Name of the online learner.
    symmetries : str
        ``learned``, ``exact`` or ``none``.
    n_min : int
        Relations needed before learning begins.
    physics, engine, settle : str
        Of the simulation.
    snap : bool
        Whether rounded angles in the robot file are snapped.
    """

    robot: str
    seed: int = 0
    samples: int = 3000
    learner: str = "local-linear-map-it"
    symmetries: str = "learned"
    n_min: int = 2
    physics: str = "open_loop"
    engine: str = "compiled"
    settle: str = "finished"
    snap: bool = True

    def __post_init__(self) -> None:
        if self.symmetries not in ("learned", "exact", "none"):
            raise InputError("run", "--symmetries", self.symmetries, "learned, exact or none")
        if self.samples < 1:
            raise InputError("run", "--samples", self.samples, "at least 1")
        if self.n_min < 1:
            raise InputError("run", "--n-min", self.n_min, "at least 1")
        online_learner(self.learner, None)


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """The model after some samples: torque RMSE on the dense set [N m], share of BCTS explored."""

    samples: int
    rmse: float
    explored: float | None


@dataclass(eq=False)
class RunOutcome:
    """Everything a run produced, for the judges.

    Attributes
    ----------
    options : RunOptions
    robot : Robot
    gravity : GravityModel
        The truth.
    group : SymmetryGroup
        The true group.
    arm : SimulatedArm
        The simulated arm (to test what was learned on).
    info : RunInfo
        Versions, physics and options as recorded.
    scheme : Scheme
        The learner's side: relations, SST, BCTS, model.
    motions : list of Discovery
        The discovery phase.
    steps : list of ExplorationStep
        The learning phase.
    curve : list of CurvePoint
        RMSE on the dense set while learning.
    seconds : dict of str to float
        Wall-clock time of the stages [s].
    """

    options: RunOptions
    robot: Robot
    gravity: GravityModel
    group: SymmetryGroup
    arm: SimulatedArm
    info: RunInfo
    scheme: Scheme
    motions: list[Discovery] = field(default_factory=list)
    steps: list[ExplorationStep] = field(default_factory=list)
    curve: list[CurvePoint] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)

    def settled(self, items: list[Discovery] | list[ExplorationStep]) -> tuple[Array, Array]:
        """Return settled configurations and torques among motions or steps, (m, n) each."""
        n = self.robot.n
        kept = [x.outcome for x in items if x.outcome.kind is OutcomeKind.SETTLED]
        q = np.array([o.q for o in kept]).reshape(-1, n)
        return q, np.array([o.torque for o in kept]).reshape(-1, n)


def run_experiment(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Discover, learn, and keep every motion; resumes a run that was stopped.

    Parameters
    ----------
    options
        What to run.
    out
        Directory; every motion is committed to ``run.sqlite`` before the next one begins.
    progress
        Called as ``progress(stage, done, total, note)``.

    Returns
    -------
    RunOutcome

    Raises
    ------
    InputError
        For a robot or options that cannot be used, and for a directory that holds another run.
    """
    robot = load_robot(options.robot, snap=options.snap)
    clock: dict[str, float] = {}
    with _timed(clock, "derivation"):
        gravity = GravityModel(robot)
        group = primary_symmetries(gravity.potential)
    arm_rng, rng = np.random.default_rng(options.seed).spawn(2)
    arm = SimulatedArm(
        robot,
        physics=options.physics,
        engine=options.engine,
        settle=options.settle,
        rng=arm_rng,
    )
    written = asdict(options) | {"arm": arm.settings.as_json()}
    del written["robot"]  # the file may move; the digest says which robot it is
    info = RunInfo(
        robot.name,
        robot.digest,
        robot.joint_names,
        options.physics,
        options.engine,
        options.seed,
        written,
    )
    settings = SchemeSettings(
        exploration=ExplorationSettings(), n_min=options.n_min, samples=options.samples
    )
    with Recording.open_or_create(out / "run.sqlite", info) as recording:
        recorded = RecordedSimulation(arm, recording, phase="discovery")
        scheme = Scheme(
            recorded,
            rng,
            lambda known, _range: online_learner(options.learner, known),
            settings,
            group=group if options.symmetries == "exact" else None,
            use_symmetries=options.symmetries != "none",
        )
        result = RunOutcome(options, robot, gravity, group, arm, info, scheme, seconds=clock)
        with _timed(clock, "discovery"):
            for motion in scheme.discover():
                result.motions.append(motion)
                progress("discovering symmetries", len(result.motions), 0, _gate_note(scheme))
            count = len(result.motions)
            progress("discovering symmetries", count, count, _gate_note(scheme))
        recorded.phase = "learning"
        with _timed(clock, "learning"):
            _learn(result, progress)
        recorded.finish()
    return result


def _learn(result: RunOutcome, progress: Progress) -> None:
    dense = dense_targets(result.robot.limits).q
    truth = result.gravity.torque(dense)
    active = np.array([name not in result.gravity.free_joints for name in result.robot.joint_names])
    total = result.options.samples
    every = max(1, total // CURVE_POINTS)
    for step in result.scheme.learn():
        result.steps.append(step)
        count = len(result.steps)
        if count % every == 0 or count == total:
            learner = result.scheme.learner
            assert learner is not None
            error = (learner.predict(dense) - truth)[:, active]
            rmse = float(np.sqrt(np.mean(error**2)))
            result.curve.append(CurvePoint(count, rmse, step.explored))
            progress("learning the inverse statics", count, total, f"RMSE {rmse:.4f} N m")
        else:
            progress("learning the inverse statics", count, total, "")


def _gate_note(scheme: Scheme) -> str:
    if not scheme.gates:
        return ""
    gate = scheme.gates[-1]
    return f"{gate.order} relations after {gate.targets} torques"


@contextmanager
def _timed(clock: dict[str, float], stage: str) -> Iterator[None]:
    start = time.perf_counter()
    yield
    clock[stage] = time.perf_counter() - start
