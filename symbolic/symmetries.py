"""The complete group of primary symmetries of a gravity potential."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from symbolic.errors import InputError
from symbolic.integer_lattice import (
    GeneratedLattice,
    dependency_components,
    generate_lattice,
    saturation,
)
from symbolic.phase_proof import PhaseProof
from symbolic.relations import SymmetryGroup, SymmetryRelation, wrap
from symbolic.residuals import residual_bound
from symbolic.trigonometric import TrigonometricPolynomial

Array = NDArray[np.float64]

RELATIVE = 1e-12
"""Float coefficients closer than this, relative to the largest, count as equal at tolerance 0."""


def primary_symmetries(potential: TrigonometricPolynomial, tolerance: float = 0.0) -> SymmetryGroup:
    """Return all affine maps q -> A q + d with g(A q + d) = Y g(q), Y = diag(+-1), g = grad U.

    Parameters
    ----------
    potential
        Gravity potential U [J] (or a fitted one), with float, exact or SymPy coefficients.
    tolerance
        0 for the symmetries of U itself. A positive tolerance [N m] gives the largest
        eps-symmetry group: the exact group of a nearby symmetric potential, every relation of
        which errs by at most ``tolerance`` in any torque, proved. See
        :func:`symbolic.approximate_symmetries.maximal_groups` for all maximal ones.

    Returns
    -------
    SymmetryGroup
        Its ``order`` counts relations modulo free directions and 2 pi. ``exact`` relations are
        proved over the rationals (bound 0); the others carry a proved bound [N m].

    Raises
    ------
    InputError
        If the tolerance is negative or not a number.

    Notes
    -----
    (A, d, Y) is such a map iff there are signs s_k with A^T k = s_k Y k and
    C_{s_k Y k} = s_k C_k exp(i k.d) for every frequency k of U. The signs are constant on the
    connected components of the linear matroid of the frequencies; Y must map the support to
    itself; d solves congruences on a basis of the lattice of frequencies. Nothing is searched
    numerically, so the list is complete.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> group = primary_symmetries(U)
    >>> group.order
    8
    >>> print(max(float(r.bound.max()) for r in group) < 1e-13)
    True
    """
    if not (np.isfinite(tolerance) and tolerance >= 0):
        raise InputError("symmetries", "tolerance", tolerance, "a number >= 0 [N m]")
    if tolerance > 0:
        from symbolic.approximate_symmetries import maximal_groups

        return maximal_groups(potential, tolerance)[0]
    numeric = specialised(potential)
    amplitude = numeric.amplitudes()
    support = Support.of(numeric, amplitude > RELATIVE * amplitude.max(initial=0.0))
    limit = RELATIVE * float(amplitude.max(initial=0.0))
    proof = PhaseProof(potential, support) if potential.cos.dtype == object else None
    relations = []
    for Y, s in support.structures(amplitude_classes(support.amplitude, limit)):
        for d_sat in support.offsets(Y, s, 16 * limit):
            trivial = np.all(Y == 1) and np.all(s == 1) and not np.any(d_sat)
            exact = bool(trivial) or (proof is not None and proof.holds(Y, s, d_sat))
            relations.append(support.relation(numeric, Y, s, d_sat, exact))
    return SymmetryGroup(relations)


def specialised(potential: TrigonometricPolynomial) -> TrigonometricPolynomial:
    """Return the potential with float coefficients; free symbols get generic values.

    A symmetry for all values of the symbols is one for generic values, so no symmetry is lost;
    what holds for all values is checked again, symbolically, by the proof.
    """
    if not potential.is_symbolic:
        return potential.to_float()
    symbols = sorted(
        {x for c in (*potential.cos, *potential.sin) for x in sympy.sympify(c).free_symbols},
        key=str,
    )
    generic = np.random.default_rng(20180601).uniform(0.5, 1.5, len(symbols))
    values = dict(zip(symbols, (sympy.Float(x) for x in generic), strict=True))
    return TrigonometricPolynomial(
        potential.frequencies,
        np.array([float(sympy.sympify(x).subs(values)) for x in potential.cos]),
        np.array([float(sympy.sympify(x).subs(values)) for x in potential.sin]),
        potential.names,
    )


def amplitude_classes(amplitude: Array, tolerance: float) -> NDArray[np.int64]:
    """Label amplitudes so that values connected by steps of at most ``tolerance`` share a label."""
    order = np.argsort(amplitude, kind="stable")
    steps = np.diff(amplitude[order], prepend=amplitude[order][:1]) > tolerance
    label = np.empty(len(amplitude), dtype=np.int64)
    label[order] = np.cumsum(steps)
    return label


@dataclass(frozen=True, eq=False)
class Support:
    """The frequencies that decide about symmetries, with what the theorem needs to know of them.

    Attributes
    ----------
    K : (m, n) int array
        Frequencies, one of each pair +-k.
    C : (m,) complex array
        Coefficients C_k = (cos_k - i sin_k) / 2.
    B, V : (r, n), (n, n) int arrays
        Basis of L_sat = span K intersected with Z^n, and its invertible completion.
    coordinates : (m, r) int array
        K = coordinates B.
    lattice : GeneratedLattice
        The lattice L generated by K, in those coordinates.
    components : (m,) int array
        Labels of the connected components of the linear matroid of K.
    """

    K: NDArray[np.int64]
    C: NDArray[np.complex128]
    B: NDArray[np.int64]
    V: NDArray[np.int64]
    coordinates: NDArray[np.int64]
    lattice: GeneratedLattice
    components: NDArray[np.int64]

    @classmethod
    def of(cls, potential: TrigonometricPolynomial, keep: NDArray[np.bool_]) -> Support:
        """Collect the terms of ``potential`` selected by ``keep`` (constants never count)."""
        keep = keep & np.any(potential.frequencies, axis=1)
        K, C = potential.frequencies[keep], potential.complex()[keep]
        B, V = saturation(K)
        coordinates = np.round(K @ np.linalg.inv(V.astype(float))).astype(np.int64)[:, : len(B)]
        return cls(K, C, B, V, coordinates, generate_lattice(coordinates), dependency_components(K))

    @property
    def amplitude(self) -> Array:
        """|C_k|, shape (m,)."""
        return np.abs(self.C)

    # -- the signs ------------------------------------------------------------------------------

    def structures(
        self, classes: NDArray[np.int64]
    ) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Yield all (Y, s): torque signs and frequency signs for which A exists.

        ``classes`` labels frequencies that may be mapped to each other (equal |C_k|).
        """
        count = int(self.components.max(initial=-1)) + 1
        patterns = 1 - 2 * ((np.arange(2**count)[:, None] >> np.arange(count)) & 1)
        for Y in self._torque_signs(classes):
            for pattern in patterns:
                yield Y, pattern[self.components]

    def _torque_signs(self, classes: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """Find all Y that map the support to itself within the classes, joint by joint."""
        n = self.K.shape[1]
        both = np.concatenate([self.K, -self.K])
        label = np.concatenate([classes, classes])
        base = 2 * int(np.abs(both).max(initial=0)) + 1
        found: list[NDArray[np.int64]] = []
        ones = np.ones(n, dtype=np.int64)

        def extend(Y: NDArray[np.int64], own: NDArray, image: NDArray, joint: int) -> None:
            if joint == n:
                found.append(Y)
                return
            column = both[:, joint]
            for sign in (1, -1) if np.any(column) else (1,):
                # number the pairs (prefix, label) of both sides alike, compare the multisets
                pair = np.concatenate([own * base + column, image * base + sign * column])
                number = np.unique(pair, return_inverse=True)[1].astype(np.int64)
                left, right = number[: len(both)], number[len(both) :]
                if np.array_equal(np.sort(left), np.sort(right)):
                    signs = Y.copy()
                    signs[joint] = sign
                    extend(signs, left, right, joint + 1)

        extend(ones, label, label, 0)
        return found

    def image(
        self, Y: NDArray[np.int64], s: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.complex128]]:
        """Return for each k the position of +-Y k, and the coefficient C_{s_k Y k}."""
        index = {k.tobytes(): i for i, k in enumerate(np.ascontiguousarray(self.K))}
        target = np.ascontiguousarray(self.K * Y)
        position = np.empty(len(target), dtype=np.int64)
        mirrored = np.zeros(len(target), dtype=bool)
        for i, k in enumerate(target):
            place = index.get(k.tobytes())
            if place is None:
                place, mirrored[i] = index[(-k).tobytes()], True
            position[i] = place
        value = self.C[position]
        return position, np.where(mirrored ^ (s < 0), np.conj(value), value)

    # -- offsets and relations ------------------------------------------------------------------

    def offsets(
        self, Y: NDArray[np.int64], s: NDArray[np.int64], tolerance: float
    ) -> Iterator[Array]:
        """Yield all offsets d_sat with |C_{s_k Y k} - s_k C_k exp(i k.d)| <= tolerance."""
        _, image = self.image(Y, s)
        if np.any(np.abs(np.abs(image) - self.amplitude) > tolerance):
            return
        phase = np.angle(image * s / self.C)
        lattice = self.lattice
        theta = lattice.T @ phase[list(lattice.rows)]
        inverse = np.linalg.inv(lattice.H.astype(float)) if len(self.B) else np.zeros((0, 0))
        for z in lattice.cosets():
            d_sat = wrap(inverse @ (wrap(theta) + 2 * np.pi * z))
            residual = np.abs(image - s * self.C * np.exp(1j * (self.coordinates @ d_sat)))
            if np.all(residual <= tolerance):
                yield d_sat

    def linear_part(self, Y: NDArray[np.int64], s: NDArray[np.int64]) -> Array:
        """Return A_sat (r, r) with k A = s_k k Y for every frequency k (as a row)."""
        r = len(self.B)
        rows = list(self.lattice.rows)[:r]
        inverse = np.linalg.inv(self.V.astype(float))
        target = (s[rows, None] * self.K[rows] * Y) @ inverse[:, :r]
        if not r:
            return np.zeros((0, 0))
        return _cleaned(np.linalg.solve(self.coordinates[rows].astype(float), target))

    def lift(self, A_sat: Array, d_sat: Array) -> tuple[Array, Array]:
        """Return (A, d) in q: the map of y = B q, and identity on the completing coordinates."""
        n, r = self.K.shape[1], len(self.B)
        V = self.V.astype(float)
        block = np.eye(n)
        block[:r, :r] = A_sat
        inverse = np.round(np.linalg.inv(V))
        A = inverse @ block @ V
        d = inverse[:, :r] @ d_sat
        return _cleaned(A), wrap(d)

    def relation(
        self,
        potential: TrigonometricPolynomial,
        Y: NDArray[np.int64],
        s: NDArray[np.int64],
        d_sat: Array,
        exact: bool,
    ) -> SymmetryRelation:
        """Return the relation in q, with bound 0 where ``exact``, else a computed bound."""
        A, d = self.lift(self.linear_part(Y, s), d_sat)
        n = self.K.shape[1]
        bound = np.zeros(n) if exact else residual_bound(potential, A, d, Y)
        return SymmetryRelation(A, d, Y, self.B, exact, bound)


def _cleaned(matrix: Array) -> Array:
    """Return a matrix with whole numbers for entries that only rounding keeps from them."""
    whole = np.round(matrix)
    return np.where(np.abs(matrix - whole) < 1e-9, whole, matrix) + 0.0
