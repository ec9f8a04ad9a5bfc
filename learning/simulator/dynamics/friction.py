"""Velocities under Coulomb friction."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from isotorque.learning.simulator.dynamics.equations import Array

_ITERATIONS = 200


def solve_with_friction(a: Array, b: Array, friction: Array, guess: Array) -> Array:
    """Solve ``A x + friction * Sign(x) = b``, where Sign(0) is all of [-1, 1].

    Parameters
    ----------
    a : (n, n) array
        Symmetric positive-definite matrix.
    b, friction : (n,) arrays
        Right side, and friction, not negative.
    guess : (n,) array
        A guess of x.

    Returns
    -------
    (n,) array
        The solution, exactly zero where the joint sticks.

    Notes
    -----
    ``x' A x / 2 - b' x + sum of friction_i |x_i|`` has one minimum. Lemke's problem without pivots:
    with ``r = b - A x`` in [-friction, friction], r and x complement each other, and the guess of
    who sticks, and which way the others go, is corrected where ``x + (r -+ friction)`` says so
    (primal-dual active sets: Hintermueller, Ito and Kunisch, SIAM J. Optim. 13 (2003) 865-888).
    Should that cycle, coordinate descent goes on, which converges from anywhere.

    Examples
    --------
    >>> solve_with_friction(np.eye(2), np.array([3.0, 0.5]), np.ones(2), np.zeros(2))
    array([2., 0.])
    """
    scale = np.diag(a)
    signs = np.sign(guess)
    for _ in range(_ITERATIONS):
        x = np.zeros_like(b)
        moving = np.flatnonzero(signs)
        if len(moving):
            free = cho_factor(a[np.ix_(moving, moving)])
            x[moving] = cho_solve(free, b[moving] - signs[moving] * friction[moving])
        wanted = x * scale + (b - a @ x)
        corrected = np.where(wanted > friction, 1.0, np.where(wanted < -friction, -1.0, 0.0))
        if (corrected == signs).all():
            return x
        signs = corrected
    return _coordinate_descent(a, b, friction, guess)


def _coordinate_descent(a: Array, b: Array, friction: Array, x: Array) -> Array:
    """Solve the same problem one coordinate at a time, to rounding."""
    x = x.copy()
    for _ in range(100 * _ITERATIONS):
        before = x.copy()
        for i in range(len(b)):
            rest = b[i] - a[i] @ x + a[i, i] * x[i]
            x[i] = np.sign(rest) * max(abs(rest) - friction[i], 0.0) / a[i, i]
        if np.abs(x - before).max() <= 1e-15 * np.abs(x).max():
            break
    return x
