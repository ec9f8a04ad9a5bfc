"""Learning from recordings of a real arm: a CSV file of configurations and holding torques."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.csv_samples import read_csv
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.cross_validation import CrossValidation
from isotorque.learning.learners.registry import LearningTask
from isotorque.learning.recordings.recorded_data import record_samples
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.relations.testing.supported_group import SupportedGroup
from isotorque.learning.statistics.extrapolation import extrapolation
from isotorque.runs.experiment import Progress
from isotorque.runs.from_data.chain_from_data import choice_document
from isotorque.runs.from_data.data_relations import RelationsOfData
from isotorque.runs.from_data.data_remarks import (
    analytic_remarks,
    cause_remarks,
    outlier_remarks,
)
from isotorque.runs.from_data.model_choice import (
    ModelChoice,
    choice_in_words,
    choose_model,
)
from isotorque.runs.lattice_learning import fitted_with_curve
from isotorque.runs.learned_model import LearnedModel
from isotorque.runs.learning_curve import CurvePoint, DenseTest
from isotorque.runs.options.recorded_robot import as_recorded, keep_robot_file
from isotorque.runs.options.run_options import check_symmetries
from isotorque.runs.options.settings import Settings, check_learner_settings
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.verify.models.measured_torques import Disagreement, disagreement

Array = NDArray[np.float64]

WORST = 10
"""Outliers that are named."""
STAGE = "learning from data"


@dataclass(frozen=True)
class DataOptions:
    """Options of learning from a recording.

    Attributes
    ----------
    robot : RobotOptions
        Built-in name or file of the arm; the data are judged against it. A name alone will do.
    file : Path
        The CSV file, see ``read_csv``.
    learner : str or None
        Name of the learner; None: of `CHOICES` the simplest that errs no more than the best at
        poses left out.
    symmetries : str
        ``learned`` from the data, ``exact`` or ``none``, for a learner that is named; the models
        that are tried without one have the symmetries of what they explain.
    drop_outliers : bool
        Whether the model leaves out rows that do not fit the others.
    seed : int
        Seed of all random choices.
    settings : Settings
        Parameters of the learner that is named.
    """

    robot: RobotOptions
    file: Path
    learner: str | None = None
    symmetries: str = "learned"
    drop_outliers: bool = False
    seed: int = 0
    settings: Settings = field(default_factory=Settings)

    def __post_init__(self) -> None:
        object.__setattr__(self, "robot", RobotOptions.of(self.robot))
        check_symmetries(self.symmetries)
        self.settings.require_only("learner")
        if self.learner is not None:
            chosen = self.settings.learner
            check_learner_settings(self.learner, chosen, LearningTask(robot=self.robot))
            return
        if self.settings.values:
            accepted = "a --learner beside it"
            raise InputError("command line", "--set", self.settings.words[0], accepted)

    def task(self, samples: StaticSamples, robot: Robot) -> LearningTask:
        """Return what learners are told beforehand."""
        rows, joints = samples.q.shape
        width = robot.limits[:, 1] - robot.limits[:, 0]
        turning = tuple((np.abs(width - 2.0 * np.pi) < 1e-9).tolist())  # no limits in the file
        return LearningTask(
            joints, rows, True, self.robot, self.seed, turning, self.settings.learner
        )


@single_thread()
def learn_from_data(options: DataOptions, out: Path, progress: Progress) -> LearnedModel:
    """Learn relations and a model from a recording, and say how far it can be trusted.

    Parameters
    ----------
    options
        What to learn.
    out
        Directory; the samples are recorded in ``run.sqlite`` there, in a part of their own.
    progress
        Called as ``progress(stage, done, total, note)``.

    Returns
    -------
    LearnedModel
        ``details`` hold outliers, errors on held out poses, and the disagreement with the analytic
        gravity of the robot.

    Raises
    ------
    InputError
        For a file, robot or options that cannot be used, and for a directory that holds samples of
        another file.
    """
    robot = load_robot(as_recorded(options.robot, out))
    options = replace(options, robot=robot.options)
    samples = read_csv(options.file, robot.joint_names)
    gravity = GravityModel(robot)
    _record(robot, samples, output_directory(out))
    keep_robot_file(options.robot, out)
    task = options.task(samples, robot)
    if options.learner is None:
        made = _chosen(options, samples, robot, gravity, progress)
    else:
        made = _named(options, options.learner, samples, robot, gravity, task, progress)
    progress(STAGE, 3, 3, "")
    unfit = made.outliers
    compared = disagreement(samples.q, samples.tau, gravity, leave_out=unfit)
    beyond = extrapolation(made.learner, made.seen, made.torque, robot.limits)
    return LearnedModel(
        robot,
        gravity,
        made.learner,
        {
            "strategy": "data",
            "learner": made.name,
            "symmetries": options.symmetries,
            "extrapolation": beyond.document(),
        },
        made.samples,
        0,
        made.relations,
        made.curve,
        (
            *made.remarks,
            *cause_remarks(made.learner, robot),
            *([beyond.remark] if beyond.remark else []),
            *outlier_remarks(made.tried, unfit, options.drop_outliers, WORST),
            *analytic_remarks(compared, made.tried, samples, robot),
        ),
        {
            "data": {
                "file": str(options.file),
                "rows": len(samples.q),
                "outliers": _outliers(made.tried, unfit),
                "symmetry_test": _symmetry_test(made.test),
                "held_out": _held_out(made.tried),
                "analytic": _analytic(compared),
                **made.details,
            }
        },
    )


@dataclass(frozen=True, eq=False)
class _Made:
    """A model, and how it came about."""

    learner: Any
    name: str
    seen: Array
    torque: Array
    samples: int
    relations: int
    curve: tuple[CurvePoint, ...]
    remarks: tuple[str, ...]
    tried: CrossValidation | None
    outliers: NDArray[np.bool_]
    test: SupportedGroup | None = None
    details: dict[str, Any] = field(default_factory=dict)


def _chosen(
    options: DataOptions,
    samples: StaticSamples,
    robot: Robot,
    gravity: GravityModel,
    progress: Progress,
) -> _Made:
    """The model that errs least at poses left out."""
    steps = iter(range(3))

    def choose(part: StaticSamples) -> ModelChoice:
        return choose_model(
            part,
            options.robot,
            seed=options.seed,
            joint_names=robot.joint_names,
            report=lambda name: progress(STAGE, min(next(steps, 2), 2), 3, name),
        )

    choice = choose(samples)
    unfit = choice.outliers
    if options.drop_outliers and unfit.any():
        choice = choose(samples.part(~unfit))
    chosen = choice.chosen
    assert chosen is not None  # the parametric model always is there
    test = DenseTest(robot, gravity)
    remarks = choice_in_words(choice, robot.joint_names)
    if options.symmetries == "exact":
        remarks += ("symmetries: those of the model; a --learner that is named has the robot's",)
    return _Made(
        chosen.learner,
        chosen.name,
        choice.samples.q,
        choice.still,
        len(choice.samples.q),
        1,
        (test.point(len(choice.samples.q), chosen.learner),),
        remarks,
        chosen.held_out,
        unfit,
        details=choice_document(choice, robot.joint_names),
    )


def _named(
    options: DataOptions,
    name: str,
    samples: StaticSamples,
    robot: Robot,
    gravity: GravityModel,
    task: LearningTask,
    progress: Progress,
) -> _Made:
    """The learner that was named, with the relations that the data support."""
    stages = iter(range(4))
    found = RelationsOfData(samples, name, task).find(
        options.symmetries, gravity, lambda note: progress(STAGE, next(stages), 3, note)
    )
    group, tried = found.group, found.tried
    everything = np.zeros(len(samples.q), dtype=bool)
    unfit = everything if tried is None else tried.outliers
    progress(STAGE, next(stages), 3, "model")
    used = ~unfit if options.drop_outliers else ~everything
    order = np.random.default_rng(options.seed).permutation(np.flatnonzero(used))
    learner, curve = fitted_with_curve(
        name, task, group, samples.q[order], samples.tau[order], DenseTest(robot, gravity)
    )
    seen = [samples.q[order]]
    if group is not None:
        seen = [wrap(relation.configuration(samples.q[order])) for relation in group]
    return _Made(
        learner,
        name,
        np.concatenate(seen),
        samples.tau[order],
        len(order),
        1 if group is None else group.order,
        curve,
        found.remarks,
        tried,
        unfit,
        found.test,
    )


def _record(robot: Robot, samples: StaticSamples, out: Path) -> None:
    part = robot.options.as_json()
    info = RunInfo(
        robot.name,
        robot.digest,
        robot.joint_names,
        "measured",
        "elsewhere",
        options={"robot": part} if part else {},
        part="data",
    )
    with Recording.open_or_create(out / DATABASE, info) as recording:
        record_samples(recording, samples)
        recording.finish()


def _outliers(tried: CrossValidation | None, unfit: NDArray[np.bool_]) -> dict[str, Any] | None:
    if tried is None:
        return None
    worst = tried.worst(WORST)
    rows = worst if len(unfit) == len(tried.outliers) else np.flatnonzero(unfit)[:WORST]
    return {
        "count": int(unfit.sum()),
        "worst_rows": rows + 1,
        "errors": tried.errors[worst],
    }


def _symmetry_test(test: SupportedGroup | None) -> dict[str, Any] | None:
    if test is None:
        return None
    return {
        "relations": len(test.tested) + 1,
        "contradicted": len(test.contradicted),
        "kept": test.group.order,
        "testable": test.testable,
        "p_value": test.p_value,
    }


def _held_out(tried: CrossValidation | None) -> dict[str, Any] | None:
    if tried is None:
        return None
    return {
        "folds": tried.folds,
        "poses": tried.poses.count,
        "rmse": tried.rmse,
        "rmse_by_joint": tried.rmse_by_joint,
        "rmse_without_outliers": tried.rmse_of_others,
    }


def _analytic(compared: Disagreement) -> dict[str, Any]:
    return {
        "rows": compared.rows,
        "poses": compared.poses,
        "rmse": compared.rmse,
        "rmse_by_joint": compared.rmse_by_joint,
        "mean_by_joint": compared.mean_by_joint,
        "rmse_beside_constants": compared.rmse_beside_constants,
        "share": compared.share,
        "largest": compared.largest,
        "largest_row": compared.row + 1,
    }
