"""Remarks on a recording: outliers, and disagreement with the robot file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.cross_validation import CrossValidation
from isotorque.learning.statistics.causes.cause_words import OR_FRICTION, causes_in_words
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.measured_torques import Disagreement, misread_units

CONSTANT = 2.0
"""Times that constants of the joints must lower a disagreement to be told."""
PREDICTED = {Kind.OFFSET, Kind.GAIN, Kind.SIGN, Kind.SPRING, Kind.CABLE}
NOT_PREDICTED = (
    "the model predicts what sensors show at rest of it (friction, errors of angles and a changed "
    "payload are no part of the model)"
)
SYSTEMATIC = 2.0
"""Times the held-out error from which a disagreement is no accident of single samples."""


def outlier_remarks(
    tried: CrossValidation | None, unfit: NDArray[np.bool_], dropped: bool, count: int
) -> tuple[str, ...]:
    """Say what held out rows tell: the error, and which rows do not fit the others."""
    if tried is None:
        return ("one pose only: no error on held out rows",)
    one = "pose" if tried.poses.repeated else "row"
    way = f"{tried.folds}-fold cross-validation"
    if tried.folds == tried.poses.count:
        way = f"every {one} left out in turn"
    elif tried.poses.repeated:
        way += " by pose"
    words = f"error on held out rows {tried.rmse:.4g} N m ({way}"
    words += f": {tried.poses.count} poses)" if tried.poses.repeated else ")"
    if not unfit.any():
        return (f"{words}; no outliers",)
    worst = tried.worst(count) if len(unfit) == len(tried.outliers) else np.flatnonzero(unfit)
    rows = ", ".join(str(i + 1) for i in worst[:count])
    found = int(unfit.sum())
    more = " ..." if found > count else ""
    kept = "left out of the model" if dropped else "kept; --drop-outliers leaves them out"
    return (
        f"{words}, {tried.rmse_of_others:.4g} N m without outliers",
        f"{found} outliers (row 1 is the first below the header): {rows}{more}; {kept}",
    )


def analytic_remarks(
    compared: Disagreement, tried: CrossValidation | None, samples: StaticSamples, robot: Robot
) -> tuple[str, ...]:
    """Say how the data disagree with the analytic gravity of the robot file."""
    joints = ", ".join(
        f"{name} {rmse:.3g} (mean {mean:+.3g})"
        for name, rmse, mean in zip(
            robot.joint_names, compared.rmse_by_joint, compared.mean_by_joint, strict=True
        )
    )
    repeated = f", {compared.poses} poses" if compared.poses < compared.rows else ""
    data = f"data ({compared.rows} rows{repeated})"
    said = (
        f"{data} less analytic gravity of {robot.name}: {compared.rmse:.4g} N m RMSE, "
        f"{100 * compared.share:.3g} % of the torques; {joints}; at most "
        f"{compared.largest:.4g} N m (row {compared.row + 1})"
    )
    if CONSTANT * compared.rmse_beside_constants < compared.rmse and compared.poses > 1:
        said += (
            f"; {compared.rmse_beside_constants:.4g} N m RMSE beside gravity and a constant torque "
            f"of each joint, its mean{OR_FRICTION}"
        )
    if tried is not None and tried.rmse_of_others > 0:
        times = compared.rmse / tried.rmse_of_others
        if times > SYSTEMATIC:
            said += f"; {times:.3g} times the error on held out rows: systematic"
    remarks = [said]
    misread = misread_units(compared.rmse, compared.rmse_opposite, compared.rmse_degrees)
    if misread:
        remarks.append(misread)
    far = _outside(samples, robot)
    if far:
        remarks.append(f"{far} rows lie outside the joint limits of {robot.name}")
    return tuple(remarks)


def cause_remarks(learner: Any, robot: Robot) -> tuple[str, ...]:
    """Say what a model contains beside gravity, or what its samples show that is no part of it."""
    causes = getattr(learner, "causes_", None)
    if causes is None:
        return _constants(learner, robot)
    if not causes:
        return ()
    said = causes_in_words(causes, robot.joint_names)
    held = {cause.kind for cause in causes} <= PREDICTED
    part = "the model contains it and predicts what sensors show" if held else NOT_PREDICTED
    return (f"beside gravity the data show {said}; {part}",)


def _constants(learner: Any, robot: Robot) -> tuple[str, ...]:
    """Say which constants a model contains whose causes have no names."""
    offsets = np.asarray(getattr(learner, "offsets_", np.zeros(robot.n)))
    found = [
        f"{offsets[j]:+.3g} N m on {robot.joint_names[j]}" for j in np.flatnonzero(offsets).tolist()
    ]
    if not found:
        return ()
    return (
        f"the model contains constant torques, {', '.join(found)}{OR_FRICTION}; it predicts what "
        "sensors show, and errors beside analytic gravity contain them",
    )


def _outside(samples: StaticSamples, robot: Robot) -> int:
    low, high = robot.limits.T
    outside = (samples.q < low - 1e-6) | (samples.q > high + 1e-6)
    return int(np.count_nonzero(outside.any(axis=1)))
