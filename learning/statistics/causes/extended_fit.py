"""A model and causes beside it, fitted together: what follows from derivatives and residuals."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extension import ADDED, Shape, Term, added_torque

Array = NDArray[np.float64]

LARGEST_SCALE, LARGEST_SAG, LARGEST_GAIN = 0.3, 0.3, 10.0
"""Causes beyond are no causes: relative error of angles, sag [rad, RMS], gain or its inverse."""
COLUMNS_KEPT = 1e-5
"""Combinations of columns (of length 1) that count, relative to the largest singular value."""
NEGLIGIBLE_COLUMN = 1e-7
"""Columns that are so small beside the largest are rounding."""
DETERMINED = 1e-12
"""Combinations of unknowns with a smaller singular value than this share are not determined, ..."""
OPEN = 1e-6
"""... and an unknown that they contain by more than this has no standard error."""


@dataclass(frozen=True, eq=False)
class Slopes:
    """Measured torques of a model without causes that add to them, and their derivatives.

    Attributes
    ----------
    torque : (m, n) array
        Gains included, as everywhere but in ``gained`` [N m].
    own : (m, n, p) array
        By the unknowns of the model.
    gained : (m, n) array
        Of every joint by its gain.
    stiffness : (m, n, n) array
        By the angles [N m/rad].
    loads : (m, n, k) array
        By the unknowns that a load changes.
    """

    torque: Array
    own: Array
    gained: Array
    stiffness: Array
    loads: Array


@dataclass(frozen=True, eq=False)
class ExtendedFit(ABC):
    """A minimum of the squared errors of a model with causes, at m samples of n joints.

    Attributes
    ----------
    directions : (m, n) array or None
        Signs of the last motion of every joint; 0 where not known.
    terms : tuple of Term
        What there is beside the model.
    values : dict of Term to (k,) array
        Unknowns of all terms but gains.
    nominal : (n,) array
        Gains that are no causes.
    cost : float
        Sum of squares of whitened errors.
    whitening : (m, n, n) array
        What errors are multiplied with.
    """

    directions: Array | None
    terms: tuple[Term, ...]
    values: dict[Term, Array]
    nominal: Array
    cost: float
    whitening: Array

    @property
    @abstractmethod
    def q(self) -> Array:
        """Configurations (m, n) as measured [rad]."""

    @property
    @abstractmethod
    def torque(self) -> Array:
        """Torques (m, n) as measured [N m]."""

    @property
    @abstractmethod
    def gains(self) -> Array:
        """Measured over true torques, (n,)."""

    @property
    @abstractmethod
    def slopes(self) -> Slopes:
        """Torques of the model and their derivatives at the samples."""

    @property
    def stiffness(self) -> Array:
        """Derivatives (m, n, n) of the torques by the angles [N m/rad]."""
        return self.slopes.stiffness

    def columns(self, terms: Sequence[Term]) -> Array:
        """Derivatives (m, n, k) of the measured torques by the unknowns of terms."""
        return cause_columns(terms, self.q, self.torque, self.directions, self.slopes)

    @cached_property
    def rows(self) -> Array:
        """Whitened derivatives (m n, p) by all unknowns, those of `terms` last."""
        every = np.concatenate([self.slopes.own, self.columns(self.terms)], axis=2)
        return (self.whitening @ every).reshape(self.torque.size, -1)

    @cached_property
    def rest(self) -> Array:
        """Torques (m, n) [N m] that model and causes leave."""
        torque = self.slopes.torque
        for term in self.terms:
            if term.shape in ADDED or term.shape is Shape.LOAD:
                torque = torque + self.columns([term]) @ self.values[term]
        return self.torque - torque

    @cached_property
    def residual(self) -> Array:
        """What is left, whitened, (m n,)."""
        return np.einsum("kij,kj->ki", self.whitening, self.rest).ravel()

    @cached_property
    def basis(self) -> Array:
        """Orthonormal basis (m n, rank) of what the unknowns can explain, whitened."""
        size = np.linalg.norm(self.rows, axis=0)
        used = self.rows[:, size > NEGLIGIBLE_COLUMN * size.max(initial=0.0)]
        left, values, _ = np.linalg.svd(used / np.linalg.norm(used, axis=0), full_matrices=False)
        return np.asarray(left[:, values > COLUMNS_KEPT * values.max(initial=0.0)])

    @property
    def spare(self) -> int:
        """Degrees of freedom that are left, at least 1."""
        return max(self.torque.size - self.basis.shape[1], 1)

    def effect(self, terms: Sequence[Term]) -> Array:
        """Torques (m, n) [N m] that terms add."""
        result = np.zeros(self.q.shape)
        for term in terms:
            gain = term.shape is Shape.GAIN
            more = (self.gains - self.nominal)[[term.place]] if gain else self.values[term]
            result += self.columns([term]) @ more
        return result

    def estimate(self, term: Term) -> tuple[Array, Array]:
        """Unknowns of one of the terms and their standard errors, as the whitening says.

        Those of a gain are relative to the nominal one. Errors are infinite where the samples
        leave an unknown open.
        """
        loads = self.slopes.loads.shape[2]
        first = self.slopes.own.shape[2]
        first += sum(width(t, loads) for t in self.terms[: self.terms.index(term)])
        error = self._errors[first : first + width(term, loads)]
        if term.shape is Shape.GAIN:
            nominal = self.nominal[[term.place]]
            return self.gains[[term.place]] / nominal, error / np.abs(nominal)
        return self.values[term], error

    @cached_property
    def _errors(self) -> Array:
        """Standard errors (p,) of all unknowns."""
        size = np.linalg.norm(self.rows, axis=0)
        scale = np.maximum(size, 1e-9 * size.max(initial=0.0) + np.finfo(float).tiny ** 0.5)
        rows = np.linalg.qr(self.rows / scale, mode="r")
        _, found, vectors = np.linalg.svd(rows)
        values = np.zeros(len(vectors))
        values[: len(found)] = found
        kept = values > DETERMINED * values.max(initial=1e-300)
        errors = np.linalg.norm(vectors[kept] / values[kept][:, None], axis=0) / scale
        open_ones = np.linalg.norm(vectors[~kept], axis=0) > OPEN
        return np.where(open_ones, np.inf, errors)

    def plausible(self) -> bool:
        """Whether all causes are as small as causes are."""
        size = np.sqrt(np.mean(self.torque**2, axis=0))
        gains = np.abs(self.gains / self.nominal)
        for term in self.terms:
            gain = gains[term.place] if term.shape is Shape.GAIN else 1.0
            if not 1.0 / LARGEST_GAIN < gain < LARGEST_GAIN:  # 0: a sensor that does not read
                return False
            if term.shape is Shape.SCALE and abs(self.values[term][0]) > LARGEST_SCALE:
                return False
            sag = term.shape is Shape.COMPLIANCE
            if sag and abs(self.values[term][0]) * size[term.place] > LARGEST_SAG:
                return False
        return bool(np.isfinite(self.cost))


def width(term: Term, loads: int) -> int:
    """Number of unknowns of a term, of a model in which a load changes so many."""
    return loads if term.shape is Shape.LOAD else 1


def cause_columns(
    terms: Sequence[Term],
    q: Array,
    torque: Array,
    directions: Array | None,
    slopes: Slopes | None,
) -> Array:
    """Derivatives (m, n, k) of measured torques by the unknowns of terms.

    Parameters
    ----------
    terms : sequence of Term
    q, torque : (m, n) arrays
        As measured [rad], [N m].
    directions : (m, n) array or None
        Signs of the last motion of every joint.
    slopes : Slopes or None
        Of the model; None where all terms add to the torque alone.
    """
    loads = 0 if slopes is None else slopes.loads.shape[2]
    result = np.zeros((*q.shape, sum(width(term, loads) for term in terms)))
    c = 0
    for term in terms:
        j = term.place
        if term.shape in ADDED:
            result[:, j, c] = added_torque(term, q, directions)
        else:
            assert slopes is not None
            if term.shape is Shape.GAIN:
                result[:, j, c] = slopes.gained[:, j]
            elif term.shape is Shape.SCALE:
                result[:, :, c] = slopes.stiffness[:, :, j] * q[:, [j]]
            elif term.shape is Shape.COMPLIANCE:
                result[:, :, c] = -slopes.stiffness[:, :, j] * torque[:, [j]]
            else:
                result[j:, :, c : c + loads] = slopes.loads[j:]
        c += width(term, loads)
    return result
