"""A home configuration the arm can hold by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from isotorque.learning.simulator.dynamics.equations import Equations
from isotorque.learning.simulator.dynamics.free_directions import FreeDirections

Array = NDArray[np.float64]

STABLE = 1e-6  # smallest scaled stiffness that counts as stable
_SAMPLES_PER_JOINT = 600
_REFINED = 5
_EVALUATIONS = 400
_MARGIN = 0.05  # of the range of each joint, at most a turn, kept free on either side


def find_home(equations: Equations, free: FreeDirections, limits: Array) -> tuple[Array, float]:
    """Find the configuration within the limits at which the arm hangs most stably.

    Parameters
    ----------
    equations
        Equations of motion of the arm.
    free
        Its free directions; along them home lies in the middle of the limits, where possible.
    limits : (n, 2) array
        Joint limits [rad]; unlimited joints are searched from -pi to pi.

    Returns
    -------
    home : (n,) array
        Joint angles, rounded to milliradians.
    stiffness : float
        Smallest scaled eigenvalue of the stiffness on the active subspace there; the arm can hold
        home only where it is positive (above `STABLE`).

    Notes
    -----
    The smallest eigenvalue is maximised over configurations drawn with a fixed seed; the best few
    are refined by Nelder and Mead's method (the eigenvalue has kinks).
    """
    low, high = searched_range(limits)
    n = len(low)

    def lack(q: Array) -> float:
        return -float(free.active_stiffness(equations.stiffness(q)))

    drawn = np.random.default_rng(0).uniform(low, high, (n * _SAMPLES_PER_JOINT, n))
    stiffness = np.array([equations.stiffness(q) for q in drawn])
    order = np.argsort(-free.active_stiffness(stiffness), kind="stable")[:_REFINED]
    bounds = list(zip(low, high, strict=True))
    options = {"maxfev": _EVALUATIONS * n, "xatol": 1e-4, "fatol": 1e-6}
    found = [
        minimize(lack, drawn[k], method="Nelder-Mead", bounds=bounds, options=options)
        for k in order
    ]
    home = min(found, key=lambda result: float(result.fun)).x
    if free.any:
        centred = home + free.basis.T @ (free.basis @ (0.5 * (low + high) - home))
        if ((low <= centred) & (centred <= high)).all():
            home = centred
    home = np.clip(np.round(home, 3), low, high) + 0.0
    return home, -lack(home)


def searched_range(limits: Array) -> tuple[Array, Array]:
    """Return the lower and upper angles (n,) between which home is looked for.

    Some way off the limits, and within one turn about zero where they allow that.
    """
    low, high = limits[:, 0], limits[:, 1]
    margin = _MARGIN * np.minimum(high - low, 2.0 * np.pi)
    low, high = low + margin, high - margin
    near_zero = (low < np.pi) & (high > -np.pi)
    return np.where(near_zero, np.maximum(low, -np.pi), low), np.where(
        near_zero, np.minimum(high, np.pi), high
    )
