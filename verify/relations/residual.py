"""The torque error of a claimed relation, expanded into waves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import acb, arb, ctx, fmpq
from numpy.typing import NDArray

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.relations.exact_numbers import (
    PRECISION_BITS,
    Exact,
    angle,
    exact,
    exact_vector,
    nearest,
    over_one_denominator,
    phase,
    times,
    upper,
)

Array = NDArray[np.float64]

SLOW = 2**20
"""Frequencies up to this are multiplied in floats; the phases of faster waves are reduced exactly
modulo a turn, because a float product is all rounding there."""


@dataclass(frozen=True, eq=False)
class Residual:
    """The function q -> g(A q + d) - Y g(q), as sum of cos cos(f.q) + sin sin(f.q).

    Attributes
    ----------
    waves : list of tuples
        Each f once, as integers over one ``divisor``.
    divisor : int
        1 unless ``A^T k`` is none of integers.
    cos, sin : lists of lists of arb
        Amplitudes of joint i for frequency number j, ``cos[j][i]`` [N m].

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> flip = Residual.of([[-1, 0], [2, 1]], exact_vector([0, 1e-6]), [1, 1], U)
    >>> flip.bound().round(8)
    array([6.1e-06, 6.1e-06])
    """

    n: int
    waves: list[tuple[int, ...]]
    divisor: int
    cos: list[list[arb]]
    sin: list[list[arb]]

    @classmethod
    def of(
        cls,
        A: list[list[Exact]],
        d: list[Exact],
        Y: list[int],
        potential: TrigonometricPolynomial,
    ) -> Residual:
        """Expand the error of a relation under an exact potential."""
        waves: dict[tuple[int, ...], list[list[arb]]] = {}
        rows = potential.frequencies.tolist()
        whole, divisor = over_one_denominator(A)
        with ctx.workprec(PRECISION_BITS):
            offsets = [angle(x) for x in d]
            for k, image, a, b in zip(
                rows, times(rows, whole), potential.cos, potential.sin, strict=True
            ):
                at = phase(k, offsets)
                c, s, a, b = at.cos(), at.sin(), arb(a), arb(b)
                _add(waves, image, b * c - a * s, -(a * c + b * s), k)
                here = tuple(divisor * x for x in k)
                _add(waves, here, b, -a, [-y * x for x, y in zip(k, Y, strict=True)])
        cos = [[x[0] for x in joints] for joints in waves.values()]
        sin = [[x[1] for x in joints] for joints in waves.values()]
        return cls(potential.n, list(waves), divisor, cos, sin)

    @cached_property
    def frequencies(self) -> list[tuple[Exact, ...]]:
        """Each f once, exactly: integers or rationals."""
        if self.divisor == 1:
            return list(self.waves)
        return [tuple(exact(fmpq(x, self.divisor)) for x in f) for f in self.waves]

    def bound(self) -> Array:
        """Return upper bounds (n,) on the error of each joint [N m], for every q."""
        with ctx.workprec(PRECISION_BITS):
            total = [arb(0)] * self.n
            for cos, sin in zip(self.cos, self.sin, strict=True):
                for i, (c, s) in enumerate(zip(cos, sin, strict=True)):
                    total[i] = total[i] + abs(acb(c, s))
            return np.array([upper(x) for x in total])

    # -- values in floats, to search with -------------------------------------------------------

    @cached_property
    def is_slow(self) -> bool:
        """Whether float products f.q tell the phases: no wave is very fast."""
        return all(abs(x) <= SLOW * self.divisor for f in self.waves for x in f)

    @cached_property
    def _floats(self) -> tuple[Array, Array, Array]:
        shape = (len(self.waves), self.n)
        rows = (
            [[x / self.divisor for x in f] for f in self.waves] if self.is_slow else np.zeros(shape)
        )
        cos, sin = (
            np.array([[nearest(x) for x in joints] for joints in part]).reshape(shape)
            for part in (self.cos, self.sin)
        )
        return np.array(rows).reshape(shape), cos, sin

    def values(self, q: Array) -> Array:
        """Return the errors (m, n) at configurations (m, n), as floats tell them [N m]."""
        return self.at_phases(self.phases(q))

    def at_phases(self, phases: Array) -> Array:
        """Return the errors (m, n) where the waves have phases (m, waves) [rad]."""
        _, cos, sin = self._floats
        return np.asarray(np.cos(phases) @ cos + np.sin(phases) @ sin)

    def gradient(self, q: Array, joint: int) -> Array:
        """Return the gradient (n,) of the error of one joint at one configuration [N m/rad]."""
        k, cos, sin = self._floats
        phases = k @ q
        return np.asarray((np.cos(phases) * sin[:, joint] - np.sin(phases) * cos[:, joint]) @ k)

    def phases(self, q: Array) -> Array:
        """Return the phases (m, waves) at configurations (m, n), of fast waves modulo 2 pi."""
        if self.is_slow:
            return np.asarray(q @ self._floats[0].T)
        points = [exact_vector(point) for point in q]
        columns = [list(column) for column in zip(*self.frequencies, strict=True)]
        return np.array([[nearest(angle(x)) for x in row] for row in times(points, columns)])


def _add(
    waves: dict[tuple[int, ...], list[list[arb]]],
    frequency: tuple[int, ...],
    cos: arb,
    sin: arb,
    weights: list[int],
) -> None:
    """Add weight_i * (cos cos(f.q) + sin sin(f.q)) to the error of every joint i."""
    leading = next((x for x in frequency if x), 0)
    if leading < 0:
        frequency, sin = tuple(-x for x in frequency), -sin
    if not leading:
        sin = arb(0)
    joints = waves.setdefault(frequency, [[arb(0), arb(0)] for _ in weights])
    for joint, weight in zip(joints, weights, strict=True):
        if weight:
            joint[0] = joint[0] + weight * cos
            joint[1] = joint[1] + weight * sin
