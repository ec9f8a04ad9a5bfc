"""Component-wise level sets of a two-joint arm: curves on which one torque has a given size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from contourpy import contour_generator
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.angles import TURN
from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

_GRID = 128
_ROUNDS = 8
_MOST_PARTS = 64
_WHERE = np.array([0.25, 0.5, 0.75])  # a midpoint alone would miss inflections
_DEFAULT = 4e-8  # tolerance, as a share of the bound on the joint's torque
_FINEST = 4e-11  # likewise: finer ones would be rounding, at thousands of points


@dataclass(frozen=True, eq=False)
class LevelCurves:
    """Curves in the plane of two joint angles.

    Attributes
    ----------
    curves : tuple of (m, 2) arrays
        Polylines [rad]; a closed curve ends where it begins.
    torques : (c,) array
        The torque of the joint on each of them [N m]: plus or minus the one asked for.
    """

    curves: tuple[Floats, ...]
    torques: Floats


def level_curves(
    potential: TrigonometricPolynomial,
    joint: int,
    torque: float,
    *,
    tolerance: float | None = None,
    window: ArrayLike = ((-np.pi, np.pi), (-np.pi, np.pi)),
) -> LevelCurves:
    """Return the curves on which one joint needs plus or minus a torque.

    Parameters
    ----------
    potential
        Gravity potential of an arm with two joints [J].
    joint
        Which torque: 0 or 1.
    torque
        Its size [N m].
    tolerance
        Largest error of that torque anywhere on the polylines [N m]. The default, 4e-8 of the
        largest torque the joint can need, gives thousands of points per curve; 4e-4 of it is
        ample for a picture.
    window : (2, 2) array
        Lower and upper end of both joint angles [rad].

    Returns
    -------
    LevelCurves
        Empty where no configuration needs the torque.

    Raises
    ------
    InputError
        If the arm has not two joints, or an argument is out of range.

    Notes
    -----
    A torque of a single frequency (the last joint's) is constant on straight lines. Otherwise
    contours of a grid are moved onto the curve by Newton steps along the gradient and refined until
    the error on every segment is within the tolerance; of features narrower than the grid's 1/128
    of the window parts can be missing, and single points where the torque is largest are.

    References
    ----------
    The paper, Eq. 6, 7 and Fig. 2B: the configurations of a torque are the intersections of the
    curves of both joints.

    Examples
    --------
    >>> arm = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.39, 6.13])
    >>> found = level_curves(arm, 1, 3.0)
    >>> error = [abs(arm.gradient(c)[:, 1] - t).max() for c, t in zip(found.curves, found.torques)]
    >>> len(found.curves), bool(max(error) < 1e-6)
    (8, True)
    """
    if potential.n != 2:
        raise InputError("level curves", "number of joints", potential.n, "2")
    if joint not in (0, 1):
        raise InputError("level curves", "joint", joint, "0 or 1")
    if not np.isfinite(torque):
        raise InputError("level curves", "torque", torque, "a finite number [N m]")
    ends = np.asarray(window, dtype=float)
    if ends.shape != (2, 2) or not np.isfinite(ends).all() or np.any(ends[:, 0] >= ends[:, 1]):
        raise InputError(
            "level curves", "window", ends.tolist(), "((low, high), (low, high)) [rad]"
        )
    component = potential.significant().to_float().derivative(joint)
    bound = component.sup_bound()
    if tolerance is None:
        tolerance = _DEFAULT * bound
    elif not (np.isfinite(tolerance) and tolerance > 0.0 and tolerance >= _FINEST * bound):
        accepted = f"a number >= {_FINEST * bound:.3g} [N m]"
        raise InputError("level curves", "tolerance", tolerance, accepted)
    levels = [abs(torque)] if torque == 0 else [abs(torque), -abs(torque)]
    curves: list[Floats] = []
    torques: list[float] = []
    for level in levels:
        if len(component) == 1:
            found = _straight_lines(component, level, ends)
        else:
            found = _contours(component, level, ends, tolerance)
        curves += found
        torques += [level] * len(found)
    return LevelCurves(tuple(curves), np.array(torques))


def _straight_lines(component: TrigonometricPolynomial, level: float, ends: Floats) -> list[Floats]:
    """Return where ``rho cos(k.q - phi)`` is ``level``: straight lines, cut at the window."""
    rho = float(component.amplitudes()[0])
    if abs(level) > rho * (1 + 1e-12):
        return []
    k = component.frequencies[0].astype(float)
    phi = float(np.arctan2(component.sin[0], component.cos[0]))
    opening = float(np.arccos(np.clip(level / rho, -1, 1)))
    phases = {phi + opening, phi - opening} if 1e-6 < opening < np.pi - 1e-6 else {phi + opening}
    reach = np.sort(k[:, None] * ends, axis=1).sum(axis=0)  # of k.q in the window
    along = np.array([-k[1], k[0]])
    lines = []
    for phase in sorted(phases):
        first, last = np.ceil((reach[0] - phase) / TURN), np.floor((reach[1] - phase) / TURN)
        for turns in np.arange(first, last + 1):
            foot = (phase + TURN * turns) * k / (k @ k)
            moving = along != 0
            cuts = np.sort((ends[moving] - foot[moving, None]) / along[moving, None], axis=1)
            low, high = cuts[:, 0].max(), cuts[:, 1].min()
            if low < high:
                lines.append(foot + np.outer([low, high], along))
    return lines


def _contours(
    component: TrigonometricPolynomial, level: float, ends: Floats, tolerance: float
) -> list[Floats]:
    """Return contours of a grid, moved onto the curve and refined."""
    x, y = (np.linspace(low, high, _GRID + 1) for low, high in ends)
    values = component.evaluate(np.stack(np.meshgrid(x, y), axis=-1))
    pieces: list[Floats] = []
    for line in contour_generator(x, y, values).lines(level):
        pieces += _refined(component, np.asarray(line), level, tolerance)
    return pieces


def _onto_curve(component: TrigonometricPolynomial, points: Floats, level: float) -> Floats:
    """Move points along the gradient until the component is ``level`` to rounding."""
    rounding = 1e-14 * component.sup_bound()
    for _ in range(12):
        miss = component.evaluate(points) - level
        if np.abs(miss).max(initial=0.0) < rounding:
            break
        gradient = component.gradient(points)
        step = miss[:, None] * gradient / np.maximum((gradient**2).sum(axis=1), 1e-300)[:, None]
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1.0, 0.05 / np.maximum(length, 1e-300))[:, None]
        points = points - step
    return points


def _worst(component: TrigonometricPolynomial, points: Floats, level: float) -> NDArray[np.float64]:
    """Return the largest error found on each segment between consecutive points."""
    inside = points[:-1, None] + _WHERE[:, None] * np.diff(points, axis=0)[:, None]
    return np.asarray(np.abs(component.evaluate(inside) - level).max(axis=1))


def _refined(
    component: TrigonometricPolynomial, line: Floats, level: float, tolerance: float
) -> list[Floats]:
    """Return the polyline with as many points as the tolerance needs, cut where it cannot hold.

    The error of a segment falls with the square of its length. (Where a curve crosses itself a
    contour of a grid can join the wrong branches.)
    """
    closed = np.array_equal(line[0], line[-1])
    points = _onto_curve(component, line, level)
    if closed:
        points[-1] = points[0]
    # through a grid point the contour comes in twice
    points = points[np.append(True, np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-12)]
    if len(points) < 2:
        return []
    for _ in range(_ROUNDS):
        error = _worst(component, points, level)
        parts = np.ceil(np.sqrt(np.minimum(error / (0.7 * tolerance), _MOST_PARTS**2)))
        parts = np.maximum(parts, 1).astype(np.int64)
        if parts.max() == 1:
            break
        # every segment in so many equal parts; old points stay as they are
        segment = np.repeat(np.arange(len(parts)), parts)
        share = (np.arange(len(segment)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[
            segment
        ]
        finer = points[segment] + share[:, None] * np.diff(points, axis=0)[segment]
        new = share > 0
        finer[new] = _onto_curve(component, finer[new], level)
        points = np.concatenate([finer, points[-1:]])
    bad = np.flatnonzero(_worst(component, points, level) > tolerance)
    return [piece for piece in np.split(points, bad + 1) if len(piece) > 1]
