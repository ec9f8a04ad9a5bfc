"""Models that causes can be added to: chains, waves, regressors alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extension import Extension, Kind, Term

Array = NDArray[np.float64]


class ExtendedFit(Protocol):
    """A model and causes, fitted together to m samples of n joints."""

    @property
    def terms(self) -> tuple[Term, ...]:
        """What there is beside the model."""

    @property
    def cost(self) -> float:
        """Sum of squares of whitened errors."""

    @property
    def spare(self) -> int:
        """Degrees of freedom that are left, at least 1."""

    @property
    def rest(self) -> Array:
        """Torques (m, n) [N m] that are left."""

    @property
    def residual(self) -> Array:
        """The same whitened, (m n,)."""

    @property
    def whitening(self) -> Array:
        """What errors are multiplied with, (m, n, n)."""

    @property
    def basis(self) -> Array:
        """Orthonormal basis (m n, rank) of what the unknowns can explain, whitened."""

    @property
    def stiffness(self) -> Array:
        """Derivatives (m, n, n) of the torques by the angles [N m/rad]."""

    def columns(self, terms: Sequence[Term]) -> Array:
        """Derivatives (m, n, k) of the measured torques by the unknowns of terms."""

    def estimate(self, term: Term) -> tuple[Array, Array]:
        """Unknowns of one of the terms, and their standard errors."""

    def effect(self, terms: Sequence[Term]) -> Array:
        """Torques (m, n) [N m] that terms add."""

    def plausible(self) -> bool:
        """Whether all causes are as small as causes are."""


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
