"""Search for the largest torque error where its waves are too fast for floats to be climbed."""

from __future__ import annotations

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from isotorque.verify.relations.exact_numbers import angle, nearest
from isotorque.verify.relations.residual import Residual

Array = NDArray[np.float64]

LEVELS = range(2, 51, 4)
"""Steps are multiples of 2^-level [rad], from a quarter down to the last bit of a float near pi."""

STEPS = 16
"""So many multiples to either side are tried: those of a level end where the one before began."""

UNRESOLVED, MANY = 0.1, 1024
"""Where even the last bit turns a wave by more than this [rad], that many steps of it are tried:
between neighbouring floats the phase is any."""

TRIED, STARTS, ROUNDS = 64, 4, 8
"""Random configurations, how many of them are climbed from, and how often at each level."""


class WaveSearch:
    """Climbs sums of waves of any speed.

    Parameters
    ----------
    residual
        The error of a relation, expanded into waves.

    Notes
    -----
    A wave cos(f.q) with f = 2^60 turns many times between two neighbouring floats: its gradient
    says nothing, and f.q in floats is all rounding. But the phase of every wave at a configuration
    of floats, and the turn that a step of 2^-level of a joint gives to it, are known exactly and
    reduced modulo 2 pi before they are rounded. So joints are moved one by one, in steps from
    coarse to fine: coarse ones set the slow waves, fine ones the fast waves, and leave the slow
    ones alone. Deterministic.

    Examples
    --------
    >>> from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
    >>> U = TrigonometricPolynomial([[1]], [0.0], [1.0])
    >>> error = Residual.of([[2**61 + 1]], [0], [-1], U)  # cos((2^61 + 1) q) + cos q
    >>> bool(abs(error.values(WaveSearch(error).highest(0)[None])).max() > 1.999)
    True
    """

    def __init__(self, residual: Residual) -> None:
        self._residual = residual
        self._turns = np.array(
            [
                [
                    [nearest(angle(f[j] * fmpq(1, 2**level))) for f in residual.frequencies]
                    for j in range(residual.n)
                ]
                for level in LEVELS
            ]
        )
        # multiples of 1/16 rad within half a turn: steps from there stay floats
        self.tried = np.random.default_rng(0).integers(-50, 51, (TRIED, residual.n)) / 16.0
        self._phases = residual.phases(self.tried)
        self._found = np.abs(residual.at_phases(self._phases))

    def highest(self, joint: int) -> Array:
        """Return the configuration (n,) found with the largest error of a joint, |q_j| <= pi."""
        order = np.argsort(-self._found[:, joint], kind="stable")[:STARTS]
        climbed = [self._climb(int(i), joint) for i in order]
        return max(climbed, key=lambda found: found[0])[1]

    def _climb(self, start: int, joint: int) -> tuple[float, Array]:
        q, phases = self.tried[start].copy(), self._phases[start].copy()
        best = self._found[start, joint]
        few = np.arange(-STEPS, STEPS + 1)
        for level, turns in zip(LEVELS, self._turns, strict=True):
            for _ in range(ROUNDS):
                before = best
                for moved in range(self._residual.n):
                    jumps = level == LEVELS[-1] and np.abs(turns[moved]).max() > UNRESOLVED
                    multiples = np.arange(-MANY, MANY + 1) if jumps else few
                    there = q[moved] + multiples * 2.0**-level
                    tried = phases + multiples[:, None] * turns[moved]
                    size = np.abs(self._residual.at_phases(tried)[:, joint])
                    size[np.abs(there) > np.pi] = -1.0
                    at = int(np.argmax(size))
                    if size[at] > best:
                        best, q[moved], phases = size[at], there[at], tried[at]
                if best == before:
                    break
        return float(best), q
