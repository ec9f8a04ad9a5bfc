"""All configurations of a torque where the frequencies of the potential are independent."""

from __future__ import annotations

import itertools

import numpy as np

from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.lattices.integer_lattice import generate_lattice
from isotorque.symbolic.level_sets.equations import LevelSetEquations

DOUBLE = 1e-12
"""|sin| this near to 1 counts as 1: one angle, not two."""


def has_closed_form(equations: LevelSetEquations) -> bool:
    """Say whether every frequency of the potential is linearly independent of the others."""
    return len(equations.potential) == len(equations.basis)


def solve_in_closed_form(equations: LevelSetEquations) -> Floats:
    """Return all solutions y (m, r) of the equations, for all sign patterns.

    Parameters
    ----------
    equations
        With independent frequencies: the 2R arm, every planar arm, the pendulum.

    Returns
    -------
    (m, r) array
        Solutions in [0, 2 pi)^r, each once.

    Notes
    -----
    With ``U = sum_a rho_a cos(l_a . y - phi_a)`` the gradient is ``L^T s``, ``s_a = -rho_a
    sin(l_a . y - phi_a)``, and L, whose rows are the l_a, is invertible. So each target fixes all
    the sines; each sine allows two angles (one at +-1, none beyond), and the angles fix y up to
    the [L_sat : L] translations that change no angle. For the 2R arm the sines belong to the torque
    of each link about its own joint: ``tau_1 -+ tau_2`` and ``tau_2``.
    """
    potential = equations.potential
    r = len(equations.basis)
    lattice = generate_lattice(potential.frequencies)
    translations = np.linalg.solve(lattice.H.astype(float), 2 * np.pi * lattice.cosets().T).T
    L = potential.frequencies.astype(float)
    amplitude, phase = potential.amplitudes(), np.arctan2(potential.sin, potential.cos)
    found = [np.zeros((0, r))]
    for target in equations.targets:
        sine = -np.linalg.solve(L.T, target) / amplitude
        if np.any(np.abs(sine) > 1 + DOUBLE):
            continue
        angles = []
        for x, shift in zip(np.clip(sine, -1, 1), phase, strict=True):
            first = np.arcsin(x)
            both = [first] if abs(x) >= 1 - DOUBLE else [first, np.pi - first]
            angles.append([shift + angle for angle in both])
        choices = list(itertools.product(*angles))
        theta = np.array(choices).reshape(len(choices), r)
        y = np.linalg.solve(L, theta.T).T
        found.append((y[:, None] + translations).reshape(len(y) * len(translations), r))
    return np.asarray(np.remainder(np.concatenate(found), 2 * np.pi))
