"""Measured torques held against the analytic gravity torque."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.statistics.poses import group_poses
from isotorque.symbolic.gravity.gravity_model import GravityModel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Disagreement:
    """Differences between measured and analytic torques.

    Attributes
    ----------
    rows, poses : int
        Number of rows compared, and of the poses they were recorded in.
    rmse : float
        Root mean square of measured less analytic torques, over poses and joints [N m].
    rmse_by_joint, mean_by_joint : (n,) arrays
        Root mean square and mean joint by joint [N m], over poses.
    rmse_beside_constants : float
        What ``rmse`` would be if the mean of every joint were a constant that its sensor adds to
        gravity [N m].
    share : float
        ``rmse`` over the root mean square of the measured torques.
    largest : float
        Largest difference [N m].
    row : int
        Number of its sample, from 0 on.
    rmse_opposite : float
        What ``rmse`` would be if the torques had the opposite sign [N m].
    rmse_degrees : float
        What it would be if the angles were degrees [N m].
    """

    rows: int
    poses: int
    rmse: float
    rmse_by_joint: Array
    mean_by_joint: Array
    rmse_beside_constants: float
    share: float
    largest: float
    row: int
    rmse_opposite: float
    rmse_degrees: float


MUCH_BETTER = 3.0
"""Times that another sign or unit must fit better to be suspected."""


def misread_units(rmse: float, opposite: float, degrees: float) -> str | None:
    """Say that torques have the opposite sign or angles are degrees, if that fits far better.

    Parameters
    ----------
    rmse, opposite, degrees
        Disagreement as it is, with the opposite sign of all torques, with angles taken for degrees
        [N m].

    Examples
    --------
    >>> print(misread_units(2.0, 1.9, 0.01))
    with angles in degrees that would be 0.01 N m: q is in radians
    >>> misread_units(2.0, 1.9, 1.8) is None
    True
    """
    if MUCH_BETTER * opposite < rmse:
        return (
            f"with the opposite sign of all torques that would be {opposite:.4g} N m:"
            " tau is the torque that holds the arm, not the one that gravity exerts"
        )
    if MUCH_BETTER * degrees < rmse:
        return f"with angles in degrees that would be {degrees:.4g} N m: q is in radians"
    return None


def disagreement(
    q: ArrayLike, torque: ArrayLike, gravity: GravityModel, *, leave_out: ArrayLike | None = None
) -> Disagreement:
    """Compare measured samples with the gravity torque of a robot.

    Parameters
    ----------
    q, torque : (m, n) arrays
        Configurations [rad] and torques that held them [N m], m at least 1.
    gravity
        The analytic torque.
    leave_out : (m,) bools, optional
        Samples that are not compared (outliers); not all of them.

    Notes
    -----
    Rows of one pose count as one: each pose has the same weight.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> q = np.array([[0.0, 0.5], [1.0, -0.5]])
    >>> found = disagreement(q, -gravity.torque(q), gravity)
    >>> round(found.share, 9), found.rmse_opposite
    (2.0, 0.0)
    """
    samples, measured = np.asarray(q, dtype=float), np.asarray(torque, dtype=float)
    numbers = np.arange(len(samples))
    if leave_out is not None:
        numbers = np.flatnonzero(~np.asarray(leave_out, dtype=bool))
    samples, measured = samples[numbers], measured[numbers]
    difference = measured - gravity.torque(samples)
    poses = group_poses(samples)

    def rms(values: Array) -> float:
        return float(np.sqrt(np.mean(poses.means(values**2))))

    size, mean = rms(measured), poses.means(difference).mean(axis=0)
    row = int(np.argmax(np.abs(difference).max(axis=1)))
    return Disagreement(
        rows=len(numbers),
        poses=poses.count,
        rmse=rms(difference),
        rmse_by_joint=np.sqrt(np.mean(poses.means(difference**2), axis=0)),
        mean_by_joint=mean,
        rmse_beside_constants=rms(difference - mean),
        share=rms(difference) / size if size else 0.0,
        largest=float(np.abs(difference[row]).max()),
        row=int(numbers[row]),
        rmse_opposite=rms(measured + gravity.torque(samples)),
        rmse_degrees=rms(measured - gravity.torque(np.deg2rad(samples))),
    )
