"""Inputs of a network: symmetric copies of a configuration, as angles or on circles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.network.canonical_coordinates import CanonicalCoordinates
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NetworkInputs:
    """Inputs of a network.

    Attributes
    ----------
    coordinates : SymmetryCoordinates
        y = B q and the group's action on it.
    periodic : bool
        Whether inputs are cos y, sin y (f = 2 r) or y / pi (f = r).
    averaged : bool
        Whether all copies under the group are shown (G = order) or one (G = 1).
    canonical : CanonicalCoordinates or None
        Show the representative in the fundamental domain instead.
    """

    coordinates: SymmetryCoordinates
    periodic: bool
    averaged: bool
    canonical: CanonicalCoordinates | None

    @property
    def count(self) -> int:
        """Number of inputs f."""
        return (2 if self.periodic else 1) * self.coordinates.rank

    def features(self, y: Array) -> Array:
        """Inputs (..., f) at coordinates (..., r)."""
        if self.periodic:
            return np.concatenate([np.cos(y), np.sin(y)], axis=-1)
        return np.asarray(y / np.pi)

    def of(self, q: Array, derivatives: bool = False) -> tuple[Array, Array, Array]:
        """Inputs for configurations.

        Parameters
        ----------
        q : (m, n) array
            Configurations [rad].
        derivatives : bool
            Whether to compute derivatives; the third result is empty otherwise.

        Returns
        -------
        x : (m, G, f) array
            Inputs.
        signs : (m, n) or (1, 1) array
            The torques are ``signs`` times what the network says.
        dx : (m, G, f, r) array
            Derivatives of x by y = B q.
        """
        signs = np.ones((1, 1))
        if self.canonical is not None:
            representatives, signs, linear = self.canonical.of(q)
            y, linear = representatives[:, None], linear[:, None]
        elif self.averaged:
            images, _ = self.coordinates.copies(q, np.zeros((len(q), self.coordinates.Y.shape[1])))
            y = images.transpose(1, 0, 2)
            linear = np.broadcast_to(
                self.coordinates.A_sat, (len(q), *self.coordinates.A_sat.shape)
            )
        else:
            y = wrap(self.coordinates.coordinates(q))[:, None]
            linear = np.broadcast_to(np.eye(self.coordinates.rank), (*y.shape, y.shape[-1]))
        if not derivatives:
            return self.features(y), signs, np.empty(0)
        if not self.periodic:
            return self.features(y), signs, np.asarray(linear / np.pi)
        dx = [-np.sin(y)[..., None] * linear, np.cos(y)[..., None] * linear]
        return self.features(y), signs, np.concatenate(dx, axis=2)
