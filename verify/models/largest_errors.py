"""Largest torque of each joint over configurations: errors of a model, or torques themselves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.optimize
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.verify.models.target_sets import dense_targets

Array = NDArray[np.float64]

SAMPLES = 512
"""Random configurations that a search begins with."""
CLIMBS = 2
"""Best configurations of each joint that are climbed from (L-BFGS-B)."""
SHARE, LEAST_SHARE = 0.01, 1e-3
"""Tolerated error by default: share of a joint's own largest torque, and at least this share of the
arm's: what a wrist's motor notices, and what matters beside the shoulder's."""


def largest_by_joint(
    torque: Callable[[Array], Array],
    limits: ArrayLike,
    *,
    starts: ArrayLike,
    within: Callable[[Array], NDArray[np.bool_]] | None = None,
) -> tuple[Array, Array]:
    """Search for the largest absolute value of every component of a torque.

    Parameters
    ----------
    torque
        Configurations (m, n) [rad] to torques or torque errors (m, n) [N m].
    limits
        Search between these angles, (n, 2) [rad].
    starts
        Configurations (k, n) [rad] to begin with beside random ones; at least one within.
    within
        Search only where this holds, (m, n) to (m,) booleans; everywhere by default.

    Returns
    -------
    largest : (n,) array
        Largest value found of each joint [N m]: lower bounds of the suprema.
    q : (n, n) array
        Where each was found, one configuration per joint [rad].

    Examples
    --------
    >>> box = np.array([[-np.pi, np.pi]] * 2)
    >>> waves = lambda q: np.sin(q) * [1.0, -2.0]
    >>> largest, q = largest_by_joint(waves, box, starts=np.zeros((1, 2)))
    >>> largest.round(9).tolist(), abs(q[1, 1]).round(3).tolist()
    ([1.0, 2.0], 1.571)
    """
    box = np.asarray(limits, dtype=float)
    random = np.random.default_rng(0).uniform(box[:, 0], box[:, 1], (SAMPLES, len(box)))
    points = np.concatenate([np.asarray(starts, dtype=float), random])
    if within is not None:
        points = points[within(points)]
    sizes = np.abs(torque(points))
    best = np.argmax(sizes, axis=0)
    largest, at = sizes[best, np.arange(len(box))], points[best]
    for joint in range(len(box)):
        spread = float(np.ptp(sizes[:, joint]))
        if spread == 0.0:  # constant, as far as can be seen
            continue
        for start in points[np.argsort(-sizes[:, joint], kind="stable")[:CLIMBS]]:
            climb = scipy.optimize.minimize(
                lambda q, j=joint, s=spread: -float(np.abs(torque(q[None, :]))[0, j]) / s,
                start,
                method="L-BFGS-B",
                bounds=box,
            )
            if within is not None and not within(climb.x[None, :])[0]:
                continue
            found = np.abs(torque(climb.x[None, :]))[0]
            better = found > largest
            largest, at = np.where(better, found, largest), np.where(better[:, None], climb.x, at)
    return largest, at


def default_tolerance(gravity: GravityModel, limits: ArrayLike) -> Array:
    """Torque error of each joint that a model may have where nothing else is asked for.

    Parameters
    ----------
    gravity
        The true gravity torque.
    limits
        Joint limits (n, 2) [rad]; one turn where they allow more.

    Returns
    -------
    (n,) array
        1 % of each joint's largest torque within the limits, at least 1e-3 of the arm's largest
        [N m]; so joints that gravity does not load are judged too.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> default_tolerance(gravity, [[-np.pi, np.pi]] * 2).round(3).tolist()
    [0.245, 0.061]
    """
    box = np.array(limits, dtype=float)
    box[np.ptp(box, axis=1) > 2 * np.pi] = -np.pi, np.pi
    largest, _ = largest_by_joint(gravity.torque, box, starts=dense_targets(box).q)
    return np.maximum(SHARE * largest, LEAST_SHARE * largest.max())


def require_gravity(gravity: GravityModel) -> None:
    """Refuse to judge against a torque that is zero everywhere: every claim would stand.

    Raises
    ------
    InputError
        If gravity loads no joint.
    """
    if len(gravity.free_joints) == gravity.n:
        accepted = (
            "a robot that gravity loads (masses in its file, an axis that is not vertical): "
            "beside zero any relation and any model of zeros would pass"
        )
        raise InputError(gravity.name, "gravity torque", "zero at every joint", accepted)
