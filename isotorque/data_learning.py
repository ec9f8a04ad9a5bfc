"""Learning from recordings of a real arm: a CSV file of configurations and holding torques."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.data_remarks import analytic_remarks, outlier_remarks
from isotorque.experiment import Progress
from isotorque.lattice_learning import fitted_with_curve
from isotorque.learned_model import LearnedModel
from isotorque.learning_curve import DenseTest
from isotorque.run_options import check_symmetries
from isotorque.single_thread import single_thread
from isotorque.stages import DATABASE
from learning.held_out import HeldOut, held_out
from learning.learners.by_name import LearningTask, check_learner, learner_by_name
from learning.recordings.csv_data import StaticSamples, read_csv
from learning.recordings.recorded_data import record_samples
from learning.recordings.recording import Recording
from learning.recordings.run_info import RunInfo
from learning.relations.relation_learning import learn_relations
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup
from symbolic.robots import Robot, load_robot
from symbolic.symmetries import primary_symmetries
from verify.measured_torques import Disagreement, disagreement

Array = NDArray[np.float64]

MANY_ROWS = 1000
"""More samples than these are too many for a Gaussian process by default."""
EQUATIONS = 2
"""Equations per coefficient from which the form of rigid gravity is fitted without symmetries."""
WORST = 10
"""Outliers that are named."""
STAGE = "learning from data"


@dataclass(frozen=True)
class DataOptions:
    """How to learn from a recording.

    Attributes
    ----------
    robot : str
        Built-in name or file of the arm; the data are judged against it.
    file : Path
        The CSV file, see ``learning.recordings.csv_data.read_csv``.
    learner : str or None
        Name of the learner; None: a Gaussian process, beyond ``MANY_ROWS`` rows a network.
    symmetries : str
        ``learned`` from the data, ``exact`` or ``none``.
    drop_outliers : bool
        Whether the model leaves out rows that do not fit the others.
    seed : int
        Seed of all random choices.
    snap : bool
        Whether rounded angles in the robot file are snapped.
    """

    robot: str
    file: Path
    learner: str | None = None
    symmetries: str = "learned"
    drop_outliers: bool = False
    seed: int = 0
    snap: bool = True

    def __post_init__(self) -> None:
        check_symmetries(self.symmetries)
        if self.learner is not None:
            check_learner(self.learner)

    def task(self, samples: StaticSamples) -> LearningTask:
        """Return what learners are told beforehand."""
        rows, joints = samples.q.shape
        return LearningTask(joints, rows, True, self.robot, self.snap, self.seed)


@dataclass(frozen=True, eq=False)
class _Relations:
    """Relations to exploit, and what to say about them."""

    group: SymmetryGroup | None
    remarks: tuple[str, ...] = field(default=())


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
        ``details`` hold outliers, errors on held out rows, and the disagreement with the analytic
        gravity of the robot.

    Raises
    ------
    InputError
        For a file, robot or options that cannot be used, and for a directory that holds samples of
        another file.
    """
    robot = load_robot(options.robot, snap=options.snap)
    samples = read_csv(options.file, robot.joint_names)
    gravity = GravityModel(robot)
    out.mkdir(parents=True, exist_ok=True)
    _record(robot, samples, out)
    name = options.learner or ("gaussian-process" if len(samples.q) <= MANY_ROWS else "network")
    task = options.task(samples)

    progress(STAGE, 0, 4, "relations")
    everything = np.zeros(len(samples.q), dtype=bool)
    relations = _relations(options, gravity, samples, everything)
    left_out = everything
    if options.symmetries == "learned" and relations.group is None:
        # one wrong row hides every symmetry: look for such rows, and then again for symmetries
        left_out = _screened(name, task, samples)
        if left_out.any():
            relations = _relations(options, gravity, samples, left_out)
    progress(STAGE, 1, 4, "errors on held out rows")
    tried = _tried(name, relations.group, task, samples)
    unfit = everything if tried is None else tried.outliers
    if options.symmetries == "learned" and not np.array_equal(unfit, left_out):
        relations = _relations(options, gravity, samples, unfit)
        tried = _tried(name, relations.group, task, samples)
        unfit = everything if tried is None else tried.outliers
    group = relations.group
    progress(STAGE, 3, 4, "model")
    used = ~unfit if options.drop_outliers else ~everything
    order = np.random.default_rng(options.seed).permutation(np.flatnonzero(used))
    learner, curve = fitted_with_curve(
        name, task, group, samples.q[order], samples.tau[order], DenseTest(robot, gravity)
    )
    progress(STAGE, 4, 4, "")
    compared = disagreement(samples.q, samples.tau, gravity, leave_out=unfit)
    return LearnedModel(
        robot,
        gravity,
        learner,
        {"strategy": "data", "learner": name, "symmetries": options.symmetries},
        len(order),
        0,
        1 if group is None else group.order,
        curve,
        (
            *relations.remarks,
            *outlier_remarks(tried, options.drop_outliers, WORST),
            *analytic_remarks(compared, tried, samples, robot),
        ),
        {
            "data": {
                "file": str(options.file),
                "rows": len(samples.q),
                "outliers": _outliers(tried),
                "held_out": _held_out(tried),
                "analytic": _analytic(compared),
            }
        },
    )


