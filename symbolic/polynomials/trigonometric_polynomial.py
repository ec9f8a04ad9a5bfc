"""Trigonometric polynomials with integer frequencies: the normal form of gravity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.coefficients import (
    Coefficients,
    coefficient_arrays,
    to_float,
    to_sympy,
)
from isotorque.symbolic.polynomials.frequencies import canonical_terms, frequency_rows
from isotorque.symbolic.polynomials.text import polynomial_text

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True, eq=False)
class TrigonometricPolynomial:
    """A real function f(q) = sum over k of cos_k cos(k.q) + sin_k sin(k.q).

    Attributes
    ----------
    frequencies : (m, n) int array
        One row k per term; of each pair +-k only the one whose first nonzero entry is positive;
        no row twice.
    cos, sin : (m,) arrays
        Coefficients: float64, or objects (``flint.fmpq`` for exact rationals, SymPy expressions).
    names : tuple of str
        Names of the n variables, for printing.

    Notes
    -----
    The constructor brings any rows into this form (rows -k are folded onto k, equal rows added)
    and drops terms that are exactly zero.

    Examples
    --------
    >>> f = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> print(f)
    18.4 sin(q1) + 6.1 sin(q1 + q2)
    >>> print(f.derivative(1))
    6.1 cos(q1 + q2)
    """

    frequencies: NDArray[np.int64]
    cos: Coefficients
    sin: Coefficients
    names: tuple[str, ...] = field(default=())

    def __init__(
        self,
        frequencies: ArrayLike,
        cos: ArrayLike,
        sin: ArrayLike,
        names: tuple[str, ...] | None = None,
    ) -> None:
        k = frequency_rows(frequencies)
        k, a, b = canonical_terms(k, *coefficient_arrays(len(k), cos, sin))
        object.__setattr__(self, "frequencies", k)
        object.__setattr__(self, "cos", a)
        object.__setattr__(self, "sin", b)
        if names is None:
            names = tuple(f"q{i + 1}" for i in range(k.shape[1]))
        if len(names) != k.shape[1]:
            raise InputError("trigonometric polynomial", "names", names, f"{k.shape[1]} names")
        object.__setattr__(self, "names", tuple(names))

    @property
    def n(self) -> int:
        """Number of variables."""
        return int(self.frequencies.shape[1])

    def __len__(self) -> int:
        return len(self.frequencies)

    @property
    def is_exact(self) -> bool:
        """Whether the coefficients are exact rationals."""
        return self.cos.dtype == object and all(isinstance(x, fmpq) for x in (*self.cos, *self.sin))

    @property
    def is_symbolic(self) -> bool:
        """Whether any coefficient is a SymPy expression."""
        return self.cos.dtype == object and not self.is_exact

    # -- values ---------------------------------------------------------------------------------

    @cached_property
    def _numeric(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        f = self.to_float()
        return f.frequencies.astype(float), f.cos, f.sin

    @cached_property
    def _coefficients(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Cosines and sines as floats; those too small for one are zero, but still terms."""
        k, a, b = self._numeric
        if len(k) < len(self):
            a, b = (np.array([to_float(x) for x in part]) for part in (self.cos, self.sin))
        return a, b

    def to_float(self) -> TrigonometricPolynomial:
        """Return the polynomial with float64 coefficients (correctly rounded from rationals).

        Raises
        ------
        InputError
            If a coefficient contains symbols.
        """
        if self.cos.dtype != object:
            return self
        return self._map(to_float, np.float64)

    def evaluate(self, q: ArrayLike) -> NDArray[np.float64]:
        """Evaluate at configurations ``q`` of shape (..., n); result of shape (...)."""
        k, a, b = self._numeric
        phase = self._points(q) @ k.T
        return np.asarray(np.cos(phase) @ a + np.sin(phase) @ b)

    __call__ = evaluate

    def gradient(self, q: ArrayLike) -> NDArray[np.float64]:
        """Return the gradient at ``q`` (..., n), of shape (..., n)."""
        k, a, b = self._numeric
        phase = self._points(q) @ k.T
        return np.asarray((np.cos(phase) * b - np.sin(phase) * a) @ k)

    def hessian(self, q: ArrayLike) -> NDArray[np.float64]:
        """Return the matrix of second derivatives at ``q`` (..., n), of shape (..., n, n)."""
        k, a, b = self._numeric
        phase = self._points(q) @ k.T
        weight = -(np.cos(phase) * a + np.sin(phase) * b)
        return np.einsum("...m,mi,mj->...ij", weight, k, k)

    def _points(self, q: ArrayLike) -> NDArray[np.float64]:
        points = np.asarray(q, dtype=float)
        if points.shape[-1:] != (self.n,):
            raise InputError("configuration", "shape", points.shape, f"(..., {self.n})")
        return points

    def complex(self) -> NDArray[np.complex128]:
        """Return C_k = (cos_k - i sin_k) / 2, so that f = sum over +-k of C_k exp(i k.q)."""
        a, b = self._coefficients
        return np.asarray((a - 1j * b) / 2, dtype=np.complex128)

    # -- algebra --------------------------------------------------------------------------------

    def derivative(self, variable: int) -> TrigonometricPolynomial:
        """Return the derivative with respect to variable number ``variable``."""
        _, _, factor = coefficient_arrays(
            None, self.cos, self.sin, self.frequencies[:, variable].astype(object)
        )
        return TrigonometricPolynomial(
            self.frequencies, factor * self.sin, -factor * self.cos, self.names
        )

    def __add__(self, other: TrigonometricPolynomial) -> TrigonometricPolynomial:
        if not isinstance(other, TrigonometricPolynomial):
            return NotImplemented
        if other.n != self.n:
            raise InputError("sum", "number of variables", other.n, str(self.n))
        return TrigonometricPolynomial(
            np.concatenate([self.frequencies, other.frequencies]),
            np.concatenate([self.cos, other.cos]),
            np.concatenate([self.sin, other.sin]),
            self.names,
        )

    def __neg__(self) -> TrigonometricPolynomial:
        return self * -1

    def __sub__(self, other: TrigonometricPolynomial) -> TrigonometricPolynomial:
        if not isinstance(other, TrigonometricPolynomial):
            return NotImplemented
        return self + (-other)

    def __mul__(self, factor: Any) -> TrigonometricPolynomial:
        a, b, one = coefficient_arrays(None, self.cos, self.sin, [factor])
        return TrigonometricPolynomial(self.frequencies, a * one[0], b * one[0], self.names)

    __rmul__ = __mul__

    def substitute(self, A: ArrayLike, d: ArrayLike) -> TrigonometricPolynomial:
        """Return f(A q + d) for an integer matrix ``A`` (n, n) and offsets ``d`` (n,) [rad].

        Raises
        ------
        InputError
            If ``A`` is not an integer matrix: the result would not be of this class.

        Examples
        --------
        >>> f = TrigonometricPolynomial([[1, 1]], [0.0], [1.0])
        >>> print(f.substitute([[-1, 0], [2, 1]], [0.0, 0.0]))
        1 sin(q1 + q2)
        """
        matrix = np.asarray(A, dtype=float)
        if matrix.shape != (self.n, self.n) or not np.all(matrix == np.round(matrix)):
            raise InputError(
                "substitution", "A", matrix.tolist(), f"an integer matrix {self.n} x {self.n}"
            )
        offset = np.asarray(d, dtype=float)
        if offset.shape != (self.n,) or not np.all(np.isfinite(offset)):
            raise InputError("substitution", "d", offset.tolist(), f"{self.n} finite angles [rad]")
        k, a, b = self._numeric
        phase = k @ offset
        c, s = np.cos(phase), np.sin(phase)
        return TrigonometricPolynomial(k @ matrix, a * c + b * s, b * c - a * s, self.names)

    # -- bounds ---------------------------------------------------------------------------------

    def amplitudes(self) -> NDArray[np.float64]:
        """Return sqrt(cos_k^2 + sin_k^2), shape (m,)."""
        return np.hypot(*self._coefficients)

    def sup_bound(self) -> float:
        """Return a bound on |f(q)| over all q (the sum of amplitudes)."""
        return float(self.amplitudes().sum())

    def gradient_bound(self) -> NDArray[np.float64]:
        """Return bounds on |df/dq_i| over all q, shape (n,)."""
        return np.asarray(self.amplitudes() @ np.abs(self.frequencies), dtype=float)

    def significant(self, relative: float = 1e-12) -> TrigonometricPolynomial:
        """Return the polynomial without terms below ``relative`` times its largest amplitude.

        Cosine and sine of a rounded angle, taken as rationals, miss cos^2 + sin^2 = 1 by an ulp:
        exact arithmetic then keeps terms that only stand for that. With symbols nothing is dropped.
        """
        if self.is_symbolic:
            return self
        size = self.amplitudes()
        keep = size > relative * size.max(initial=0.0)
        return TrigonometricPolynomial(
            self.frequencies[keep], self.cos[keep], self.sin[keep], self.names
        )

    # -- views ----------------------------------------------------------------------------------

    def to_sympy(self, symbols: tuple[sympy.Symbol, ...] | None = None) -> sympy.Expr:
        """Return the polynomial as a SymPy expression in ``symbols`` (default: the names)."""
        import sympy

        q = symbols or sympy.symbols(self.names, real=True)
        total = sympy.Integer(0)
        for k, a, b in zip(self.frequencies.tolist(), self.cos, self.sin, strict=True):
            phase = sympy.Add(*[c * x for c, x in zip(k, q, strict=True)])
            total += to_sympy(a) * sympy.cos(phase) + to_sympy(b) * sympy.sin(phase)
        return total

    def renamed(self, names: Sequence[str]) -> TrigonometricPolynomial:
        """Return the same polynomial with other names for its variables."""
        return TrigonometricPolynomial(self.frequencies, self.cos, self.sin, tuple(names))

    def __str__(self) -> str:
        return polynomial_text(self.frequencies, self.cos, self.sin, self.names)

    def _map(self, convert: Callable[[Any], Any], dtype: Any) -> TrigonometricPolynomial:
        return TrigonometricPolynomial(
            self.frequencies,
            np.array([convert(x) for x in self.cos], dtype=dtype),
            np.array([convert(x) for x in self.sin], dtype=dtype),
            self.names,
        )
