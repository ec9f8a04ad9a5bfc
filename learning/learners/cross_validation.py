"""Errors on samples that a model has not seen, and samples that do not fit the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.statistics.poses import Poses, group_poses
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAVE_ONE_OUT, FOLDS = 20, 5
"""Up to so many poses each is a part of its own; more are dealt into so many parts. A model of 6
poses is worse than one of 8 by far, and what it errs by says little of the other."""
ROUNDS = 3
"""Most rounds of looking for outliers."""
SUSPECT, STRICT = (2.0, 3.0), (4.0, 9.0)
"""From where on a sample is suspected, and is an outlier: in upper spreads of log |error| above the
median, and in medians of |error|; both are needed."""
LEAST_SHARE = 0.01
"""Errors below this share of a joint's torques (their 95 % quantile) never stand out."""
_TINY = 1e-300


@dataclass(frozen=True, eq=False)
class CrossValidation:
    """Errors of predictions by models that have not seen the samples.

    Attributes
    ----------
    errors : (m, n) array
        Predicted less measured torques [N m].
    outliers : (m,) bool array
        Samples that stand out; no model was trained on them.
    folds : int
        Number of parts, each predicted by a model trained on the others.
    poses : Poses
        How the samples are grouped: those of one pose share a part, and a pose counts once.
    """

    errors: Array
    outliers: Flags
    folds: int
    poses: Poses

    @property
    def rmse(self) -> float:
        """Root mean square error, every pose counted once [N m]."""
        return float(np.sqrt(np.mean(self.poses.means(self.errors**2))))

    @property
    def rmse_by_joint(self) -> Array:
        """The same joint by joint, (n,) [N m]."""
        return np.asarray(np.sqrt(np.mean(self.poses.means(self.errors**2), axis=0)))

    @property
    def rmse_of_others(self) -> float:
        """The same without the samples that stand out [N m]; NaN where all do."""
        others = self.poses.taken(~self.outliers)
        if not others.count:
            return float("nan")
        return float(np.sqrt(np.mean(others.means(self.errors[~self.outliers] ** 2))))

    def worst(self, count: int) -> NDArray[np.int64]:
        """Numbers of the outliers that are farthest off, the worst first."""
        size = np.abs(self.errors).max(axis=1)
        return np.array([i for i in np.argsort(-size) if self.outliers[i]][:count], dtype=np.int64)


def cross_validate(
    make: Callable[[], Any],
    q: ArrayLike,
    torque: ArrayLike,
    rng: np.random.Generator,
    *,
    folds: int | None = None,
    poses: Poses | None = None,
) -> CrossValidation:
    """Cross-validate a learner, and find samples that do not fit the others.

    Parameters
    ----------
    make
        Returns a fresh learner (``fit``, ``predict``).
    q, torque : (m, n) arrays
        Samples [rad], [N m]; at least two poses.
    rng
        Deals the poses into parts.
    folds
        Number of parts, at most one per pose; by default every pose is left out by itself, or
        where they are more than ``LEAVE_ONE_OUT``, ``FOLDS`` parts in turn.
    poses
        Which samples were recorded in one pose; `group_poses` tells where it is not given.

    Returns
    -------
    CrossValidation

    Raises
    ------
    InputError
        If all samples are of one pose: nothing can be held out.

    Notes
    -----
    Samples of one pose are in one part, or the model would be asked for what it has seen. They
    also count once, in the error and in what is usual among the errors. That error is the one to
    expect at further poses like these, of a model of as many poses as are left in; nothing is said
    of poses that no pose is near.

    A sample stands out if the error of one of its torques is ``STRICT``: 9 times the median of that
    joint's errors, which for normal errors is 6 standard deviations, and 4 spreads above it on a
    logarithmic scale, where the spread is that of the upper quartile over the median; this allows
    for learners that are much better among their samples than at the edge. Besides, it must be
    above ``LEAST_SHARE`` of that joint's torques. As an outlier spoils the models that learn it,
    whatever is suspected (``SUSPECT``: 3 times the median, 2 spreads) is left out of training
    first; what then stands out is an outlier, the rest comes back. All this is done again without
    the outliers, which may have hidden others.

    Examples
    --------
    >>> from sklearn.linear_model import LinearRegression
    >>> q = np.linspace(-1.0, 1.0, 30)[:, None]
    >>> torque = 3.0 * q + 0.01 * np.random.default_rng(1).normal(size=q.shape)
    >>> torque[7] += 5.0
    >>> found = cross_validate(LinearRegression, q, torque, np.random.default_rng(0))
    >>> np.flatnonzero(found.outliers).tolist(), round(found.rmse_of_others, 2)
    ([7], 0.01)
    """
    samples, torques = np.asarray(q, dtype=float), np.asarray(torque, dtype=float)
    poses = group_poses(samples) if poses is None else poses
    if poses.count < 2:
        raise InputError("held out", "number of poses", poses.count, "at least 2")
    if folds is None:
        folds = poses.count if poses.count <= LEAVE_ONE_OUT else FOLDS
    folds = min(folds, poses.count)
    part = (rng.permutation(poses.count) % folds)[poses.label]
    outliers = np.zeros(len(samples), dtype=bool)
    errors = _errors(make, samples, torques, part, outliers)
    for _ in range(ROUNDS):
        suspects = outliers | _stand_out(errors, torques, poses, SUSPECT)
        if np.array_equal(suspects, outliers) or not _enough(~suspects, part):
            break
        fair = _errors(make, samples, torques, part, suspects)
        found = _stand_out(fair, torques, poses, STRICT)
        if np.array_equal(found, outliers):
            break
        outliers = found
        errors = _errors(make, samples, torques, part, outliers)
    return CrossValidation(errors, outliers, folds, poses)


def _enough(used: Flags, part: NDArray[np.int64]) -> bool:
    """Whether each part leaves something to train on."""
    return all(np.any(used & (part != k)) for k in range(int(part.max()) + 1))


def _errors(
    make: Callable[[], Any], q: Array, torque: Array, part: NDArray[np.int64], left_out: Flags
) -> Array:
    errors = np.empty_like(torque)
    for k in range(int(part.max()) + 1):
        asked, known = part == k, (part != k) & ~left_out
        errors[asked] = make().fit(q[known], torque[known]).predict(q[asked]) - torque[asked]
    return errors


def _stand_out(errors: Array, torque: Array, poses: Poses, least: tuple[float, float]) -> Flags:
    usual = np.sqrt(poses.means(errors**2)) if poses.repeated else np.abs(errors)
    logs = np.log(np.maximum(usual, _TINY))
    middle, upper = np.quantile(logs, [0.5, 0.75], axis=0)
    far = np.maximum(least[0] * (upper - middle), np.log(least[1]))
    bound = np.exp(np.minimum(middle + far, 700.0))
    small = LEAST_SHARE * np.quantile(np.abs(torque), 0.95, axis=0)
    return np.asarray((np.abs(errors) > np.maximum(bound, small)).any(axis=1))
