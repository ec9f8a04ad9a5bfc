"""Symmetry relation: q -> A q + d with torque signs Y."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.correction import Correction

Array = NDArray[np.float64]

SAME_ANGLE = 1e-6
"""Offsets that differ by less [rad] belong to one relation; distinct ones are far apart."""


@dataclass(frozen=True, eq=False)
class SymmetryRelation:
    """A map q -> A q + d under which the static torque only changes signs: g(A q + d) = Y g(q).

    Parameters
    ----------
    A : (n, n) array
        Linear part; integer for exact relations.
    d : (n,) array
        Offset [rad], written in (-pi, pi].
    Y : (n,) array
        Signs +1 or -1 of the torques.
    basis : (r, n) int array, optional
        Rows B such that the torque depends on q only through y = B q (docs/theory.md);
        the identity by default. ``A`` must map y to y: B A = A_sat B.
    exact : bool
        Whether the relation is proved (with an exact d of which ``d`` is the rounding).
    bound : (n,) array, optional
        Bound on |g_i(A q + d) - Y_i g_i(q)| over all q [N m]; NaN where none is known.
    correction : Correction, optional
        What the measured torque has beside gravity: the relation is then one of the measured
        torque, ``tau' - c(q') = Y (tau - c(q))``, and so is its bound.

    Attributes
    ----------
    unwrapped_d : (n,) array
        The offset as it was given [rad]: what a judge of the relation as written has to judge.

    Notes
    -----
    The paper's form (Eq. 5) is ``M q_r + N q_s = rhs`` with ``M = -A_sat B``, ``N = B`` and
    ``rhs = d_sat`` (r rows, modulo 2 pi); at full rank ``-A q_r + q_s = d``.

    Examples
    --------
    >>> flip = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    >>> flip.configuration([0.25, 0.5])
    array([-0.25,  1.  ])
    >>> (flip @ flip).is_identity
    True
    """

    A: Array
    d: Array
    Y: Array
    basis: NDArray[np.int64]
    exact: bool
    bound: Array
    unwrapped_d: Array
    correction: Correction | None

    def __init__(
        self,
        A: ArrayLike,
        d: ArrayLike,
        Y: ArrayLike,
        basis: ArrayLike | None = None,
        exact: bool = False,
        bound: ArrayLike | None = None,
        correction: Correction | None = None,
    ) -> None:
        matrix = np.array(A, dtype=float)
        if np.any(np.abs(matrix) > 2.0**53) and not np.array_equal(matrix, np.array(A, object)):
            raise InputError("relation", "A", A, "numbers that floats hold exactly")
        if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
            raise InputError("relation", "shape of A", matrix.shape, "(n, n)")
        n = len(matrix)
        offset, signs = np.array(d, dtype=float), np.array(Y, dtype=float)
        for name, vector in (("d", offset), ("Y", signs)):
            if vector.shape != (n,):
                raise InputError("relation", f"shape of {name}", vector.shape, f"({n},)")
        if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(offset))):
            raise InputError("relation", "A or d", "not finite", "finite numbers")
        if not np.all(np.abs(signs) == 1):
            raise InputError("relation", "Y", signs.tolist(), "signs +1 or -1")
        rows = np.eye(n, dtype=np.int64) if basis is None else np.array(basis, dtype=np.int64)
        if rows.ndim != 2 or rows.shape[1] != n:
            raise InputError("relation", "shape of basis", rows.shape, f"(r, {n})")
        limit = np.full(n, np.nan) if bound is None else np.array(bound, dtype=float)
        if correction is not None and correction.constant.shape != (n,):
            raise InputError("relation", "joints of correction", len(correction.constant), str(n))
        for name, value in (
            ("A", matrix),
            ("d", wrap(offset)),
            ("Y", signs),
            ("basis", rows),
            ("exact", bool(exact)),
            ("bound", limit),
            ("unwrapped_d", offset),
            ("correction", correction),
        ):
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
            object.__setattr__(self, name, value)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.A)

    @cached_property
    def A_sat(self) -> Array:
        """Linear part in y = B q coordinates, shape (r, r)."""
        B = self.basis.astype(float)
        if len(B) == self.n and np.array_equal(self.basis, np.eye(self.n)):
            return self.A
        sat = B @ self.A @ np.linalg.pinv(B) if len(B) else np.zeros((0, 0))
        if len(B) and not np.allclose(sat @ B, B @ self.A, atol=1e-9):
            raise InputError("relation", "A", self.A.tolist(), "a map of y = B q (B A = A_sat B)")
        rounded = np.round(sat)
        return rounded if np.allclose(sat, rounded, atol=1e-9) else sat

    @cached_property
    def d_sat(self) -> Array:
        """Offset in y = B q coordinates, shape (r,), in (-pi, pi]."""
        return wrap(self.basis @ self.d)

    @property
    def M(self) -> Array:
        """Matrix M of the paper's Eq. 5, shape (r, n)."""
        return -self.A_sat @ self.basis + 0.0

    @property
    def N(self) -> Array:
        """Matrix N of the paper's Eq. 5, shape (r, n)."""
        return self.basis.astype(float)

    @property
    def rhs(self) -> Array:
        """Right-hand side d of the paper's Eq. 5, shape (r,) [rad], modulo 2 pi."""
        return self.d_sat

    def configuration(self, q: ArrayLike) -> Array:
        """Return the symmetric configuration A q + d of ``q`` (..., n) [rad], not wrapped."""
        return np.asarray(q, dtype=float) @ self.A.T + self.d

    def torque(self, tau: ArrayLike, q: ArrayLike | None = None) -> Array:
        """Return the torque (..., n) that holds the symmetric configuration.

        Parameters
        ----------
        tau : (..., n) array_like
            Torque that holds q [N m].
        q : (..., n) array_like, optional
            The configuration [rad]; needed where there is a correction.

        Raises
        ------
        InputError
            If there is a correction and no q.

        Examples
        --------
        >>> turn = SymmetryRelation([[1.0]], [np.pi], [-1], correction=Correction([0.5]))
        >>> turn.torque([2.5], [0.0]).tolist()  # 2 N m of gravity, of another sign there
        [-1.5]
        """
        torque = np.asarray(tau, dtype=float)
        if self.correction is None:
            return torque * self.Y
        if q is None:
            raise InputError("relation", "q", None, "configurations, as there is a correction")
        gravity = (torque - self.correction.at(q)) * self.Y
        return gravity + self.correction.at(self.configuration(q))

    def of_measured(
        self, correction: Correction | None, bound: ArrayLike | None = None
    ) -> SymmetryRelation:
        """Return the relation of a torque that has a correction beside gravity; None: of gravity.

        Parameters
        ----------
        correction : Correction or None
        bound : (n,) array_like, optional
            Of that torque [N m]; as before by default.
        """
        limit = self.bound if bound is None else bound
        return SymmetryRelation(
            self.A, self.unwrapped_d, self.Y, self.basis, self.exact, limit, correction
        )

    def __matmul__(self, other: SymmetryRelation) -> SymmetryRelation:
        mine, its = self.correction, other.correction
        if mine is not its and not (mine is not None and mine.same_as(its)):
            accepted = "the same for relations that are composed"
            raise InputError("relation", "correction", "two of them", accepted)
        return SymmetryRelation(
            self.A @ other.A,
            self.A @ other.d + self.d,
            self.Y * other.Y,
            self.basis,
            self.exact and other.exact,
            self.bound + other.bound,
            self.correction,
        )

    def inverse(self) -> SymmetryRelation:
        """Return the relation that leads back."""
        back = np.linalg.inv(self.A)
        rounded = np.round(back)
        if np.allclose(back, rounded, atol=1e-9):
            back = rounded + 0.0
        return SymmetryRelation(
            back,
            -back @ self.d,
            self.Y,
            self.basis,
            self.exact,
            self.bound,
            self.correction,
        )

    def same_as(self, other: SymmetryRelation, tolerance: float = SAME_ANGLE) -> bool:
        """Say whether both are one relation: equal Y and A_sat, d_sat equal modulo 2 pi."""
        # bytes, and no np.allclose: this is asked of every pair of relations of a group
        return (
            self.Y.tobytes() == other.Y.tobytes()
            and self.A_sat.shape == other.A_sat.shape
            and bool((np.abs(self.A_sat - other.A_sat) <= 1e-6 + 1e-5 * np.abs(other.A_sat)).all())
            and bool((np.abs(wrap(self.d_sat - other.d_sat)) <= tolerance).all())
        )

    @property
    def is_identity(self) -> bool:
        """Whether the relation leaves y = B q and all torques as they are."""
        return (
            bool(np.all(self.Y == 1))
            and bool(np.allclose(self.A_sat, np.eye(len(self.basis)), atol=1e-9))
            and bool(np.all(np.abs(wrap(self.d_sat)) <= SAME_ANGLE))
        )

    def line(self, joint: int) -> str:
        """Return in words what becomes of one joint, e.g. ``q2' = 2 q1 + 1 q2``."""
        terms = (f"{x:+g} q{j + 1}" for j, x in enumerate(self.A[joint]) if x)
        row = " ".join(terms) or "0"
        shift = f" {self.d[joint]:+.6g}" if abs(self.d[joint]) > 1e-12 else ""
        return f"q{joint + 1}' = {row.removeprefix('+')}{shift}"

    def __str__(self) -> str:
        signs = ", ".join(f"{int(y):+d}" for y in self.Y)
        said = f"{'; '.join(self.line(i) for i in range(self.n))}; Y = diag({signs})"
        return said if self.correction is None else f"{said}; {self.correction.in_words()}"

    def in_short(self) -> str:
        """Return in words what the relation changes, nothing of what it leaves alone.

        Examples
        --------
        >>> SymmetryRelation([[1, 0, 0], [0, -1, 0], [0, 0, 1]], [0, 0.5, 0], [1, -1, 1]).in_short()
        "q2' = -1 q2 +0.5; Y_2 = -1"
        """
        moved = np.any(np.eye(self.n) != self.A, axis=1) | (np.abs(self.d) > 1e-12)
        lines = [self.line(int(i)) for i in np.flatnonzero(moved)]
        signs = [f"Y_{i + 1}" for i in np.flatnonzero(self.Y < 0)]
        lines += [" = ".join([*signs, "-1"])] if signs else []
        return "; ".join(lines) or "the identity"


def identity(n: int, basis: ArrayLike | None = None) -> SymmetryRelation:
    """Return the relation q -> q."""
    return SymmetryRelation(
        np.eye(n), np.zeros(n), np.ones(n), basis, exact=True, bound=np.zeros(n)
    )


def lifted(V: Array, A_sat: Array, d_sat: Array) -> tuple[Array, Array]:
    """Return the map (A, d) of q that is (A_sat, d_sat) on y = B q.

    On the coordinates that complete B, the first rows of the unimodular ``V``, to a basis it is
    the identity.
    """
    n, r = len(V), len(A_sat)
    block = np.eye(n)
    block[:r, :r] = A_sat
    inverse = np.round(np.linalg.inv(V))
    return cleaned(inverse @ block @ V), wrap(inverse[:, :r] @ d_sat)


def cleaned(matrix: Array) -> Array:
    """Return a matrix with whole numbers for entries that only rounding keeps from them."""
    whole = np.round(matrix)
    return np.where(np.abs(matrix - whole) < 1e-9, whole, matrix) + 0.0
