"""Models that are linear in their unknowns, as models that causes can be added to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from isotorque.learning.statistics.causes.extended_fit import (
    COLUMNS_KEPT,
    ExtendedFit,
    Slopes,
    cause_columns,
    width,
)
from isotorque.learning.statistics.causes.extension import ADDED, Extension, Kind, Shape, Term
from isotorque.learning.statistics.noise_levels import estimated_levels, noise_left, whitening_of

Array = NDArray[np.float64]

KINDS = tuple(kind for kind in Kind if kind is not Kind.SIGN)
ADDING = (Kind.OFFSET, Kind.SPRING, Kind.CABLE)
"""Kinds that add to the torque, whatever the model and wherever the arm came from."""
DEPENDENT = 1e-11
"""Combinations of columns (of length 1) below this share of the largest are not told apart."""
PASSES, SETTLED = 6, 1e-4
"""Times that columns which depend on the model are computed anew, at most; until one changes the
cost by a smaller share."""
REWEIGHTINGS = 3
PROGRESS = 1e-9
"""A search for gains ends at a smaller relative step."""
LEAST_INVERSE = 1e-3
"""Inverse gains below are those of sensors that read nothing but noise."""


@dataclass(frozen=True, eq=False)
class LinearModel:
    """Torques ``g (columns @ x)`` and causes beside them.

    Attributes
    ----------
    q, torque : (m, n) arrays
        Samples [rad], [N m].
    own : (m, n, p) array
        Columns of the unknowns x.
    whitening : (m, n, n) array
        What errors are multiplied with.
    noise : (n,) array
        Standard deviation of the torque errors [N m].
    noise_known : bool
        Whether it was stated; otherwise every joint has a level of its own.
    floor : (n,) array
        Least noise: what arithmetic leaves [N m].
    directions : (m, n) array or None
        Signs of the last motion of every joint; 0 where not known.
    kinds : tuple of Kind
        What may be added.
    stiffness_of : callable, optional
        Derivatives (m, n, n) of ``columns @ x`` by the angles for x (p,); without it errors of
        angles are not looked for.
    weights : (m,) array or None
        Of the squared errors of the samples, where the whitening is theirs and the noise's alone;
        None: it holds what else was known of the errors, and only its size is estimated.

    Examples
    --------
    >>> from isotorque.learning.statistics.causes.cause import causes_of
    >>> from isotorque.learning.statistics.causes.selection import selected
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-2.0, 2.0, (30, 1))
    >>> tau = 5.0 * np.cos(q) + 0.2 * q + 0.01 * rng.normal(size=q.shape)
    >>> own = np.stack([np.cos(q), np.sin(q)], axis=2)
    >>> model = LinearModel.of(q, tau, own)
    >>> cause, = causes_of(selected(model, model.alone()))
    >>> print(cause.kind, cause.joint, cause.size.round(2))
    spring 0 [0.   0.21]
    """

    q: Array
    torque: Array
    own: Array
    whitening: Array
    noise: Array
    noise_known: bool
    floor: Array
    directions: Array | None = None
    kinds: tuple[Kind, ...] = KINDS
    stiffness_of: Callable[[Array], Array] | None = field(default=None, repr=False)
    weights: Array | None = None

    @classmethod
    def of(
        cls,
        q: Array,
        torque: Array,
        own: Array,
        *,
        weight: Array | None = None,
        directions: Array | None = None,
        kinds: tuple[Kind, ...] = KINDS,
        stiffness_of: Callable[[Array], Array] | None = None,
    ) -> LinearModel:
        """A model whose noise is not known, that of every joint its own.

        Parameters
        ----------
        q, torque : (m, n) arrays
            Samples [rad], [N m].
        own : (m, n, p) array
            Columns, as far as they go: combinations that the samples leave open do no harm.
        weight : (m,) array, optional
            Of the squared errors, all above 0.
        directions : (m, n) array, optional
            Signs of the last motion of every joint; 0 where not known.
        kinds : tuple of Kind
            What may be added.
        stiffness_of : callable, optional
            As of the class; with it, noise of the angles is looked for, too.
        """
        m, n = q.shape
        weights = np.ones(m) if weight is None else weight / weight.mean()
        floor = np.full(n, 1e-12 * max(float(np.abs(torque).max(initial=0.0)), 1e-300))
        model = cls(
            q,
            torque,
            own,
            whitening_of(np.ones(n), None, weights),
            np.ones(n),
            False,
            floor,
            directions,
            kinds,
            stiffness_of,
            weights,
        )
        return model.reweighted(model.alone())

    def alone(self, terms: Sequence[Term] = ()) -> LinearFit:
        """The fit without causes that are to be found, but with terms that are there anyway."""
        n = self.q.shape[1]
        return self._fitted(tuple(terms), np.ones(n), np.zeros(self.own.shape[2]), {})

    def refitted(
        self, terms: Sequence[Term], near: LinearFit, *, thorough: bool = False
    ) -> LinearFit:
        """The minimum with these terms that lies near another."""
        gains = np.ones(self.q.shape[1])
        free = [term.place for term in terms if term.shape is Shape.GAIN]
        gains[free] = near.gains[free]
        return self._fitted(tuple(terms), gains, near.unknowns, near.values)

    def others(
        self, extension: Extension, terms: Sequence[Term], count: int
    ) -> Sequence[LinearFit]:
        """The minimum near the one that is linear in inverse gains: all else is linear anyway."""
        free = [term.place for term in terms if term.shape is Shape.GAIN]
        if extension.kind is not Kind.GAIN or not free:
            return []
        beside = [term for term in terms if term.shape in ADDED]
        columns = cause_columns(beside, self.q, self.torque, self.directions, None)
        own = np.concatenate([self.own, columns], axis=2)
        unit = np.eye(self.q.shape[1])
        measured = -self.torque[:, :, None] * unit[:, free]
        target = self.torque.copy()
        target[:, free] = 0.0
        rows = (self.whitening @ np.concatenate([own, measured], axis=2)).reshape(target.size, -1)
        whitened = np.einsum("kij,kj->ki", self.whitening, target).ravel()
        size = np.linalg.norm(rows, axis=0)
        size[size == 0.0] = 1.0
        found = np.linalg.lstsq(rows / size, whitened, DEPENDENT)[0] / size
        inverse = found[-len(free) :]
        if not (np.abs(inverse) > LEAST_INVERSE).all():
            return []
        gains = np.ones(self.q.shape[1])
        gains[free] = 1.0 / inverse
        return [self._fitted(tuple(terms), gains, np.zeros(self.own.shape[2]), {})]

    def reweighted(self, fitted: LinearFit) -> Self:
        """The same with the noise that a fit leaves; itself where the noise is known."""
        if self.noise_known:
            return self
        model = self
        for _ in range(REWEIGHTINGS):
            if self.weights is not None:
                model = model._with_noise_of(fitted, self.weights)
                fitted = model.refitted(fitted.terms, fitted)
                continue
            # components of whitened errors, not joints: errors of angles are felt by all joints,
            # and combinations of torques in which they cancel would be weighed wrongly
            lever = np.sum(fitted.basis**2, axis=1).reshape(self.q.shape).sum(axis=0)
            spare = np.maximum(len(self.q) - lever, 0.5)
            squares = np.sum(fitted.residual.reshape(self.q.shape) ** 2, axis=0)
            level = np.maximum(np.sqrt(squares / spare), self.floor / model.noise)
            whitening = model.whitening / level[:, None]
            model = replace(model, whitening=whitening, noise=deviations(whitening))
            fitted = model.refitted(fitted.terms, fitted)
        return model

    def _with_noise_of(self, fitted: LinearFit, weights: Array) -> Self:
        """The same with the noise of torques, and of angles, that a fit leaves."""
        leverage = np.sum(fitted.basis**2, axis=1).reshape(self.q.shape)
        angle, leaning = 0.0, None
        if self.stiffness_of is None:
            levels = estimated_levels(fitted.rest, leverage, weights)
        else:
            levels, angle = noise_left(fitted.rest, leverage, weights, fitted.stiffness)
            leaning = angle * fitted.stiffness
        levels = np.maximum(levels, self.floor)
        whitening = whitening_of(levels, leaning, weights)
        return replace(self, whitening=whitening, noise=levels)

    def _fitted(
        self, terms: tuple[Term, ...], gains: Array, unknowns: Array, values: dict[Term, Array]
    ) -> LinearFit:
        free = [term.place for term in terms if term.shape is Shape.GAIN]
        curved = any(term.shape in (Shape.SCALE, Shape.COMPLIANCE) for term in terms)
        fit = LinearFit(
            self.directions,
            terms,
            {term: value for term, value in values.items() if term in terms},
            np.ones(len(gains)),
            np.inf,
            self.whitening,
            self,
            gains,
            unknowns,
        )
        for _ in range(PASSES if curved else 1):
            before = fit.cost
            fit = self._solved(fit, free)
            if abs(before - fit.cost) <= SETTLED * fit.cost:
                break
        return fit

    def _solved(self, fit: LinearFit, free: Sequence[int]) -> LinearFit:
        """Best unknowns and gains, columns that depend on unknowns taken from a fit."""
        if not free:
            return self._linear(fit)[0]

        @lru_cache(maxsize=2)
        def at(some: tuple[float, ...]) -> tuple[Array, Array]:
            gains = fit.gains.copy()
            gains[list(free)] = some
            found, left_of = self._linear(replace(fit, factors=gains), quick=True)
            slopes = found.whitening @ found.columns([Term(Shape.GAIN, j) for j in free])
            return found.residual, -left_of(slopes.reshape(self.q.size, -1))

        solution = least_squares(  # what is linear is eliminated (Kaufman's Jacobian)
            lambda some: at(tuple(some))[0],
            fit.gains[list(free)],
            lambda some: at(tuple(some))[1],
            method="lm",
            xtol=PROGRESS,
            ftol=PROGRESS,
        )
        gains = fit.gains.copy()
        gains[list(free)] = solution.x
        return self._linear(replace(fit, factors=gains))[0]

    def _linear(
        self, fit: LinearFit, *, quick: bool = False
    ) -> tuple[LinearFit, Callable[[Array], Array]]:
        """Best unknowns for given gains; and what of values they do not explain."""
        terms = [term for term in fit.terms if term.shape is not Shape.GAIN]
        span = self.span(fit.gains, quick=quick)
        target = np.einsum("kij,kj->ki", self.whitening, self.torque).ravel()
        columns = cause_columns(terms, self.q, self.torque, self.directions, fit.slopes)
        added = (self.whitening @ columns).reshape(target.size, -1)
        size = np.linalg.norm(added, axis=0)
        size[size == 0.0] = 1.0
        beyond = span.beyond(added / size)
        found = np.linalg.lstsq(beyond, span.beyond(target), DEPENDENT)[0] / size
        left = target - added @ found
        unknowns = span.unknowns(left)
        loads, values, first = self.own.shape[2], {}, 0
        for term in terms:
            values[term] = found[first : first + width(term, loads)]
            first += width(term, loads)
        cost = float(np.sum(span.beyond(left) ** 2))

        def left_of(some: Array) -> Array:
            rest = span.beyond(some)
            return np.asarray(rest - beyond @ np.linalg.lstsq(beyond, rest, DEPENDENT)[0])

        return replace(fit, values=values, unknowns=unknowns, cost=cost), left_of

    def span(self, gains: Array, *, quick: bool = False) -> Span:
        """What the unknowns can explain if joints have these gains; quick: to half the digits."""
        return self._plain_span if (gains == 1.0).all() else self._span(gains, quick)

    @cached_property
    def _plain_span(self) -> Span:
        return self._span(np.ones(self.q.shape[1]), False)

    def _span(self, gains: Array, quick: bool) -> Span:
        rows = (self.whitening @ (gains[:, None] * self.own)).reshape(self.q.size, -1)
        size = np.linalg.norm(rows, axis=0)
        size[size == 0.0] = 1.0
        rows = rows / size
        if quick:
            squares, right = np.linalg.eigh(rows.T @ rows)
            kept = squares > DEPENDENT * squares.max(initial=0.0)
            back = right[:, kept] / np.sqrt(squares[kept])
            return Span(rows @ back, back / size[:, None])
        left, values, transposed = np.linalg.svd(rows, full_matrices=False)
        kept = values > DEPENDENT * values.max(initial=0.0)
        return Span(left[:, kept], (transposed[kept].T / values[kept]) / size[:, None])


def deviations(whitening: Array) -> Array:
    """Standard deviation (n,) of errors that are whitened by (m, n, n), root mean square."""
    return np.asarray(np.sqrt(np.mean(np.linalg.inv(whitening) ** 2, axis=0).sum(axis=1)))


@dataclass(frozen=True, eq=False)
class Span:
    """Orthonormal basis of some columns.

    Attributes
    ----------
    basis : (N, r) array
    back : (p, r) array
        Smallest coefficients of the columns for one unit of each.
    """

    basis: Array
    back: Array

    def beyond(self, values: Array) -> Array:
        """What the columns do not explain of values (N, ...)."""
        rest = values - self.basis @ (self.basis.T @ values)
        return np.asarray(rest - self.basis @ (self.basis.T @ rest))

    def unknowns(self, target: Array) -> Array:
        """Coefficients (p,) of what the columns explain of a target (N,)."""
        return np.asarray(self.back @ (self.basis.T @ target))


@dataclass(frozen=True, eq=False)
class LinearFit(ExtendedFit):
    """A linear model with causes, fitted.

    Attributes
    ----------
    model : LinearModel
    factors : (n,) array
        Measured over true torques.
    unknowns : (p,) array
        Of the model.
    """

    model: LinearModel
    factors: Array
    unknowns: Array

    @property
    def q(self) -> Array:
        """Configurations (m, n) [rad]."""
        return self.model.q

    @property
    def torque(self) -> Array:
        """Torques (m, n) [N m]."""
        return self.model.torque

    @property
    def gains(self) -> Array:
        """Measured over true torques, (n,)."""
        return self.factors

    @cached_property
    def slopes(self) -> Slopes:
        """Torques with what errors of angles make of them, and their derivatives."""
        model, n = self.model, len(self.factors)
        own = self.factors[:, None] * model.own
        plain = model.own @ self.unknowns
        stiffness = np.zeros((*plain.shape, n))
        if model.stiffness_of is not None:
            stiffness = self.factors[:, None] * model.stiffness_of(self.unknowns)
        slopes = Slopes(own @ self.unknowns, own, plain, stiffness, own)
        torque = slopes.torque
        for term in self.values:
            if term.shape in (Shape.SCALE, Shape.COMPLIANCE):
                columns = cause_columns([term], self.q, self.torque, None, slopes)
                torque = torque + columns @ self.values[term]
        return replace(slopes, torque=torque)

    @cached_property
    def basis(self) -> Array:
        """Orthonormal basis (m n, rank) of what the unknowns can explain, whitened."""
        span = self.model.span(self.factors)
        columns = (self.whitening @ self.columns(self.terms)).reshape(self.torque.size, -1)
        size = np.linalg.norm(columns, axis=0)
        beyond = span.beyond(columns[:, size > 0.0] / size[size > 0.0])
        left, values, _ = np.linalg.svd(beyond, full_matrices=False)
        return np.concatenate([span.basis, left[:, values > COLUMNS_KEPT]], axis=1)
