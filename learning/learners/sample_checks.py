"""Checks that every learner makes of its samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.utils.validation import check_is_fitted, validate_data

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


def checked_configurations(learner: Any, X: Any, *, first: bool) -> Array:
    """Configurations (m, n) [rad] as a contiguous array of finite floats.

    Parameters
    ----------
    learner : estimator
        Remembers the number of joints (``n_features_in_``) when ``first``, compares otherwise.
    X : array_like
        Configurations.
    first : bool
        Whether the learner has seen nothing yet.

    Raises
    ------
    InputError
        If an angle is NaN or infinite.
    ValueError
        If the shape does not fit (scikit-learn's own message).
    """
    ready = (
        not first
        and type(X) is np.ndarray
        and X.ndim == 2
        and X.dtype == np.float64
        and X.shape[1] == learner.n_features_in_
        and len(X) > 0
    )
    if not ready:
        X = validate_data(
            learner, X, reset=first, dtype=np.float64, ensure_all_finite=False, ensure_min_samples=1
        )
    _refuse_non_finite("X", "joint angle [rad]", X)
    return np.ascontiguousarray(X)


def checked_directions(directions: Any, shape: tuple[int, ...]) -> Array | None:
    """Signs (m, n) of the last motion of every joint before the arm came to rest; None if unknown.

    Raises
    ------
    InputError
        If there is not one finite number for every angle.
    """
    if directions is None:
        return None
    sides = np.sign(np.asarray(directions, dtype=float))
    if sides.shape != shape or not np.isfinite(sides).all():
        accepted = f"a sign for every angle, shape {shape}"
        raise InputError("samples", "directions", f"shape {sides.shape}", accepted)
    return sides


def checked_samples(
    learner: Any, X: Any, y: Any, sample_weight: Any = None, *, first: bool
) -> tuple[Array, Array, Array]:
    """Configurations (m, n), torques (m, k) and weights (m,) of samples to be learned.

    Torques given as (m,) become (m, 1). A weight may be zero; it must not be negative.

    Raises
    ------
    InputError
        If a value is NaN or infinite, a weight is negative, or numbers of samples differ.
    ValueError
        If the shape of ``X`` does not fit.
    """
    if y is None:
        raise ValueError("requires y to be passed, but the target y is None")
    X = checked_configurations(learner, X, first=first)
    torque = np.asarray(y, dtype=float)
    if torque.ndim == 1:
        torque = torque[:, None]
    if torque.ndim != 2 or len(torque) != len(X):
        accepted = f"one row for each of the {len(X)} samples"
        raise InputError("y", "shape", np.asarray(y).shape, accepted)
    known = getattr(learner, "n_outputs_", None)
    if not first and known is not None and torque.shape[1] != known:
        raise InputError("y", "number of columns", torque.shape[1], f"{known}, as before")
    _refuse_non_finite("y", "torque [N m]", torque)
    if sample_weight is None:
        weights = np.ones(len(X))
    else:
        given = np.broadcast_to(np.asarray(sample_weight, dtype=float), (len(X),))
        weights = given.copy()  # writable, as ones are: functions are compiled for each kind
        _refuse_non_finite("sample_weight", "weight", weights)
        if weights.min() < 0:
            raise InputError("sample_weight", "weight", weights.min(), "numbers >= 0")
    return X, np.ascontiguousarray(torque), weights


def some_weight(sample_weight: Any) -> None:
    """Refuse weights that are all zero: there would be nothing to fit to."""
    if sample_weight is not None and not np.any(np.asarray(sample_weight, dtype=float)):
        raise InputError("sample_weight", "every weight", "zero", "at least one number > 0")


def require_fitted(learner: Any) -> None:
    """Raise scikit-learn's NotFittedError if nothing has been learned yet."""
    if not hasattr(learner, "n_outputs_"):
        check_is_fitted(learner, "n_outputs_")


def require(learner: Any, name: str, holds: bool, accepted: str) -> None:
    """Refuse the setting ``name`` of a learner unless ``holds``."""
    if not holds:
        raise InputError(type(learner).__name__, name, getattr(learner, name), accepted)


def _refuse_non_finite(where: str, field: str, values: Array) -> None:
    if not np.isfinite(values).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
        # scikit-learn's checks look for the words NaN and infinity.
        shown = "NaN" if np.isnan(values[at]) else "infinity (inf)"
        raise InputError(where, f"{field} at {at}", shown, "finite numbers")
