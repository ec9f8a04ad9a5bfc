"""Joint limits, infinite where a joint has none, and the angles to draw from in their place."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

TURN = 2.0 * np.pi
NO_LIMIT = 1e6
"""Limits beyond [rad] mean that there is none: 1e16, the largest double."""
UNLIMITED = 1e16
"""Written where a format must have a number [rad]."""


def read_limits(lower: float | None, upper: float | None) -> tuple[float, float]:
    """Return the limits [rad] that a robot file means, infinite where there is none.

    Notes
    -----
    Missing are: None, numbers beyond 1e6, and both zero, which is what URDF makes of limits that
    are left out and what exporters of drawing programs write for "not set".

    Examples
    --------
    >>> read_limits(-1.0, None), read_limits(-1e16, 1e16), read_limits(0.0, 0.0)
    ((-1.0, inf), (-inf, inf), (-inf, inf))
    """
    if lower == upper == 0:
        lower = upper = None
    return (
        -math.inf if lower is None or lower < -NO_LIMIT else float(lower),
        math.inf if upper is None or upper > NO_LIMIT else float(upper),
    )


def finite_limits(limits: ArrayLike) -> Array:
    """Return limits (n, 2) [rad] with one full turn where an end is missing.

    Angles a full turn apart are one configuration, so nothing that a joint can reach is lost. A
    joint without any limit gets -pi and pi.

    Examples
    --------
    >>> finite_limits([[-1.0, 7.0], [-np.inf, np.inf], [0.0, np.inf]]).round(3).tolist()
    [[-1.0, 7.0], [-3.142, 3.142], [0.0, 6.283]]
    """
    low, high = np.asarray(limits, dtype=float).reshape(-1, 2).T
    low = np.where(np.isfinite(low), low, np.where(np.isfinite(high), high - TURN, -np.pi))
    return np.stack([low, np.where(np.isfinite(high), high, low + TURN)], axis=1)


def one_turn(limits: ArrayLike) -> Array:
    """Return the part of limits (n, 2) [rad] to draw configurations from: a turn at most.

    Of a wider range the turn nearest to -pi to pi is taken.

    Examples
    --------
    >>> one_turn([[-1.0, 1.0], [-7.0, 7.0], [-1.0, np.inf]]).round(3).tolist()
    [[-1.0, 1.0], [-3.142, 3.142], [-1.0, 5.283]]
    """
    low, high = np.asarray(limits, dtype=float).reshape(-1, 2).T
    wide = high - low > TURN
    middle = np.clip(0.0, np.where(wide, low + np.pi, 0.0), np.where(wide, high - np.pi, 0.0))
    return np.stack(
        [np.where(wide, middle - np.pi, low), np.where(wide, middle + np.pi, high)], axis=1
    )


def check_limits(
    limits: NDArray[np.float64], joint_names: Sequence[str], where: str, use: str
) -> None:
    """Refuse joint limits that leave no room, where they are needed.

    Parameters
    ----------
    limits
        Lower and upper limits (n, 2) [rad].
    joint_names
        One name per joint.
    where
        What to call the arm in an error.
    use
        What they are needed for.

    Raises
    ------
    InputError
        Naming every joint whose lower limit is not below its upper one.

    Examples
    --------
    >>> check_limits(np.array([[-1.0, 1.0], [2.0, 2.0]]), ("a", "b"), "arm.urdf", "to move")
    Traceback (most recent call last):
    isotorque.InputError: arm.urdf: limits of joint 'b' [2.0, 2.0] rad, needed to move, ...
    """
    wrong = [
        f"'{name}' [{lower!r}, {upper!r}]"
        for name, (lower, upper) in zip(joint_names, limits.tolist(), strict=True)
        if not lower < upper
    ]
    if wrong:
        raise InputError(
            where,
            f"limits of joint {', '.join(wrong)} rad, needed {use},",
            "without room",
            "lower < upper, or --lock of the joint",
        )
