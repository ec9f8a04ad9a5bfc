"""Coefficient of determination of learned torques, which joints without gravity do not spoil."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import RegressorMixin

STILL = 0.01
"""A joint whose torque varies less than this share of the one that varies most does not vary: its
own variance is rounding or noise, and no measure of an error."""
ROUNDING = 1e-12
"""Relative error of torques that are right."""


def torque_score(
    measured: ArrayLike, predicted: ArrayLike, weight: ArrayLike | None = None
) -> float:
    """Score predicted torques: 1 where all are right, 0 for the mean torque at every joint.

    Parameters
    ----------
    measured, predicted : (m, n) or (m,) arrays
        Torques [N m].
    weight : (m,) array, optional
        Of the samples.

    Returns
    -------
    float
        1 less the summed squared errors of all joints, each over its torque's sum of squares about
        the mean, averaged over the joints that vary (by more than ``STILL`` of the one that varies
        most). A joint that does not vary is left out of the average, and its errors are measured by
        the mean sum of squares of those that do: right there adds nothing, wrong there costs.
        Where no torque varies it is 1 or 0: right or wrong.

    Notes
    -----
    scikit-learn's ``r2_score`` gives a joint that gravity does not load 0 as soon as one prediction
    is off by rounding, a third of the score of a perfect model of three joints.

    Examples
    --------
    >>> true = np.array([[0.0, 1.0], [0.0, -1.0]])
    >>> torque_score(true, true + 1e-15), torque_score(true, true + [2.0, 0.0])
    (1.0, -3.0)
    """
    y = np.asarray(measured, dtype=float).reshape(len(np.asarray(measured)), -1)
    error = np.asarray(predicted, dtype=float).reshape(y.shape) - y
    w = np.ones(len(y)) if weight is None else np.asarray(weight, dtype=float)
    w = w / w.sum()
    variance = w @ (y - w @ y) ** 2
    varies = np.sqrt(variance) > STILL * np.sqrt(variance.max())
    if not varies.any():
        return float(np.abs(error).max() <= ROUNDING * np.abs(y).max())
    scale = np.where(varies, variance, variance[varies].mean())
    return float(1.0 - np.sum((w @ error**2) / scale) / np.sum(varies))


class TorqueRegressor(RegressorMixin):
    """Mixin of regressors that predict torques: ``score`` is `torque_score`."""

    def score(self, X: Any, y: Any, sample_weight: Any = None) -> float:
        """Return `torque_score` of the predictions at configurations (m, n) [rad]."""
        return torque_score(y, self.predict(X), sample_weight)
