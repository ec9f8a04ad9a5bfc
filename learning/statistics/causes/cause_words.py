"""Causes beside gravity in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.extension import Kind

OR_FRICTION = (
    ", or friction approached from one side: not to be told apart without approach directions"
)
"""Said wherever constants are named: joints that always stop moving the same way show the same."""
NAMES = {
    Kind.OFFSET: "a constant torque",
    Kind.GAIN: "a gain",
    Kind.SIGN: "a wrong sign (of torque or angle)",
    Kind.SPRING: "a torque that grows with its angle (a spring)",
    Kind.FRICTION: "friction",
    Kind.CABLE: "a torque of twice the angle (a cable, a bent link)",
    Kind.SCALE: "an angle scale",
    Kind.COMPLIANCE: "an angle that gives way with the torque (compliance)",
    Kind.PAYLOAD: "another payload",
}
UNITS = {
    Kind.OFFSET: " N m",
    Kind.SPRING: " N m/rad",
    Kind.FRICTION: " N m",
    Kind.CABLE: " N m",
    Kind.COMPLIANCE: " rad/(N m)",
}


def causes_in_words(causes: Sequence[Cause], names: Sequence[str] = ()) -> str:
    """Name causes with joint, size, standard error, and what cannot be told from them.

    Parameters
    ----------
    causes : sequence of Cause
    names : sequence of str
        Of the joints; by default they are numbered from 1.

    Returns
    -------
    str
        Empty without causes.

    Examples
    --------
    >>> size, error = np.array([0.304]), np.array([0.0031])
    >>> print(causes_in_words([Cause(Kind.OFFSET, 1, size, error, 1e-9, 0.304, ())]))
    a constant torque of +0.304 N m on joint 2 (standard error 0.003), or friction approached from
    one side: not to be told apart without approach directions
    >>> rivals = ((Kind.GAIN, 1), (Kind.GAIN, 0))
    >>> print(causes_in_words([Cause(Kind.GAIN, 1, size, error, 1e-9, 2.0, rivals)]))
    a gain of 0.304 on joint 2 (standard error 0.003); not to be told apart from it with these
    poses: a gain on joint 1
    """
    return "; ".join(_in_words(cause, names) for cause in causes)


def _in_words(cause: Cause, names: Sequence[str]) -> str:
    place = _place(cause.joint, cause.kind, names)
    if cause.since is not None:
        place = f" from sample {cause.since + 1} on"
    said = f"{NAMES[cause.kind]}{_size(cause)}{place}{_error(cause)}"
    if cause.kind is Kind.OFFSET:
        said += OR_FRICTION
    others = [f"{NAMES[k]}{_place(joint, k, names)}" for k, joint in cause.rivals[1:]]
    others = [other for i, other in enumerate(others) if other not in others[:i]]
    if others:
        said += f"; not to be told apart from it with these poses: {', '.join(others)}"
    return said


def _place(joint: int | None, kind: Kind, names: Sequence[str]) -> str:
    if kind is Kind.PAYLOAD:
        return " in a part of the samples"
    if joint is None:
        return " on every joint"
    return f" on {names[joint]}" if names else f" on joint {joint + 1}"


def _size(cause: Cause) -> str:
    """Size of a cause of one number; of a spring its rate, of a cable its amplitude."""
    if cause.kind in (Kind.SIGN, Kind.PAYLOAD) or cause.joint is None:
        return ""
    if cause.kind is Kind.GAIN:
        return f" of {cause.size[-1]:.3g}"
    if cause.kind is Kind.CABLE:
        return f" of {np.linalg.norm(cause.size):.3g}{UNITS[cause.kind]}"
    return f" of {cause.size[-1]:+.3g}{UNITS.get(cause.kind, '')}"


def _error(cause: Cause) -> str:
    if cause.kind in (Kind.SIGN, Kind.PAYLOAD) or cause.joint is None:
        return f" ({cause.effect:.2g} N m RMS)"
    return f" (standard error {cause.standard_error[-1]:.1g})"
