"""Static torques that an arm passed by while it followed a torque profile."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.relations.potential.errors_in_variables import stiffness_matrices
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

SPACING = 0.05
"""Configurations nearer to each other than this say the same [rad]."""
NOTHING = 1e-9
"""Gravity does not act on a joint whose stiffness is so small a share of the largest."""


def visited_torques(
    fit: FittedPotential | ChainParameters, q: ArrayLike, *, spacing: float = SPACING
) -> Array:
    """Torques that would have held an arm where it passed by.

    Parameters
    ----------
    fit : FittedPotential or ChainParameters
        The potential, or the snapped rigid chain, fitted to settled samples of the same arm.
    q : (T, n) array_like
        Joint trajectory of a torque profile, within the joint limits [rad].
    spacing : float
        Configurations are taken so far apart, in the joint that moved most [rad].

    Returns
    -------
    (m, n) array
        Static torques of those among them where the arm could have rested [N m].

    Raises
    ------
    InputError
        If the trajectory has another number of joints.

    Notes
    -----
    The torque that was applied on the way also accelerated the arm: it is no static torque, and
    may be larger than any. What counts is where the arm has been (paper, section 5.4: "the applied
    torque profiles and observed joint angles are exploited to update the estimates of the SST").
    There the fitted potential says which torque holds it, and by its stiffness whether the arm
    would stay.

    Examples
    --------
    >>> from isotorque.learning.relations.potential.potential_fit import all_frequencies
    >>> from isotorque.learning.relations.potential.potential_fit import fit_potential
    >>> samples = np.array([[-2.0], [-1.5], [-1.0], [-0.4]])
    >>> fit = fit_potential(samples, 5.0 * np.cos(samples), all_frequencies(1))
    >>> swing = np.linspace(-1.0, 1.0, 200)[:, None]  # a pendulum swings past the horizontal
    >>> torques = visited_torques(fit, swing, spacing=0.25)
    >>> torques.round(2).ravel().tolist()
    [2.7, 3.66, 4.39, 4.85]
    """
    trajectory = np.asarray(q, dtype=float)
    n = fit.n if isinstance(fit, ChainParameters) else fit.frequencies.shape[1]
    if trajectory.ndim != 2 or trajectory.shape[1] != n:
        raise InputError("visited torques", "shape of q", trajectory.shape, f"(T, {n})")
    if not len(trajectory):
        return np.empty((0, n))
    kept = [0]
    for i in range(1, len(trajectory)):
        if np.abs(trajectory[i] - trajectory[kept[-1]]).max() >= spacing:
            kept.append(i)
    visited = trajectory[kept]
    if isinstance(fit, ChainParameters):
        stiffness, torque = fit.stiffness(visited), fit.torque
        acting = np.abs(stiffness).max(axis=(0, 1)) > NOTHING * np.abs(stiffness).max()
    else:
        stiffness = stiffness_matrices(fit.frequencies, fit.coefficients, visited)
        acting, torque = fit.frequencies.any(axis=0), fit.potential.gradient
    stable = np.linalg.eigvalsh(stiffness[:, acting][:, :, acting])[:, 0] > 0.0
    return np.asarray(torque(visited[stable]))
