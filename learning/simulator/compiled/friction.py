"""Velocities under Coulomb friction, compiled."""

from __future__ import annotations

from isotorque.learning.simulator.compiled.kernel import kernel
from isotorque.learning.simulator.compiled.linear import factorise, solve

_SWEEPS = 500


@kernel
def solve_with_friction(a, b, friction, factor, pivots, guess, x):
    """Solve ``A x + friction * Sign(x) = b``, where Sign(0) is all of [-1, 1].

    Parameters
    ----------
    a : (n, n) array
        Symmetric positive-definite matrix; the lower triangle is read.
    b : (n,) array
        Right side.
    friction : (n,) array
        Friction, not negative.
    factor : (n, n) array
        Workspace.
    pivots, guess : (n,) arrays
        Workspace.
    x : (n,) array
        A first guess in, the solution out; exactly zero where the joint sticks.

    Notes
    -----
    The one minimum of ``x' A x / 2 - b' x + sum of friction_i |x_i|``. Sweeps of coordinate
    descent, which converge from anywhere, guess who sticks and which way the others go; the
    linear system of that guess then is solved and its answer checked.
    """
    n = b.shape[0]
    for i in range(n):
        guess[i] = x[i]
    for _ in range(_SWEEPS):
        if _solve_as_guessed(a, b, friction, factor, pivots, guess, x):
            return
        for i in range(n):
            rest = b[i]
            for j in range(n):
                if j < i:
                    rest -= a[i, j] * guess[j]
                elif j > i:
                    rest -= a[j, i] * guess[j]
            if rest > friction[i]:
                guess[i] = (rest - friction[i]) / a[i, i]
            elif rest < -friction[i]:
                guess[i] = (rest + friction[i]) / a[i, i]
            else:
                guess[i] = 0.0
    for i in range(n):
        x[i] = guess[i]


@kernel
def _solve_as_guessed(a, b, friction, factor, pivots, guess, x):
    """Solve for the joints whose guess is not zero; tell whether the answer fits the guess."""
    n = b.shape[0]
    for i in range(n):
        moves = guess[i] != 0.0
        for j in range(i):
            factor[i, j] = a[i, j] if moves and guess[j] != 0.0 else 0.0
        factor[i, i] = a[i, i]
        x[i] = 0.0
        if guess[i] > 0.0:
            x[i] = b[i] - friction[i]
        elif guess[i] < 0.0:
            x[i] = b[i] + friction[i]
    factorise(factor, pivots)
    solve(factor, pivots, x)
    for i in range(n):
        if guess[i] != 0.0:
            if not x[i] * guess[i] > 0.0 and friction[i] > 0.0:
                return False
        else:
            rest = b[i]
            for j in range(n):
                rest -= (a[i, j] if j < i else a[j, i]) * x[j]
            if abs(rest) > friction[i]:
                return False
    return True
