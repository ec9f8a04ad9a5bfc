"""Sensors of a simulated arm."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.settings import SensorNoise
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


class Sensors:
    """Encoders and torque sensors with their errors.

    Parameters
    ----------
    where
        What to call the robot in an error.
    noise
        Their errors.
    projector : (n, n) array
        Projects on what gravity feels: torque sensors show no noise elsewhere.
    rng
        Generator of the noise.

    Raises
    ------
    InputError
        For random noise without a generator.
    """

    def __init__(
        self,
        where: str,
        noise: SensorNoise,
        projector: Array,
        rng: np.random.Generator | None,
    ) -> None:
        if noise.is_random and rng is None:
            raise InputError(where, "rng", rng, "a numpy.random.Generator for the noise")
        self._noise = noise
        self._projector = projector
        self._rng = rng

    def angles(self, q: Array) -> Array:
        """Return joint angles (..., n) [rad] as the encoders show them."""
        seen = q.copy()
        if self._noise.angle > 0.0 and self._rng is not None:
            seen += self._rng.normal(0.0, self._noise.angle, q.shape)
        step = self._noise.encoder_step
        return np.round(seen / step) * step if step > 0.0 else seen

    def torque(self, torque: Array) -> Array:
        """Return applied torques (..., n) [N m] as the torque sensors show them."""
        if self._noise.torque > 0.0 and self._rng is not None:
            error = self._rng.normal(0.0, self._noise.torque, torque.shape)
            return torque + error @ self._projector
        return torque.copy()

    def holding_torque(self, torque: Array) -> Array:
        """Return the torque (n,) [N m] that an outside holder of the arm measures."""
        bound = self._noise.holding_torque
        if bound > 0.0 and self._rng is not None:
            torque = torque + self._rng.uniform(-bound, bound, len(torque))
        return self._projector @ torque

    def generator_state(self) -> dict[str, Any] | None:
        """Return the state of the generator, None if there is none."""
        return None if self._rng is None else deepcopy(dict(self._rng.bit_generator.state))

    def restore_generator(self, state: dict[str, Any] | None) -> None:
        """Put the generator, if there is one, into a state that was returned."""
        if self._rng is not None and state is not None:
            self._rng.bit_generator.state = deepcopy(state)
