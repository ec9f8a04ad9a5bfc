"""What measured torques contain beside the gravity of a model that is linear in its unknowns."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.cause import Cause, causes_of
from isotorque.learning.statistics.causes.extended_fit import cause_columns
from isotorque.learning.statistics.causes.extension import ADDED, Kind, Shape, Term
from isotorque.learning.statistics.causes.linear_model import KINDS, LinearModel
from isotorque.learning.statistics.causes.selection import selected
from isotorque.learning.statistics.noise_levels import whitening_of

Array = NDArray[np.float64]

HELD = (Shape.CONSTANT, Shape.ANGLE, Shape.COSINE, Shape.SINE)
"""Shapes that a static torque has; friction depends on where the arm came from."""
FITTED = (*ADDED, Shape.GAIN, Shape.LOAD)
"""Shapes that are fitted with the model; errors of angles are named only."""
SPARE = 3
"""Degrees of freedom that must be left per joint, to look for causes."""
MOST_POSES = 500
"""Causes are looked for in no more poses, evenly taken."""


@dataclass(frozen=True, eq=False)
class BesideGravity:
    """Gains, and torques that add to gravity, with the causes that they stand for.

    Attributes
    ----------
    gains : (n,) array
        Measured over true torques.
    coefficients : (n, 4) array
        Of 1, angle, cosine and sine of twice the angle at every joint [N m].
    friction : (n,) array
        Torque against the direction of the last motion [N m]: no static torque.
    causes : tuple of Cause
        What the samples show, in the order in which it was named; not all of it is held here.
    """

    gains: Array
    coefficients: Array
    friction: Array
    causes: tuple[Cause, ...] = ()

    @classmethod
    def nothing(cls, joints: int, causes: tuple[Cause, ...] = ()) -> BesideGravity:
        """Gravity alone."""
        zeros = np.zeros(joints)
        return cls(np.ones(joints), np.zeros((joints, len(HELD))), zeros, causes)

    @property
    def any(self) -> bool:
        """Whether there is more than gravity in a static torque."""
        return bool((self.gains != 1.0).any() or self.coefficients.any())

    def added(self, q: Array) -> Array:
        """Torques (m, n) [N m] that add to gravity at configurations (m, n) [rad].

        Examples
        --------
        >>> spring = BesideGravity(np.ones(1), np.array([[0.5, 2.0, 0.0, 0.0]]), np.zeros(1))
        >>> spring.added(np.array([[0.25]])).tolist()
        [[1.0]]
        """
        constant, angle, cosine, sine = self.coefficients.T
        return np.asarray(constant + angle * q + cosine * np.cos(2 * q) + sine * np.sin(2 * q))

    def to_arrays(self) -> dict[str, NDArray]:
        """Numbers, for a saved model."""
        return {"gains": self.gains, "beside": self.coefficients, "friction": self.friction}

    @classmethod
    def from_saved(
        cls, arrays: Mapping[str, NDArray], state: Mapping[str, Any], joints: int
    ) -> BesideGravity:
        """What `to_arrays` and the causes of a saved model hold; of older ones constants alone."""
        found = cls.nothing(joints)
        coefficients = found.coefficients.copy()
        coefficients[:, 0] = arrays.get("offsets", np.zeros(joints))
        return cls(
            arrays.get("gains", found.gains),
            arrays.get("beside", coefficients),
            arrays.get("friction", found.friction),
            tuple(Cause.from_json(cause) for cause in state.get("causes", ())),
        )


@dataclass(frozen=True, eq=False)
class ShownBeside:
    """Causes that samples show beside a linear model, and how the samples are to be weighed.

    Attributes
    ----------
    terms : tuple of Term
        What is to be fitted with the model: what adds to the torque, gains and loads.
    gains : (n,) array
    unknowns : (p,) array
        Of the model, as they were found.
    whitening : (m, n, n) array
        Of the errors at all samples, of size about 1.
    levels : (n,) array
        Noise of every joint in the same unit.
    causes : tuple of Cause
    """

    terms: tuple[Term, ...]
    gains: Array
    unknowns: Array
    whitening: Array
    levels: Array
    causes: tuple[Cause, ...]

    def columns(self, q: Array, own: Array, directions: Array | None) -> Array:
        """Derivatives (m, n, k) of measured torques by the unknowns of the terms."""
        plain = [term for term in self.terms if term.shape in ADDED]
        parts = [cause_columns(plain, q, q, directions, None)]
        torque = own @ self.unknowns
        for term in self.terms:
            if term.shape is Shape.GAIN:
                column = np.zeros((*q.shape, 1))
                column[:, term.place, 0] = torque[:, term.place]
                parts.append(column)
        for term in self.terms:
            if term.shape is Shape.LOAD:
                parts.append(np.where(np.arange(len(q))[:, None, None] < term.place, 0.0, own))
        return np.concatenate(parts, axis=2)

    def beside(self, values: Array) -> BesideGravity:
        """What is beside gravity, from the unknowns of `columns`; changes of gains among them."""
        n = len(self.gains)
        found = BesideGravity.nothing(n)
        gains, coefficients, friction = self.gains.copy(), found.coefficients, found.friction
        ordered = [t for t in self.terms if t.shape in ADDED]
        ordered += [t for t in self.terms if t.shape is Shape.GAIN]
        for term, value in zip(ordered, values, strict=False):
            if term.shape is Shape.GAIN:
                gains[term.place] += value
            elif term.shape is Shape.DIRECTION:
                friction[term.place] = value
            else:
                coefficients[term.place, HELD.index(term.shape)] = value
        return BesideGravity(gains, coefficients, friction, self.causes)


def shown_beside(
    q: Array,
    torque: Array,
    own: Array,
    weights: Array,
    *,
    directions: Array | None = None,
    kinds: tuple[Kind, ...] = KINDS,
    stiffness_of: Callable[[Array, NDArray[np.intp]], Array] | None = None,
) -> ShownBeside:
    """Decide which causes samples show beside a linear model.

    Parameters
    ----------
    q, torque : (m, n) arrays
        One sample per pose [rad], [N m].
    own : (m, n, p) array
        Derivatives of the torques by the unknowns of the model.
    weights : (m,) array
        Of the squared errors, >= 0.
    directions : (m, n) array, optional
        Signs of the last motion of every joint.
    kinds : tuple of Kind
        What is looked for.
    stiffness_of : callable, optional
        ``f(x, rows)``: derivatives (k, n, n) of the torques by the angles at some samples, for
        unknowns x (p,). With it noise of the angles is told from causes.

    Notes
    -----
    See `selected` for the decision. Nothing is looked for with fewer than `SPARE` degrees of
    freedom per joint.
    """
    n = q.shape[1]
    used = np.flatnonzero(weights > 0.0)
    taken = used
    if len(used) > MOST_POSES:
        taken = used[np.linspace(0, len(used) - 1, MOST_POSES).round().astype(int)]
    columns = own[taken].reshape(len(taken) * n, own.shape[2])
    rank = int(np.linalg.matrix_rank(columns)) if columns.size else 0
    whitening = whitening_of(np.ones(n), None, weights)
    if len(taken) * n < rank + SPARE * n or not torque[taken].any():
        return ShownBeside((), np.ones(n), np.zeros(own.shape[2]), whitening, np.ones(n), ())
    model = LinearModel.of(
        q[taken],
        torque[taken],
        own[taken],
        weight=weights[taken],
        directions=None if directions is None else directions[taken],
        kinds=kinds,
        stiffness_of=None if stiffness_of is None else lambda x: stiffness_of(x, taken),
    )
    selection = selected(model, model.alone())
    fit = selection.fit
    terms = tuple(_placed(term, taken) for term in fit.terms if term.shape in FITTED)
    if len(taken) == len(used):
        whitening[used] = fit.whitening
    else:
        whitening = whitening_of(selection.model.noise, None, weights)
    size = np.sqrt(np.mean(np.einsum("kii->ki", whitening[used]) ** 2))
    levels = selection.model.noise * size
    causes = causes_of(selection)
    return ShownBeside(terms, fit.gains, fit.unknowns, whitening / size, levels, causes)


def _placed(term: Term, taken: NDArray[np.intp]) -> Term:
    """A term of some of the samples; of a load the first sample is another one of all."""
    return Term(term.shape, int(taken[term.place])) if term.shape is Shape.LOAD else term
