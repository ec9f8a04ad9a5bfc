"""Judge of a model by fresh measurements: torques that it has not seen, and no robot file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.files.saved_models import SavedModel
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.statistics.extrapolation import MARGIN, standard_errors
from isotorque.learning.statistics.fresh_errors import (
    LEAST_POSES,
    RESOLVED,
    FreshErrors,
    RowNoise,
    errors_by_pose,
    scatter_within_poses,
    unknown_noise,
)
from isotorque.learning.statistics.poses import Poses, group_poses
from isotorque.learning.statistics.remaining_errors import explained
from isotorque.symbolic.common.errors import InputError
from isotorque.verify.models.largest_errors import LEAST_SHARE, SHARE
from isotorque.verify.models.measured_torques import misread_units
from isotorque.verify.models.verify_model import checked_predictions
from isotorque.verify.verdict import Status, Verdict, sizes

Array = NDArray[np.float64]

OBJECT = "the torque that was measured"
"""What the claims are about, where a robot file may be meant too."""
ALIKE = 0.1
"""Joints that moved less [rad] say nothing of other angles."""
FEW_REPEATS = 5
"""Degrees of freedom from which the scatter within poses is preferred to what a model states."""
STEP = 1e-4
"""For slopes of predictions [rad]."""


@dataclass(frozen=True, eq=False)
class FreshMeasurements:
    """Torques measured after a model or relations were made.

    Attributes
    ----------
    file : Path
        Where they come from.
    samples : StaticSamples
        One row per measurement.
    joint_names : tuple of str
        Joints in the order of the columns.
    poses : Poses
        Which rows are of one pose.

    Raises
    ------
    InputError
        If the torques are all zero or all the same though angles differ, or the poses are fewer
        than say anything of others.
    """

    file: Path
    samples: StaticSamples
    joint_names: tuple[str, ...]
    poses: Poses

    def __post_init__(self) -> None:
        tau, moved = self.samples.tau, self.poses.count > 1
        if not tau.any():
            accepted = "torques that were measured: beside zero every model of zeros would pass"
            raise InputError(self.file, "torques", "zero in every row", accepted)
        if moved and not np.ptp(tau, axis=0).any():
            found = f"the same in all {len(tau)} rows, though angles differ"
            raise InputError(self.file, "torques", found, "torques measured in each of the poses")
        if self.poses.count < LEAST_POSES:
            rows = f"{self.poses.count} ({len(tau)} rows; rows of one pose count as one)"
            accepted = f"at least {LEAST_POSES}: fewer say nothing of other poses"
            raise InputError(self.file, "number of different poses", rows, accepted)

    @classmethod
    def of(
        cls, file: Path, samples: StaticSamples, joint_names: tuple[str, ...]
    ) -> FreshMeasurements:
        """The measurements of a file, grouped into poses."""
        return cls(file, samples, joint_names, group_poses(samples.q))

    @property
    def q(self) -> Array:
        """Configurations of the poses, (P, n) [rad]."""
        return self.poses.configurations(self.samples.q)

    @property
    def tau(self) -> Array:
        """Mean torques of the poses, (P, n) [N m]."""
        return self.poses.means(self.samples.tau)

    @property
    def span(self) -> Array:
        """How far every joint moved, (n,) [rad]."""
        return np.asarray(np.ptp(self.q, axis=0))

    def default_tolerance(self) -> Array:
        """1 % of each joint's largest measured torque, at least 1e-3 of the arm's, (n,) [N m]."""
        largest = np.abs(self.tau).max(axis=0)
        return np.maximum(SHARE * largest, LEAST_SHARE * largest.max())

    def tolerances(self, tolerance: float | None) -> Array:
        """What is asked for, (n,) [N m]; the default where it is None.

        Raises
        ------
        InputError
            If it is negative or no finite number.
        """
        if tolerance is None:
            return self.default_tolerance()
        if not 0.0 <= tolerance < np.inf:
            raise InputError("measurements", "tolerance", tolerance, "a finite number >= 0 [N m]")
        return np.full(len(self.joint_names), tolerance)

    def row(self, pose: int) -> int:
        """First row of a pose, from 1 on: the first below the header."""
        return int(np.argmax(self.poses.label == pose)) + 1

    def noise(
        self, errors: Array, stated: MeasurementNoise | None, predict: Callable[[Array], Array]
    ) -> RowNoise:
        """Noise of the rows where it is stated, else by the scatter of errors within poses.

        Parameters
        ----------
        errors : (N, n) array
            Measured torques less what is expected of the poses [N m].
        stated
            What the user says.
        predict
            Torques (m, n) [N m] at configurations (m, n) [rad]: noise of angles acts through its
            slopes.
        """
        if stated is not None:
            return _through_slopes(self.samples.q, predict, stated.torque, stated.angle, "stated")
        scatter = scatter_within_poses(errors, self.poses)
        return unknown_noise(errors) if scatter is None else scatter


@dataclass(frozen=True, eq=False)
class MeasuredJudgement:
    """What fresh measurements say.

    Attributes
    ----------
    verdicts : tuple of Verdict
        On the measured torque.
    remarks : tuple of str
        What else was found, one sentence part each.
    document : dict
        The same as plain data.
    """

    verdicts: tuple[Verdict, ...]
    remarks: tuple[str, ...]
    document: dict[str, Any]


def verify_on_measurements(
    saved: SavedModel,
    fresh: FreshMeasurements,
    *,
    tolerance: float | None = None,
    noise: MeasurementNoise | None = None,
) -> MeasuredJudgement:
    """Judge a model by torques that were measured at poses, and by nothing else.

    Parameters
    ----------
    saved
        The model; its learner has ``predict(q)``.
    fresh
        Measurements that it was not learned from.
    tolerance
        Error that every joint is allowed, RMSE and largest [N m]; by default 1 % of its largest
        measured torque, at least 1e-3 of the arm's.
    noise
        Noise of the measurements where it is known; otherwise the scatter within repeated poses
        tells, and where there is none what the model states (a rigid chain). Where neither does,
        all of the error counts as the model's.

    Returns
    -------
    MeasuredJudgement
        One verdict on the RMSE of each joint, one on the largest error of a pose: ``tested`` or
        ``refuted``; the former ``not tested`` where an error of three times the tolerance could
        have passed for noise, or all poses are alike. Nothing is proved by measurements.

    Raises
    ------
    InputError
        If predictions are no finite torques.

    Notes
    -----
    Rows of one pose count as one. What is compared, joint by joint: the RMSE over the poses with
    what noise and an error of the tolerance explain together (`fresh_errors`), and every pose's
    error likewise. The model's own standard error excuses nothing: it is only told whether it
    explains what is left.
    """
    predict = checked_predictions(saved.learner.predict)
    errors = fresh.samples.tau - predict(fresh.samples.q)
    allowed = fresh.tolerances(tolerance)
    known = _noise(saved.learner, fresh, errors, noise, predict)
    found = errors_by_pose(errors, fresh.poses, known, allowed)
    outside = _outside(saved, fresh.q)
    left = explained(found, standard_errors(saved.learner, fresh.q), fresh.q)
    remarks = [
        *_joints(found, fresh),
        _noise_in_words(known),
        *left,
        *([] if outside is None else [_range_in_words(outside, found)]),
        *_unmoved(fresh),
        *_misread(found, fresh, predict),
    ]
    verdicts = (_of_rmse(found, fresh, known), _of_poses(found, fresh, known))
    return MeasuredJudgement(verdicts, tuple(remarks), _document(found, fresh, known, outside))


def _noise(
    learner: Any,
    fresh: FreshMeasurements,
    errors: Array,
    stated: MeasurementNoise | None,
    predict: Callable[[Array], Array],
) -> RowNoise:
    found = fresh.noise(errors, stated, predict)
    if stated is not None or (found.source and found.freedom >= FEW_REPEATS):
        return found
    return _of_model(learner, fresh.samples.q, predict) or found


def _of_model(learner: Any, q: Array, predict: Callable[[Array], Array]) -> RowNoise | None:
    """The noise that a rigid chain states of its samples."""
    if not isinstance(learner, RigidChain):
        return None
    fit = learner.fit_
    torque, angle = fit.samples.torque_noise, fit.samples.angle_noise
    if not (torque.any() or angle.any()):
        return None
    freedom = np.inf if np.isfinite(fit.p_value) else max(1.0, fit.degrees / fit.samples.n)
    found = _through_slopes(q, predict, torque, angle, "stated by the model of its own samples")
    return RowNoise(found.variance, freedom, found.source)


def _through_slopes(
    q: Array,
    predict: Callable[[Array], Array],
    torque: ArrayLike,
    angle: ArrayLike,
    source: str,
) -> RowNoise:
    """Noise of torques and of angles, the latter through the slopes of predictions."""
    variance = np.array(np.broadcast_to(np.asarray(torque, dtype=float) ** 2, q.shape))
    turned = np.broadcast_to(np.asarray(angle, dtype=float), q.shape[1:])
    for joint in np.flatnonzero(turned):
        step = STEP * np.eye(q.shape[1])[joint]
        slope = (predict(q + step) - predict(q - step)) / (2.0 * STEP)
        variance += (slope * turned[joint]) ** 2
    return RowNoise(variance, np.inf, source)


def _of_rmse(found: FreshErrors, fresh: FreshMeasurements, noise: RowNoise) -> Verdict:
    claim = (
        f"{OBJECT}: RMSE of each joint over {found.poses} poses is at most "
        f"{sizes(found.tolerance)} Nm{_beside(noise)}"
    )
    largest, rmse = float(np.abs(found.errors).max()), float(found.rmse.max())
    status, reason = Status.TESTED, f"by comparison at the poses of {fresh.file.name}"
    hidden = ~found.resolved
    if found.refuted.any():
        status, reason = Status.REFUTED, _refuted(found, fresh, noise)
    elif hidden.any():
        status = Status.UNTESTED
        joints = _listed(found.noticeable, fresh, hidden)
        reason = (
            f"errors of {joints} N m could pass for noise, {RESOLVED:g} times the tolerance are "
            "too many; more poses, more rows in each, or a larger --tolerance"
        )
    elif (fresh.span < ALIKE).all():
        status = Status.UNTESTED
        reason = f"no joint moved by {ALIKE:g} rad: nothing is known of other poses"
    return Verdict(claim, status, largest, rmse=rmse, reason=reason)


def _refuted(found: FreshErrors, fresh: FreshMeasurements, noise: RowNoise) -> str:
    names = _listed(found.rmse, fresh, found.refuted)
    if not noise.source:
        return (
            f"RMSE {names} N m, and noise is not known: all counts as the model's error; poses "
            "repeated in the file tell it, or --torque-noise"
        )
    allowed = _listed(found.allowed, fresh, found.refuted)
    return f"RMSE {names} N m, with noise {allowed} N m would be explained"


def _of_poses(found: FreshErrors, fresh: FreshMeasurements, noise: RowNoise) -> Verdict:
    claim = (
        f"{OBJECT}: none of {found.poses} poses is missed by more than "
        f"{sizes(found.tolerance)} Nm{_beside(noise)}"
    )
    largest = float(np.abs(found.errors).max())
    excess = np.abs(found.errors) - found.allowed_at_poses
    pose, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if not found.missed.any():
        explains = float((found.allowed_at_poses - found.tolerance).max())
        reason = f"noise explains up to {explains:.2g} N m of it" if explains else ""
        return Verdict(claim, Status.TESTED, largest, reason=reason)
    reason = (
        f"{int(found.missed.any(axis=1).sum())} poses are; worst: row {fresh.row(int(pose))}, "
        f"{fresh.joint_names[joint]}, measured less predicted "
        f"{found.errors[pose, joint]:+.3g} N m, {found.allowed_at_poses[pose, joint]:.3g} explained"
    )
    return Verdict(claim, Status.REFUTED, largest, fresh.q[pose], reason=reason)


def _beside(noise: RowNoise) -> str:
    return ", beside noise" if noise.source else ", noise included"


def _listed(values: Array, fresh: FreshMeasurements, joints: NDArray[np.bool_]) -> str:
    named = zip(fresh.joint_names, values, joints, strict=True)
    return ", ".join(f"{value:.3g} ({name})" for name, value, said in named if said)


def _joints(found: FreshErrors, fresh: FreshMeasurements) -> list[str]:
    low, high = found.rmse_limits
    return [
        f"{name}: RMSE {found.rmse[j]:.3g} N m (over all poses drawn alike {low[j]:.3g} to "
        f"{high[j]:.3g}, 95 %), largest {np.abs(found.errors[:, j]).max():.3g}; noise "
        f"{found.noise[j]:.2g}, the model errs by at most {found.unexplained[j]:.3g} N m RMS there "
        f"(95 %); allowed {found.tolerance[j]:.3g}, with noise {found.allowed[j]:.3g}"
        for j, name in enumerate(fresh.joint_names)
    ]


def _noise_in_words(noise: RowNoise) -> str:
    if noise.source:
        return f"noise: {noise.source}"
    return "noise: not known (no pose is repeated, the model states none), counted as error"


def _outside(saved: SavedModel, q: Array) -> NDArray[np.bool_] | None:
    """Which poses lie outside the range of the data of a model; None where it does not know."""
    seen = saved.notes.get("extrapolation")
    if isinstance(seen, dict) and {"seen_from", "seen_to"} <= set(seen):
        low, high = np.asarray(seen["seen_from"]), np.asarray(seen["seen_to"])
    elif hasattr(saved.learner, "seen_range_"):
        low, high = saved.learner.seen_range_
    else:
        return None
    return np.asarray(((q < low - MARGIN) | (q > high + MARGIN)).any(axis=1))


def _range_in_words(outside: NDArray[np.bool_], found: FreshErrors) -> str:
    count, total = int(outside.sum()), len(outside)
    if not count:
        return f"all {total} poses lie within the range of the model's own data"
    there = float(np.sqrt(np.mean(found.errors[outside] ** 2)))
    said = f"poses outside the range of the model's own data: {count} of {total}"
    if count == total:
        return said
    here = float(np.sqrt(np.mean(found.errors[~outside] ** 2)))
    return f"{said}; RMSE {there:.3g} N m there, {here:.3g} N m at the others"


def _unmoved(fresh: FreshMeasurements) -> list[str]:
    still = [name for name, span in zip(fresh.joint_names, fresh.span, strict=True) if span < ALIKE]
    if not still:
        return []
    named = ", ".join(still)
    return [f"moved by less than {ALIKE:g} rad, nothing is said of other angles: {named}"]


def _misread(
    found: FreshErrors, fresh: FreshMeasurements, predict: Callable[[Array], Array]
) -> list[str]:
    if not found.refuted.any():
        return []

    def rmse(sign: float, q: Array) -> float:
        return float(np.sqrt(np.mean((sign * fresh.tau - predict(q)) ** 2)))

    degrees = np.deg2rad(fresh.q)
    words = misread_units(rmse(1.0, fresh.q), rmse(-1.0, fresh.q), rmse(1.0, degrees))
    return [words] if words else []


def _document(
    found: FreshErrors,
    fresh: FreshMeasurements,
    noise: RowNoise,
    outside: NDArray[np.bool_] | None,
) -> dict[str, Any]:
    low, high = found.rmse_limits
    return {
        "file": str(fresh.file),
        "rows": len(fresh.samples.q),
        "poses": found.poses,
        "poses_outside_the_data": None if outside is None else int(outside.sum()),
        "noise_known_by": noise.source or None,
        "joints": [
            {
                "joint": name,
                "rmse": found.rmse[j],
                "rmse_limits": [low[j], high[j]],
                "largest": np.abs(found.errors[:, j]).max(),
                "mean": found.errors[:, j].mean(),
                "noise": found.noise[j],
                "tolerance": found.tolerance[j],
                "allowed": found.allowed[j],
                "unexplained_at_most": found.unexplained[j],
                "noticeable": found.noticeable[j],
            }
            for j, name in enumerate(fresh.joint_names)
        ],
    }