def _record(robot: Robot, samples: StaticSamples, out: Path) -> None:
    info = RunInfo(
        robot.name, robot.digest, robot.joint_names, "measured", "elsewhere", part="data"
    )
    with Recording.open_or_create(out / DATABASE, info) as recording:
        record_samples(recording, samples)
        recording.finish()


def _relations(
    options: DataOptions, gravity: GravityModel, samples: StaticSamples, left_out: NDArray[np.bool_]
) -> _Relations:
    if options.symmetries == "none":
        return _Relations(None)
    if options.symmetries == "exact":
        return _Relations(primary_symmetries(gravity.potential))
    learned = learn_relations(samples.q[~left_out], samples.tau[~left_out])
    said = f"{learned.order} symmetry relations learned from the data"
    if learned.missing:
        said += f"; missing: {learned.missing}"
    if left_out.any():
        said += f"; {int(left_out.sum())} outliers left out for that"
    known = learned.order > 1 or learned.group.rank < learned.group.n
    return _Relations(learned.group if known else None, (said,))


def _tried(
    name: str, group: SymmetryGroup | None, task: LearningTask, samples: StaticSamples
) -> HeldOut | None:
    if len(samples.q) < 2:
        return None
    rng = np.random.default_rng(task.seed)
    return held_out(lambda: learner_by_name(name, group, task), samples.q, samples.tau, rng)


def _screened(name: str, task: LearningTask, samples: StaticSamples) -> NDArray[np.bool_]:
    """Outliers by the form of rigid gravity where the rows suffice for it, else by the learner."""
    rows, joints = samples.q.shape
    plenty = rows * joints >= EQUATIONS * 3**joints
    tried = _tried("trigonometric" if plenty else name, None, task, samples)
    return np.zeros(rows, dtype=bool) if tried is None else tried.outliers


def _outliers(tried: HeldOut | None) -> dict[str, Any] | None:
    if tried is None:
        return None
    worst = tried.worst(WORST)
    return {
        "count": int(tried.outliers.sum()),
        "worst_rows": worst + 1,
        "errors": tried.errors[worst],
    }


def _held_out(tried: HeldOut | None) -> dict[str, Any] | None:
    if tried is None:
        return None
    return {
        "folds": tried.folds,
        "rmse": tried.rmse,
        "rmse_by_joint": tried.rmse_by_joint,
        "rmse_without_outliers": tried.rmse_of_others,
    }


def _analytic(compared: Disagreement) -> dict[str, Any]:
    return {
        "rows": compared.rows,
        "rmse": compared.rmse,
        "rmse_by_joint": compared.rmse_by_joint,
        "mean_by_joint": compared.mean_by_joint,
        "share": compared.share,
        "largest": compared.largest,
        "largest_row": compared.row + 1,
    }
