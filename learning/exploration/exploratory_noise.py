"""Correlated exploratory noise: a random affine function of the target that drifts slowly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


class ExploratoryNoise:
    """Noise ``sigma(q, t) = A_t (q - q_home) + b_t`` of Eq. 14, after Rolf et al. (2011).

    Every entry of A_t and b_t is a random walk that is scaled back after each step so that its
    variance stays what it was: ``x <- (x + delta) / sqrt(1 + drift^2)`` with delta of standard
    deviation ``drift`` times that of x. Neighbouring targets at neighbouring times thus get
    similar noise: the arm leans to one side for a while instead of trembling.

    Parameters
    ----------
    amplitude : (n,) array
        Standard deviation of the entries of b [N m], and of the rows of A [N m per rad]. Zero on
        joints that must not be disturbed.
    drift : float
        Standard deviation of one step of the walk, as a share of the entry's own; the noise is
        forgotten after some ``1 / drift^2`` steps.
    rng : numpy.random.Generator
        Source of randomness.

    References
    ----------
    Rolf, Steil, Gienger (2011), "Online Goal Babbling for rapid bootstrapping of inverse models in
    high dimensions", ICDL.

    Examples
    --------
    >>> noise = ExploratoryNoise(np.array([0.5, 0.0]), 0.3, np.random.default_rng(0))
    >>> noise(np.zeros(2)).shape, bool(noise(np.ones(2))[1] == 0.0)
    ((2,), True)
    """

    def __init__(self, amplitude: Array, drift: float, rng: np.random.Generator) -> None:
        self._amplitude = np.asarray(amplitude, dtype=float)
        if not (np.isfinite(self._amplitude).all() and (self._amplitude >= 0).all()):
            raise InputError("exploratory noise", "amplitude", amplitude, "numbers >= 0 [N m]")
        if not (np.isfinite(drift) and drift >= 0):
            raise InputError("exploratory noise", "drift", drift, "a number >= 0")
        self._drift = float(drift)
        self._rng = rng
        joints = len(self._amplitude)
        # One column per joint angle and one for the constant, all of unit variance.
        self._entries = rng.standard_normal((joints, joints + 1))

    def __call__(self, displacement: Array) -> Array:
        """Noise torque (n,) [N m] for a target at ``displacement`` = q - q_home (n,) [rad]."""
        unit = self._entries[:, :-1] @ displacement + self._entries[:, -1]
        return np.asarray(self._amplitude * unit)

    def step(self) -> None:
        """Let the random walk go one step on."""
        push = self._drift * self._rng.standard_normal(self._entries.shape)
        self._entries = (self._entries + push) / np.sqrt(1.0 + self._drift**2)
