"""Discovery and learning on a simulated robot, every motion recorded."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.run_options import ArmOptions, RunOptions
from learning.arm import OutcomeKind
from learning.exploration.step import ExplorationStep
from learning.learners.by_name import online_learner
from learning.model_files import SavedModel, save_model
from learning.physics import MeasurementNoise
from learning.recordings.recorded_simulation import RecordedSimulation
from learning.recordings.recording import Recording
from learning.recordings.recording_reader import RecordingReader
from learning.recordings.run_info import RunInfo
from learning.scheme import Discovery, Scheme, SchemeSettings
from learning.simulation.simulated_arm import SimulatedArm
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup
from symbolic.robots import Robot, load_robot
from symbolic.symmetries import primary_symmetries
from verify.models import torque_rmse
from verify.targets import dense_targets

Array = NDArray[np.float64]
Progress = Callable[[str, int, int, str], None]

CURVE_POINTS = 40
"""Points of a learning curve."""
DATABASE = "run.sqlite"
SENSORS = 100
"""Generators of sensors are numbered from here on."""
DISCOVERING, LEARNING = "discovering symmetries", "learning the inverse statics"


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
        The simulated arm (to test on what was learned).
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
    scheme: Scheme
    motions: list[Discovery] = field(default_factory=list)
    steps: list[ExplorationStep] = field(default_factory=list)
    curve: list[CurvePoint] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)

    def ends(self) -> dict[OutcomeKind, int]:
        """How the motions of the discovery ended."""
        kinds = [motion.outcome.kind for motion in self.motions]
        return {kind: kinds.count(kind) for kind in OutcomeKind}


def discover_symmetries(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Find out what the arm can hold, and its symmetries; resumes what was stopped.

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
        Without a model yet.

    Raises
    ------
    InputError
        For a robot or options that cannot be used, and for a directory that holds another run.
    """
    robot = load_robot(options.robot, snap=options.arm.snap)
    clock: dict[str, float] = {}
    with _timed(clock, "derivation"):
        gravity = GravityModel(robot)
        group = primary_symmetries(gravity.potential)
    arm = simulated_arm(robot, options.arm, 0)
    info = _info(robot, arm, options.arm, "discover", {"n_min": options.n_min})
    with (
        Recording.open_or_create(out / DATABASE, info) as recording,
        _timed(clock, "discovery"),
    ):
        recorded = RecordedSimulation(arm, recording, phase="discovery")
        scheme = Scheme(
            recorded,
            _generator(options.arm, 0),
            lambda known, _range: online_learner(options.learner, known),
            SchemeSettings(n_min=options.n_min, samples=options.samples),
            group=group if options.symmetries == "exact" else None,
            use_symmetries=options.symmetries != "none",
        )
        result = RunOutcome(options, robot, gravity, group, arm, scheme, seconds=clock)
        for motion in scheme.discover():
            result.motions.append(motion)
            progress(DISCOVERING, len(result.motions), 0, _gate_note(scheme))
        progress(DISCOVERING, len(result.motions), len(result.motions), _gate_note(scheme))
        recorded.finish()
    return result


def learn_model(result: RunOutcome, out: Path, progress: Progress) -> None:
    """Explore and learn the inverse statics model after a discovery; resumes what was stopped.

    Parameters
    ----------
    result
        From `discover_symmetries`; model, steps and curve are added to it.
    out
        The same directory.
    progress
        Called as ``progress(stage, done, total, note)``.
    """
    options = result.options
    arm = simulated_arm(result.robot, options.arm, 1)
    chosen = {k: getattr(options, k) for k in ("samples", "learner", "symmetries")}
    info = _info(result.robot, arm, options.arm, "learn", chosen)
    with (
        Recording.open_or_create(out / DATABASE, info) as recording,
        _timed(result.seconds, "learning"),
    ):
        recorded = RecordedSimulation(arm, recording, phase="learning")
        result.scheme.arm = recorded
        result.scheme.rng = _generator(options.arm, 1)
        _follow(result, progress)
        recorded.finish()


def run_experiment(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Discover, then learn: the whole scheme of Fig. 8."""
    result = discover_symmetries(options, out, progress)
    learn_model(result, out, progress)
    return result


def save_run_model(result: RunOutcome, out: Path) -> Path:
    """Write the learned model to ``out``; return the path of its JSON."""
    robot = result.robot
    notes = {"learner": result.options.learner, "symmetries": result.options.symmetries}
    saved = SavedModel(result.scheme.learner, robot.name, robot.digest, robot.joint_names, notes)
    return save_model(saved, out)


def with_recorded_discovery(options: RunOptions, out: Path) -> RunOptions:
    """Return the options with the arm of the discovery that ``out`` already holds, if any."""
    path = out / DATABASE
    if not path.is_file():
        return options
    with RecordingReader(path, check=False) as reader:
        for part in reader.parts:
            if part.info.part == "discover":
                recorded = part.info.options
                names = {f.name for f in fields(ArmOptions)}
                arm = ArmOptions(**{k: v for k, v in recorded["made_with"].items() if k in names})
                return replace(options, arm=arm, n_min=int(recorded["n_min"]))
    return options


def _follow(result: RunOutcome, progress: Progress) -> None:
    dense = dense_targets(result.robot.limits).q
    truth = result.gravity.torque(dense)
    active = [name not in result.gravity.free_joints for name in result.robot.joint_names]
    total = result.options.samples
    every = max(1, total // CURVE_POINTS)
    for step in result.scheme.learn():
        result.steps.append(step)
        count, note = len(result.steps), ""
        if count % every == 0 or count == total:
            learner = result.scheme.learner
            assert learner is not None
            rmse = torque_rmse(learner.predict(dense) - truth, active)
            result.curve.append(CurvePoint(count, rmse, step.explored))
            note = f"RMSE {rmse:.4g} N m"
        progress(LEARNING, count, total, note)


def _generator(options: ArmOptions, stage: int) -> np.random.Generator:
    """Return the generator of a stage: learning does not depend on how long discovery took."""
    return np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(stage,)))


def simulated_arm(robot: Robot, options: ArmOptions, stage: int) -> SimulatedArm:
    """Return the arm of a stage; its sensors have a generator of their own."""
    noise = MeasurementNoise(options.angle_noise, options.torque_noise, options.encoder_step)
    return SimulatedArm(
        robot,
        physics=options.physics,
        engine=options.engine,
        settle=options.settle,
        noise=noise,
        rng=_generator(options, SENSORS + stage) if noise.is_random else None,
    )


def _info(
    robot: Robot, arm: SimulatedArm, options: ArmOptions, part: str, more: dict[str, Any]
) -> RunInfo:
    return RunInfo(
        robot.name,
        robot.digest,
        robot.joint_names,
        options.physics,
        options.engine,
        options.seed,
        {**more, "made_with": asdict(options), "arm": arm.settings.as_json()},
        part,
    )


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
