"""Viscous damping for arms whose robot file names none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.dynamics.equations import Equations

Array = NDArray[np.float64]

_RATIO = 1.8  # of sqrt(M K); 2 would be critical for a single joint
_SAMPLES = 128
_FREE_RATE = 5.0  # [rad/s], of an arm that feels no gravity at all


def default_damping(equations: Equations, stiffness_scale: Array) -> Array:
    """Return a damping (n,) [N m s/rad] under which the arm comes to rest soon.

    Parameters
    ----------
    equations
        Equations of motion of the arm.
    stiffness_scale : (n,) array
        Largest gravity stiffness of each joint [N m/rad]; 0 for joints that gravity does not feel.

    Notes
    -----
    ``D = 1.8 sqrt(M K)`` per joint, M and K the largest diagonal entries over configurations drawn
    with a fixed seed: just below critical. A joint that gravity does not feel gets the rate
    ``sqrt(K / M)`` of the median joint that does.

    Examples
    --------
    >>> from isotorque.learning.simulator.compiled.chain import CompiledEquations
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> two_links = CompiledEquations(load_robot("2r").model)
    >>> default_damping(two_links, np.array([24.5, 6.13])).round(1)
    array([8.1, 1.4])
    """
    rng = np.random.default_rng(0)
    configurations = rng.uniform(-np.pi, np.pi, (_SAMPLES, equations.n))
    mass = np.max([np.diag(equations.mass_matrix(q)) for q in configurations], axis=0)
    felt = stiffness_scale > 0.0
    rates = np.sqrt(stiffness_scale / mass)
    usual = float(np.median(rates[felt])) if felt.any() else _FREE_RATE
    return _RATIO * mass * np.where(felt, rates, usual)
