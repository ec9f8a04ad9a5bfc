"""Errors of predictions at fresh poses: how large, what noise explains, what would have shown.

Torques that were measured after a model was made err by their own noise too. So the model is not
asked to be nearer to them than its tolerance and the noise together, and where the noise hides
errors far larger than the tolerance, nothing was tested.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special, stats

from isotorque.learning.statistics.poses import Poses

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST_POSES = 5
"""From fewer poses the errors at others could be three times as large (chi-square, 95 %)."""
CHANCE = 1e-3
"""Chance with which any joint or pose of a model within its tolerance is said to be wrong."""
MISSED = 0.01
"""Chance with which an error that counts as noticeable is not noticed."""
RESOLVED = 3.0
"""Tested: errors of so many times the tolerance would have been noticed."""
CONFIDENCE = 0.95
"""Of the limits of errors."""
LARGE = 1e6
"""Errors of so many variances of noise, summed over the poses, are far beyond it."""


@dataclass(frozen=True, eq=False)
class RowNoise:
    """Noise of measured torques.

    Attributes
    ----------
    variance : (N, n) array
        Of every row and joint [N^2 m^2].
    freedom : float
        Degrees of freedom it is known with; infinite where it was stated.
    source : str
        How it is known, in words; empty where it is not, and counts as zero.
    """

    variance: Array
    freedom: float
    source: str


def scatter_within_poses(errors: Array, poses: Poses) -> RowNoise | None:
    """The noise of rows (N, n) by the scatter within repeated poses; None where none repeats."""
    deviation, freedom = poses.spread(errors)
    if not freedom:
        return None
    said = f"scatter of the rows within poses, {freedom} degrees of freedom"
    variance = np.array(np.broadcast_to(deviation**2, errors.shape))
    return RowNoise(variance, float(freedom), said)


def unknown_noise(errors: Array) -> RowNoise:
    """No noise: all of the errors (N, n) counts as the model's."""
    return RowNoise(np.zeros(errors.shape), np.inf, "")


@dataclass(frozen=True, eq=False)
class FreshErrors:
    """Errors of predictions at fresh poses, and what they may be by noise.

    Attributes
    ----------
    errors, deviation : (P, n) arrays
        Mean error of every pose (measured less predicted), and its standard deviation by noise
        [N m].
    freedom : float
        Degrees of freedom that the noise is known with.
    tolerance : (n,) array
        Error of the model that is allowed, RMSE and largest [N m].
    allowed : (n,) array
        RMSE that noise and an error of the tolerance explain [N m].
    noticeable : (n,) array
        RMS error that would have been noticed in all but 1 % of such data [N m].
    allowed_at_poses : (P, n) array
        Largest error of each pose likewise [N m].
    """

    errors: Array
    deviation: Array
    freedom: float
    tolerance: Array
    allowed: Array
    noticeable: Array
    allowed_at_poses: Array

    @property
    def poses(self) -> int:
        """Number of poses."""
        return len(self.errors)

    @property
    def rmse(self) -> Array:
        """Root mean square error of each joint over the poses, noise included [N m]."""
        return np.asarray(np.sqrt(np.mean(self.errors**2, axis=0)))

    @property
    def rmse_limits(self) -> tuple[Array, Array]:
        """Limits of the RMSE over all poses drawn alike, 95 %, for normal errors [N m]."""
        tail = (1.0 - CONFIDENCE) / 2.0
        high, low = stats.chi2.ppf([tail, 1.0 - tail], self.poses)
        return self.rmse * np.sqrt(self.poses / low), self.rmse * np.sqrt(self.poses / high)

    @property
    def noise(self) -> Array:
        """Root mean square of what noise adds to the mean of a pose [N m]."""
        return np.asarray(np.sqrt(np.mean(self.deviation**2, axis=0)))

    @property
    def unexplained(self) -> Array:
        """RMS error that is left at most when noise is taken off, 95 % [N m]."""
        found = np.empty(self.errors.shape[1])
        for j, total in enumerate(np.sum(self.errors**2, axis=0)):
            scale, degrees = _alike(self.deviation[:, j])
            scale *= _narrower(self.freedom)
            found[j] = _size(float(total), scale, degrees, 1.0 - CONFIDENCE, self.poses)
        return found

    @property
    def refuted(self) -> Flags:
        """Joints whose RMSE an error of the tolerance and noise do not explain, (n,)."""
        return np.asarray(self.rmse > self.allowed)

    @property
    def resolved(self) -> Flags:
        """Joints at which errors of three times the tolerance would have been noticed, (n,)."""
        return np.asarray(self.noticeable <= RESOLVED * self.tolerance)

    @property
    def missed(self) -> Flags:
        """Poses and joints that are further off than tolerance and noise explain, (P, n)."""
        return np.asarray(np.abs(self.errors) > self.allowed_at_poses)

    def within(self, tolerance: Array) -> Flags:
        """Joints whose RMSE noise and an error of another tolerance (n,) explain."""
        return ~fresh_errors(self.errors, self.deviation, self.freedom, tolerance).refuted


