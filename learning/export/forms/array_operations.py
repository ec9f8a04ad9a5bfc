"""Array operations that torque forms are written in, and NumPy's."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Space(Protocol):
    """Matrices of numbers or of symbols, always with two dimensions.

    ``@``, ``+``, ``-``, ``*`` (component by component) and ``/`` work on them; columns and rows
    are repeated by multiplication with ones, never implicitly.
    """

    def constant(self, table: ArrayLike) -> Any:
        """A matrix of given numbers; one dimension becomes a column."""

    def cos(self, x: Any) -> Any:
        """Cosine, component by component."""

    def sin(self, x: Any) -> Any:
        """Sine, component by component."""

    def exp(self, x: Any) -> Any:
        """Exponential function, component by component."""

    def tanh(self, x: Any) -> Any:
        """Hyperbolic tangent, component by component."""

    def floor(self, x: Any) -> Any:
        """Largest integer below, component by component."""

    def above(self, parts: list[Any]) -> Any:
        """Matrices one above the other."""

    def beside(self, parts: list[Any]) -> Any:
        """Matrices side by side."""

    def smallest(self, x: Any) -> Any:
        """The smallest component, (1, 1)."""

    def at_most(self, x: Any, limit: Any) -> Any:
        """1 where x <= limit (1, 1), else 0."""

    def choose(self, condition: Any, yes: Any, no: Any) -> Any:
        """``yes`` where a condition (1, 1) is not 0, else ``no``."""


class NumpySpace:
    """Plain arrays."""

    def constant(self, table: ArrayLike) -> Array:
        """See `Space`."""
        x = np.asarray(table, dtype=float)
        return x if x.ndim == 2 else x.reshape(-1, 1)

    def cos(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(np.cos(x))

    def sin(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(np.sin(x))

    def exp(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(np.exp(x))

    def tanh(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(np.tanh(x))

    def floor(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(np.floor(x))

    def above(self, parts: list[Array]) -> Array:
        """See `Space`."""
        return np.vstack(parts)

    def beside(self, parts: list[Array]) -> Array:
        """See `Space`."""
        return np.hstack(parts)

    def smallest(self, x: Array) -> Array:
        """See `Space`."""
        return np.asarray(x.min()).reshape(1, 1)

    def at_most(self, x: Array, limit: Array) -> Array:
        """See `Space`."""
        return np.asarray((x <= limit).astype(float))

    def choose(self, condition: Array, yes: Array, no: Array) -> Array:
        """See `Space`."""
        return yes if condition[0, 0] else no
