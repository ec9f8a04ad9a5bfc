"""Checks of what is given to a simulated arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


def vector(where: str, field: str, values: ArrayLike, n: int, unit: str) -> Array:
    """Return n finite numbers as an array of their own.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> vector("2r", "torque", [1.0, float("nan")], 2, " [N m]")
    Traceback (most recent call last):
    isotorque.InputError: 2r: torque is [1.0, nan]; accepted: 2 finite numbers [N m]
    """
    accepted = f"{n} finite numbers{unit}"
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(where, field, values, accepted) from None
    if array.shape != (n,):
        shown = f"of length {len(array)}" if array.ndim == 1 else f"of shape {array.shape}"
        raise InputError(where, field, shown, accepted)
    if not np.isfinite(array).all():
        raise InputError(where, field, array.tolist(), accepted)
    return array


def not_negative(where: str, field: str, values: ArrayLike, n: int, unit: str) -> Array:
    """Return n finite numbers, none negative, as an array; one number stands for n.

    Raises
    ------
    InputError
        For anything else.
    """
    array = vector(where, field, np.full(n, values) if np.ndim(values) == 0 else values, n, unit)
    if (array < 0.0).any():
        raise InputError(where, field, array.tolist(), f"{n} numbers >= 0{unit}")
    return array


def positive(where: str, field: str, value: float, unit: str) -> float:
    """Return a finite number greater than zero.

    Raises
    ------
    InputError
        For anything else.
    """
    if not (isinstance(value, int | float | np.number) and 0.0 < value < np.inf):
        raise InputError(where, field, value, f"a finite number > 0{unit}")
    return float(value)


def table(where: str, field: str, values: ArrayLike, n: int, unit: str) -> Array:
    """Return a table of finite numbers with n columns and at least one row as its own array.

    Raises
    ------
    InputError
        For anything else.
    """
    accepted = f"one or more rows of {n} finite numbers{unit}"
    try:
        array = np.array(values, dtype=float, order="C")
    except (TypeError, ValueError):
        raise InputError(where, field, values, accepted) from None
    if array.ndim != 2 or array.shape[1] != n or len(array) == 0:
        raise InputError(where, field, f"of shape {array.shape}", accepted)
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise InputError(where, f"row {row} of {field}", array[row].tolist(), accepted)
    return array


def within(
    where: str, field: str, q: ArrayLike, limits: Array, joint_names: tuple[str, ...]
) -> Array:
    """Return joint angles [rad] that lie within the joint limits (n, 2).

    Raises
    ------
    InputError
        For anything else, naming the joint.
    """
    angles = vector(where, field, q, len(joint_names), " [rad]")
    outside = np.flatnonzero((angles < limits[:, 0]) | (angles > limits[:, 1]))
    if len(outside):
        j = outside[0]
        raise InputError(
            where,
            f"{field} of joint '{joint_names[j]}'",
            angles[j],
            f"an angle within its limits {limits[j].tolist()} [rad]",
        )
    return angles
