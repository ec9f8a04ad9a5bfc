"""Models that causes can be added to: chains, waves, regressors alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.causes.extension import Extension, Kind, Term

Array = NDArray[np.float64]


F = TypeVar("F", bound=ExtendedFit)


class ExtensibleModel(Protocol[F]):
    """A family of models and the samples that it is fitted to."""

    @property
    def q(self) -> Array:
        """Configurations (m, n) [rad]."""

    @property
    def torque(self) -> Array:
        """Torques (m, n) [N m]."""

    @property
    def directions(self) -> Array | None:
        """Signs (m, n) of the last motion of every joint; 0 where not known."""

    @property
    def noise(self) -> Array:
        """Standard deviation (n,) of the torque errors [N m], stated or estimated."""

    @property
    def noise_known(self) -> bool:
        """Whether it was stated."""

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """What may be added to the model."""

    def refitted(self, terms: Sequence[Term], near: F, *, thorough: bool = False) -> F:
        """The minimum with these terms that lies near another."""

    def others(self, extension: Extension, terms: Sequence[Term], count: int) -> Sequence[F]:
        """Minima found from elsewhere; none where there is one minimum only."""

    def reweighted(self, fitted: F) -> Self:
        """The same with the noise that a fit leaves; itself where the noise is known."""
