"""Discovery and learning on a simulated robot, every motion recorded."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.discovery.torque_limits import TorqueLimitedArm
from isotorque.learning.exploration.guided_arm import LimitedGuidedArm
from isotorque.learning.exploration.registry import DIRECTIONS, GUIDED_DIRECTIONS
from isotorque.learning.files.saved_models import SavedModel, save_model
from isotorque.learning.learners.memory.collected_samples import CollectedSamples
from isotorque.learning.learners.registry import BATCH_LEARNERS, learner_by_name, online_learner
from isotorque.learning.recordings.recorded_simulation import RecordedSimulation
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.scheme import LearnerFactory, Scheme, SchemeSettings
from isotorque.learning.simulator.settings import PhysicsMode
from isotorque.runs.chain_model import (
    chain_curve,
    choose_model,
    is_usable,
    let_chain_lead,
    told_parents,
)
from isotorque.runs.learning_curve import DenseTest, curve_counts
from isotorque.runs.options.recorded_robot import keep_robot_file
from isotorque.runs.options.run_options import CHAIN, LATTICE, RunOptions
from isotorque.runs.run_outcome import RunOutcome
from isotorque.runs.stages import DATABASE, random_generator, run_info, simulated_arm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup, check_listable
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]
Progress = Callable[[str, int, int, str], None]

DISCOVERING, LEARNING = "discovering symmetries", "learning the inverse statics"


def prepare_run(options: RunOptions) -> RunOutcome:
    """Load the robot and derive the truth about it; nothing moves yet.

    Raises
    ------
    InputError
        For a robot or options that cannot be used.
    """
    made_with = options.discovering
    robot = load_robot(options.robot)
    clock: dict[str, float] = {}
    with timed(clock, "derivation"):
        gravity = GravityModel(robot)
        group = primary_symmetries(gravity.potential)
    check_listable(group, options.robot.spec, robot.joint_names)
    arm = simulated_arm(robot, made_with, 0)
    scheme = Scheme(
        arm,
        random_generator(made_with, 0),
        _learner_factory(options, robot.n),
        _scheme_settings(options, told_parents(robot.tree.parents)),
        group=group if options.symmetries == "exact" else None,
        use_symmetries=options.symmetries != "none",
    )
    return RunOutcome(options, robot, gravity, group, arm, scheme, seconds=clock)


@single_thread()
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
    result = prepare_run(options)
    made_with, arm, scheme = options.discovering, result.arm, result.scheme
    chosen: dict[str, Any] = {"n_min": options.n_min}
    if options.confirm:  # recordings that were made without it stay as they are
        chosen["confirm"] = options.confirm
    chosen |= options.settings.recorded("discovery", "scheme")
    info = run_info(result.robot, arm, made_with, "discover", chosen)
    with (
        Recording.open_or_create(out / DATABASE, info) as recording,
        timed(result.seconds, "discovery"),
    ):
        keep_robot_file(options.robot, out)
        recorded = RecordedSimulation(arm, recording, phase="discovery")
        limited = TorqueLimitedArm(recorded, result.robot.effort)
        is_guided = made_with.physics == PhysicsMode.GUIDED
        scheme.arm = LimitedGuidedArm(limited, result.robot.limits) if is_guided else limited
        for motion in scheme.discover():
            result.motions.append(motion)
            progress(DISCOVERING, len(result.motions), 0, _gate_note(scheme))
        progress(DISCOVERING, len(result.motions), len(result.motions), _gate_note(scheme))
        recorded.finish()
    result.remarks += _torques_cut(limited, "discovery")
    known = scheme.learned
    if options.confirm and known is not None and known.fit is None:
        why = "relations are those of a rigid chain" if known.chain else "no potential is known"
        result.remarks += (f"no torques were chosen to confirm the relations: {why}",)
    return result


@single_thread()
def learn_model(result: RunOutcome, out: Path, progress: Progress) -> None:
    """Explore and learn the inverse statics model after a discovery; resumes what was stopped.

    Parameters
    ----------
    result
        From `discover_symmetries`; model, steps and curve are added to it, unless it
        `stops_before_learning`.
    out
        The same directory.
    progress
        Called as ``progress(stage, done, total, note)``.

    Raises
    ------
    InputError
        If the discovery found no torque that the arm can hold by itself.
    """
    let_chain_lead(result)
    options, scheme = result.options, result.scheme
    if not np.any(result.gravity.potential.frequencies):
        accepted = "an arm that gravity moves; --gravity X,Y,Z says how it is mounted"
        raise InputError(result.robot.name, "torque of gravity", "0 at every joint", accepted)
    if not scheme.torque_range.any():
        what = f"number of torques held by itself, in {len(result.motions)} motions,"
        accepted = "some; guided physics leads an arm that holds none"
        raise InputError(result.robot.name, what, 0, accepted)
    if result.stops_before_learning:
        return
    if scheme.home_torque is None and not options.is_guided:
        accepted = f"{DIRECTIONS} or {LATTICE}: the arm cannot hold itself and has to be guided"
        raise InputError(result.robot.name, "strategy", options.strategy, accepted)
    arm = simulated_arm(result.robot, options.arm, 1)
    chosen: dict[str, Any] = {k: getattr(options, k) for k in ("samples", "symmetries", "strategy")}
    # a batch learner does not change what the arm does: another one may use the same samples
    chosen["learner"] = options.leader
    if not result.gate_passed:  # as asked for; where it is passed the option changes nothing
        chosen["learn_anyway"] = True
    led_by = ("learner",) if options.leader == options.learner else ()
    chosen |= options.settings.recorded("exploration", "scheme", *led_by)
    info = run_info(result.robot, arm, options.arm, "learn", chosen)
    with (
        Recording.open_or_create(out / DATABASE, info) as recording,
        timed(result.seconds, "learning"),
    ):
        recorded = RecordedSimulation(arm, recording, phase="learning")
        limited = TorqueLimitedArm(recorded, result.robot.effort)
        moved: Any = (
            LimitedGuidedArm(limited, result.robot.limits) if options.is_guided else limited
        )
        scheme.arm = moved
        scheme.rng = random_generator(options.arm, 1)
        if options.leader == CHAIN:
            scheme.make_learner = lambda group, span: scheme.chain
        _follow(result, progress)
        recorded.finish()
        learner = scheme.learner
        if isinstance(learner, CollectedSamples):
            scheme.learner = learner.fitted_learner()
        choose_model(result)
        if options.leader == CHAIN:
            result.curve = chain_curve(result)
    result.remarks += _torques_cut(limited, "learning")


def run_experiment(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Discover, then learn: the whole scheme of Fig. 8."""
    result = discover_symmetries(options, out, progress)
    learn_model(result, out, progress)
    return result


