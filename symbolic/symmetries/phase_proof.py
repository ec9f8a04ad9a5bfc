"""Exact proof that the offset congruences of a symmetry have a solution."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import acb, arb, ctx, fmpq, fmpq_mat, fmpz_mat
from numpy.typing import NDArray

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.coefficients import is_expression, is_zero
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

if TYPE_CHECKING:
    from isotorque.symbolic.symmetries.frequency_support import FrequencySupport

Gauss = tuple[Any, Any]
UNITS = ((1, 0), (0, 1), (-1, 0), (0, -1))
PRECISION_BITS = 128


class PhaseProof:
    """Proofs for one potential with exact rational or SymPy coefficients.

    Notes
    -----
    For (Y, s) put u_k = s_k C_{s_k Y k} / C_k. An exact offset d with exp(i k.d) = u_k for all k
    exists iff every |u_k| = 1 and u respects every integer relation between the frequencies. The
    second is checked on a basis h_j of the lattice they generate: with w_j = u(h_j), computed
    from the few frequencies that generate it, u_k must equal the product of w_j^(c_kj), where
    c_k are the coordinates of k. Everything is arithmetic in Q(i), nothing is rounded.

    Nothing is proved where ``complete`` says that terms were left out (amplitude below 1e-12 of
    the largest), in the support or in that of other joints.
    """

    def __init__(
        self, potential: TrigonometricPolynomial, support: FrequencySupport, complete: bool
    ) -> None:
        self.support, self.complete = support, complete
        index = {k.tobytes(): i for i, k in enumerate(np.ascontiguousarray(potential.frequencies))}
        place = [index[k.tobytes()] for k in np.ascontiguousarray(support.K)]
        # C_k up to the factor 1/2, which cancels
        self.C: list[Gauss] = [(potential.cos[i], -potential.sin[i]) for i in place]
        self.symbolic = potential.is_symbolic
        self.exponents = support.lattice.coordinates(support.coordinates)

    def holds(self, Y: NDArray[np.int64], s: NDArray[np.int64], d_sat: NDArray[np.float64]) -> bool:
        """Say whether an exact offset exists that rounds to ``d_sat``."""
        if not self.complete:
            return False
        targets, ratio = self._targets(Y, s)
        quarter = np.round(np.angle(ratio) / (np.pi / 2)).astype(np.int64) % 4
        units = all(
            _equal(t, _times(UNITS[p], c))
            for t, p, c in zip(targets, quarter.tolist(), self.C, strict=True)
        )
        lattice = self.support.lattice
        if units:  # all u_k are powers of i: the relations are congruences modulo 4
            w = lattice.T @ quarter[list(lattice.rows)]
            if np.any((self.exponents @ w - quarter) % 4):
                return False
        elif self.symbolic or not self._products_agree(targets):
            return False
        # the exact offsets are those of one coset each: the float d_sat must be one of them
        misfit = np.angle(np.exp(1j * (self.support.coordinates @ d_sat)) / ratio)
        return bool(np.all(np.abs(misfit) < 1e-9))

    def rounded(
        self, relation: SymmetryRelation, Y: NDArray[np.int64], s: NDArray[np.int64]
    ) -> SymmetryRelation:
        """Return a proved relation with each offset the float nearest to its exact value.

        The exact offset near ``relation.d`` is computed in ball arithmetic. In the coordinates
        y = B q it is unique: ``H d_sat = T phases + 2 pi z`` with the integers z that fit.
        """
        if self.symbolic or not len(self.support.B):
            return relation
        lattice = self.support.lattice
        targets, _ = self._targets(Y, s, lattice.rows)
        with ctx.workprec(PRECISION_BITS):
            turn = 2 * arb.pi()
            phases = []
            for i, target in zip(lattice.rows, targets, strict=True):
                x, y = _times(target, (self.C[i][0], -self.C[i][1]))
                phases.append(acb(arb(x), arb(y)).arg())
            near = lattice.H @ relation.d_sat
            theta = []
            for row, there in zip(lattice.T.tolist(), near.tolist(), strict=True):
                angle = sum((c * p for c, p in zip(row, phases, strict=True) if c), arb(0))
                theta.append(angle + turn * round((there - float(angle.mid())) / float(turn.mid())))
            exact = [
                sum((arb(c) * x for c, x in zip(row, theta, strict=True)), arb(0))
                for row in self._lift
            ]
            d = []
            for old, new in zip(relation.d.tolist(), exact, strict=True):
                turns = round((old - float(new.mid())) / float(turn.mid()))
                d.append(float((new + turn * turns).mid()))
        return SymmetryRelation(
            relation.A, d, relation.Y, relation.basis, relation.exact, relation.bound
        )

    @cached_property
    def _lift(self) -> list[list[fmpq]]:
        """The rational matrix (n, r) from T phases + 2 pi z to d, identity on the rest."""
        V, H = self.support.V, self.support.lattice.H
        from_y = fmpq_mat(fmpz_mat(V.tolist())).inv().tolist()
        to_y = fmpq_mat(fmpz_mat(H.tolist())).inv()
        r = len(H)
        return (fmpq_mat([row[:r] for row in from_y]) * to_y).tolist()

    def _targets(
        self, Y: NDArray[np.int64], s: NDArray[np.int64], rows: Sequence[int] | None = None
    ) -> tuple[list[Gauss], NDArray[np.complex128]]:
        """Return s_k C_{s_k Y k} exactly (up to a factor), and u_k in floats; all k by default."""
        chosen = np.arange(len(s)) if rows is None else np.array(rows, dtype=np.int64)
        position, image = self.support.image(Y, s)
        position, image, s = position[chosen], image[chosen], s[chosen]
        # image[i] is C_j or its conjugate: recover which from the frequencies
        K = self.support.K
        conjugate = np.any(K[position] != s[:, None] * Y * K[chosen], axis=1)
        targets = [
            (x if sign > 0 else -x, y if (sign > 0) != turned else -y)
            for (x, y), sign, turned in zip(
                (self.C[j] for j in position.tolist()), s.tolist(), conjugate.tolist(), strict=True
            )
        ]
        return targets, image * s / self.support.C[chosen]

    def _products_agree(self, targets: list[Gauss]) -> bool:
        u = [_divide(t, c) for t, c in zip(targets, self.C, strict=True)]
        if any(x * x + y * y != 1 for x, y in u):
            return False
        lattice = self.support.lattice
        generators = [u[i] for i in lattice.rows]
        w = [_product(generators, row) for row in lattice.T.tolist()]
        return all(_product(w, row) == v for row, v in zip(self.exponents.tolist(), u, strict=True))


def _times(a: Gauss, b: Gauss) -> Gauss:
    return (a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0])


def _divide(a: Gauss, b: Gauss) -> Gauss:
    size = b[0] * b[0] + b[1] * b[1]
    real, imaginary = _times(a, (b[0], -b[1]))
    return (real / size, imaginary / size)


def _product(factors: list[Gauss], exponents: list[int]) -> Gauss:
    """Return the product of unit Gaussian rationals to integer powers (inverse = conjugate)."""
    total: Gauss = (fmpq(1), fmpq(0))
    for (x, y), exponent in zip(factors, exponents, strict=True):
        base = (x, y) if exponent >= 0 else (x, -y)
        for _ in range(abs(exponent)):
            total = _times(total, base)
    return total


def _equal(a: Gauss, b: Gauss) -> bool:
    if is_expression(a[0]) or is_expression(b[0]):
        return is_zero(a[0] - b[0]) and is_zero(a[1] - b[1])
    return bool(a[0] == b[0] and a[1] == b[1])
