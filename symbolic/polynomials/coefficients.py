"""Coefficients of three kinds: floats, exact rationals (``flint.fmpq``), SymPy expressions."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import fmpq, fmpz
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

if TYPE_CHECKING:
    import sympy

Coefficients = NDArray[Any]

_WHERE = "trigonometric polynomial"


def is_expression(value: Any) -> bool:
    """Say whether a coefficient is a SymPy expression.

    SymPy is imported where expressions are made: before that, nothing is one, and arms of numbers
    do not wait for it.
    """
    module = sys.modules.get("sympy")
    return module is not None and isinstance(value, module.Basic)


def is_zero(value: Any) -> bool:
    """Say whether a float, rational or SymPy coefficient is exactly zero."""
    if is_expression(value):
        return bool(value.is_zero) or (not value.is_Atom and value.expand() == 0)
    return bool(value == 0)


def coefficient_arrays(m: int | None, *values: ArrayLike) -> tuple[Coefficients, ...]:
    """Return arrays of coefficients, all of one kind.

    Parameters
    ----------
    m
        Length that they must have; None for any.
    values
        Numbers of any kind. SymPy expressions anywhere make all of them SymPy expressions, else
        floats make all of them floats, else all are exact rationals; only an array of integers
        that are not objects counts as floats.

    Raises
    ------
    InputError
        For another length, for complex, infinite or undefined numbers, or for no numbers.
    """
    arrays = [np.asarray(x) for x in values]
    for array in arrays:
        if array.ndim != 1 or (m is not None and len(array) != m):
            raise InputError(_WHERE, "shape of coefficients", array.shape, f"({m or 'm'},)")
        if array.dtype.kind not in "biufO":
            raise InputError(_WHERE, "coefficients", array.tolist(), "real numbers")
    if not any(array.dtype == object for array in arrays):
        floats = tuple(array.astype(np.float64) for array in arrays)
    else:
        entries = [x for array in arrays for x in array.tolist()]
        if any(is_expression(x) for x in entries):
            return tuple(_converted(array, to_sympy) for array in arrays)
        if not any(isinstance(x, float) for x in entries):
            return tuple(_converted(array, _to_rational) for array in arrays)
        floats = tuple(_converted(array, to_float).astype(np.float64) for array in arrays)
    for array in floats:
        if not np.all(np.isfinite(array)):
            raise InputError(_WHERE, "coefficients", array.tolist(), "finite numbers")
    return floats


def _converted(array: NDArray[Any], convert: Callable[[Any], Any]) -> Coefficients:
    out = np.empty(len(array), dtype=object)
    out[:] = [convert(x) for x in array.tolist()]
    return out


def _to_rational(value: Any) -> fmpq:
    if isinstance(value, fmpq):
        return value
    if isinstance(value, int | np.integer | fmpz):
        return fmpq(int(value))
    raise InputError(_WHERE, "coefficient", value, "a float, an exact rational or SymPy expression")


def to_float(value: Any) -> float:
    """Return a coefficient as a float, correctly rounded from rationals.

    Raises
    ------
    InputError
        If it contains symbols.
    """
    if isinstance(value, fmpq):
        return int(value.p) / int(value.q)
    try:
        return float(value)
    except TypeError:
        raise InputError(
            _WHERE, "coefficient", value, "a number (substitute the symbols)"
        ) from None


def to_sympy(value: Any) -> sympy.Expr:
    """Return a coefficient as a SymPy expression, exactly."""
    import sympy

    if isinstance(value, fmpq):
        return sympy.Rational(int(value.p), int(value.q))
    return sympy.sympify(value)