def save_run_model(result: RunOutcome, out: Path) -> Path:
    """Write the learned model to ``out``; return the path of its JSON."""
    options = result.options
    notes = {k: getattr(options, k) for k in ("symmetries", "strategy", "samples")}
    notes["learner"] = result.model_name
    if result.model_name == CHAIN and result.knowledge is not None:
        notes["verdict"] = result.knowledge.said
        notes["known_after_poses"] = result.knowledge.known_after
    if not result.gate_passed:
        notes["learn_anyway"] = True
    return save_learner(result.model, result.robot, notes, out)


def save_learner(learner: Any, robot: Robot, notes: dict[str, Any], out: Path) -> Path:
    """Write a learner of a robot to ``out``; return the path of its JSON."""
    part = robot.options.as_json()
    if part:
        notes = notes | {"robot_options": part}
    saved = SavedModel(learner, robot.name, robot.digest, robot.joint_names, notes)
    return save_model(saved, out)


def _scheme_settings(options: RunOptions, parents: tuple[int, ...] | None) -> SchemeSettings:
    strategy = DIRECTIONS if options.strategy == LATTICE else options.strategy
    strategy = GUIDED_DIRECTIONS if options.is_guided else strategy
    return SchemeSettings(
        options.settings.discovery,
        options.settings.exploration,
        n_min=options.n_min,
        samples=options.samples,
        strategy=strategy,
        confirm=options.confirm,
        guided=options.discovering.physics == PhysicsMode.GUIDED,
        parents=parents,
        **options.settings.scheme,
    )


def _learner_factory(options: RunOptions, joints: int) -> LearnerFactory:
    """Make what an exploration teaches: the online learner, or one that leads and collects."""

    def make(group: SymmetryGroup | None, torque_range: Array) -> Any:
        if options.learner not in BATCH_LEARNERS:
            return online_learner(options.learner, group, options.settings.learner)
        task = options.task(joints)
        return CollectedSamples(
            online_learner(options.leader, group),
            lambda: learner_by_name(options.learner, group, task),
        )

    return make


def _follow(result: RunOutcome, progress: Progress) -> None:
    test = DenseTest(result.robot, result.gravity)
    total = result.options.samples
    leads = result.options.leader == CHAIN  # a chain has a curve of its own, `chain_curve`
    counts = frozenset[int]() if leads else curve_counts(result.options.learner, total)
    for step in result.scheme.learn():
        result.steps.append(step)
        count, note = len(result.steps), ""
        if count in counts:
            learner: Any = result.scheme.learner
            model = learner.fitted_learner() if hasattr(learner, "fitted_learner") else learner
            if is_usable(model):
                point = test.point(count, model, step.explored)
                result.curve.append(point)
                note = f"RMSE {point.rmse:.4g} N m, largest error {point.largest:.4g} N m"
        progress(LEARNING, count, total, note)


def _gate_note(scheme: Scheme) -> str:
    if not scheme.gates:
        return ""
    gate = scheme.gates[-1]
    return f"{gate.order} relations after {gate.targets} torques"


def _torques_cut(arm: TorqueLimitedArm, phase: str) -> tuple[str, ...]:
    if not arm.cut:
        return ()
    return (f"{arm.cut} torques of the {phase} were cut to the largest of their joints' motors",)


@contextmanager
def timed(clock: dict[str, float], stage: str) -> Iterator[None]:
    """Note the wall-clock time [s] that a stage takes."""
    start = time.perf_counter()
    yield
    clock[stage] = time.perf_counter() - start
