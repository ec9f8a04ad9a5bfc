"""Relations that no configuration within the joint limits can follow."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linprog

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import TURN, finite_limits
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

SLACK = 1e-9
"""Configurations this little beyond a limit are at it [rad]."""


def is_executable(relation: SymmetryRelation, limits: ArrayLike) -> bool:
    """Say whether some configuration within the limits has its image within the limits.

    Parameters
    ----------
    relation : SymmetryRelation
    limits : (n, 2) array_like
        Lower and upper limit of each joint [rad]; infinite where it has none.

    Returns
    -------
    bool
        If False the relation still labels samples (the torque of the image is known), but the arm
        cannot go there. Angles are compared as the joints turn, full turns apart counting as the
        same.

    Raises
    ------
    InputError
        If the limits have the wrong shape or are out of order.

    Notes
    -----
    One linear feasibility problem for each vector of full turns that the ranges of A q + d leave
    possible. A joint that can make a full turn reaches every angle: its image restrains nothing.

    Examples
    --------
    >>> half_turn = SymmetryRelation([[1.0]], [np.pi], [-1.0])
    >>> is_executable(half_turn, [[-3.2, 3.2]]), is_executable(half_turn, [[-1.0, 1.0]])
    (True, False)
    """
    box = np.asarray(limits, dtype=float)
    if box.shape != (relation.n, 2):
        raise InputError("executable", "shape of limits", box.shape, f"({relation.n}, 2)")
    if not (box[:, 0] <= box[:, 1]).all():
        raise InputError("executable", "limits", box.tolist(), "lower <= upper [rad]")
    narrow = box[:, 1] - box[:, 0] < TURN - SLACK
    box = finite_limits(box)
    A, d, (low, high) = relation.A[narrow], relation.d[narrow], box[narrow].T
    reach = np.sort(np.stack([A * box[:, 0], A * box[:, 1]]), axis=0).sum(axis=2) + d
    first = np.ceil((low - reach[1] - SLACK) / TURN).astype(int)
    last = np.floor((high - reach[0] + SLACK) / TURN).astype(int)
    for turns in itertools.product(*map(range, first, last + 1)):
        shift = d + TURN * np.array(turns)
        found = linprog(
            np.zeros(relation.n),
            A_ub=np.concatenate([A, -A]),
            b_ub=np.concatenate([high - shift, shift - low]) + SLACK,
            bounds=box,
        )
        if found.status == 0:
            return True
    return False