def errors_by_pose(
    errors: Array, poses: Poses, noise: RowNoise, tolerance: Array, *, chance: float = CHANCE
) -> FreshErrors:
    """Judge errors of rows: those of one pose count as one, their mean.

    Parameters
    ----------
    errors : (N, n) array
        Measured less predicted torques [N m].
    poses : Poses
        The rows' poses.
    noise : RowNoise
        Of the rows.
    tolerance : (n,) array
        Error that is allowed [N m].
    chance
        See `fresh_errors`.

    Examples
    --------
    >>> from isotorque.learning.statistics.poses import group_poses
    >>> rng = np.random.default_rng(0)
    >>> poses = group_poses(np.repeat(rng.uniform(-3.0, 3.0, (20, 1)), 5, axis=0))
    >>> errors = 0.1 * rng.normal(size=(100, 1))
    >>> noise = scatter_within_poses(errors, poses)
    >>> good = errors_by_pose(errors, poses, noise, np.array([0.05]))
    >>> wrong = errors_by_pose(errors + 0.3, poses, noise, np.array([0.05]))
    >>> [bool(x) for x in (good.refuted[0], good.resolved[0], wrong.refuted[0])]
    [False, True, True]
    """
    variance = poses.means(noise.variance) / poses.rows[:, None]
    return fresh_errors(
        poses.means(errors), np.sqrt(variance), noise.freedom, tolerance, chance=chance
    )


def fresh_errors(
    errors: Array,
    deviation: Array,
    freedom: float,
    tolerance: Array,
    *,
    chance: float = CHANCE,
) -> FreshErrors:
    """Judge errors of poses.

    Parameters
    ----------
    errors, deviation : (P, n) arrays
        Measured less predicted torques, and their standard deviations by noise [N m].
    freedom
        Degrees of freedom of these; infinite where they are stated.
    tolerance : (n,) array
        Error that is allowed [N m].
    chance
        With which a model within its tolerance is refuted, over all joints and poses.

    Notes
    -----
    With errors e of the model the sum of squares over the poses is noncentral chi-square
    distributed, noncentrality ``sum e^2 / s^2``: its quantile for a model that errs by the
    tolerance is what is allowed. Poses of unequal noise count as fewer of equal noise
    (Satterthwaite). Where the noise was estimated it is taken larger, by the factor with which F
    and chi-square quantiles agree where no error is allowed; for large errors, where Student's
    factor would do, that is more than enough. Single poses: a normal or Student's quantile beside
    the tolerance. Half of the chance is spent on each, joints and poses by Bonferroni.

    References
    ----------
    N. L. Johnson, S. Kotz, N. Balakrishnan, "Continuous Univariate Distributions", volume 2, 2nd
    ed., Wiley 1995, chapter 29.
    """
    count, n = errors.shape
    by_joint = chance / (2.0 * n)
    allowed, noticeable = np.zeros(n), np.zeros(n)
    for j in range(n):
        scale, degrees = _alike(deviation[:, j])
        square = count * float(tolerance[j]) ** 2
        wider = scale * _wider(degrees, freedom, by_joint)
        if square >= LARGE * wider:  # noise adds at most its own size
            most = (square**0.5 + float(wider * special.chdtri(degrees, by_joint)) ** 0.5) ** 2
        else:
            most = wider * float(special.chndtrix(1.0 - by_joint, degrees, square / wider))
        allowed[j] = np.sqrt(most / count)
        noticeable[j] = _size(most, scale * _narrower(freedom), degrees, MISSED / 2.0, count)
    single = by_joint / (2.0 * count)
    quantile = stats.norm.isf(single) if np.isinf(freedom) else stats.t.isf(single, freedom)
    return FreshErrors(
        errors, deviation, freedom, tolerance, allowed, noticeable, tolerance + quantile * deviation
    )


def _alike(deviation: Array) -> tuple[float, float]:
    """Variance and number of poses of equal noise that stand for those of unequal noise."""
    variance = deviation**2
    total, square = float(variance.sum()), float((variance**2).sum())
    if not square:
        return 0.0, float(len(variance))
    return square / total, total**2 / square


def _wider(degrees: float, freedom: float, chance: float) -> float:
    """Factor on an estimated variance: quantile of F over that of chi-square."""
    if np.isinf(freedom):
        return 1.0
    ratio = special.fdtri(degrees, freedom, 1.0 - chance) / special.chdtri(degrees, chance)
    return float(degrees * ratio)


def _narrower(freedom: float) -> float:
    """Factor on an estimated variance that is as small as it may be: noise adds to what shows."""
    if np.isinf(freedom):
        return 1.0
    return float(freedom / special.chdtri(freedom, MISSED / 2.0))


def _size(square: float, scale: float, degrees: float, chance: float, count: int) -> float:
    """RMS error with which a sum of squares as small as this has a chance."""
    if square >= LARGE * scale:  # noise along the errors is what counts
        return float((square**0.5 + scale**0.5 * special.ndtri(1.0 - chance)) / count**0.5)
    found = square / scale
    if float(special.chdtr(degrees, found)) <= chance:
        return 0.0
    return float((special.chndtrinc(found, degrees, chance) * scale / count) ** 0.5)
