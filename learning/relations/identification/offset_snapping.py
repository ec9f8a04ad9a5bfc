"""Offsets that agree with a multiple of a right angle, written as that multiple."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup

Array = NDArray[np.float64]

RIGHT_ANGLE = np.pi / 2
AGREES = 3.5
"""Standard errors that an offset may be off."""
SHARP = np.deg2rad(1.0)
"""Offsets with a larger standard error [rad] say too little: one in ten would agree by chance."""


def snapped_offsets(group: CandidateGroup, errors: Array) -> CandidateGroup | None:
    """Round all offsets of a group to multiples of a right angle, if the data agree.

    Parameters
    ----------
    group : CandidateGroup
        Offsets composing exactly.
    errors : (G, r) array
        Standard errors of the offsets [rad].

    Returns
    -------
    CandidateGroup or None
        None if an offset disagrees or is too uncertain, or if the rounded ones do not compose.

    Notes
    -----
    An arm whose links are built at right angles has such offsets, a centre of mass off the link's
    axis makes others. Rounding is a guess from how machines are built, worth making because an
    error of the offset dominates the torque error of a relation; whoever uses it must say so.

    Examples
    --------
    >>> mirror = CandidateGroup(np.eye(1, dtype=np.int64), np.array([[[1.0]], [[-1.0]]]),
    ...                         np.array([[0.0], [3.14]]), np.ones((2, 1)))
    >>> snapped_offsets(mirror, np.array([[0.0], [0.002]])).d.ravel().round(6).tolist()
    [0.0, 3.141593]
    >>> snapped_offsets(mirror, np.array([[0.0], [0.0001]])) is None
    True
    """
    target = wrap(np.round(group.d / RIGHT_ANGLE) * RIGHT_ANGLE)
    if (errors > SHARP).any() or (np.abs(wrap(group.d - target)) > AGREES * errors + 1e-9).any():
        return None
    rounded = CandidateGroup(group.basis, group.A, target, group.Y)
    table, defects = rounded.products()
    if (table < 0).any() or np.abs(defects).max(initial=0.0) > 1e-9:
        return None
    return rounded
