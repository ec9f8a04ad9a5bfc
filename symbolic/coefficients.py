"""Coefficients of three kinds: floats, exact rationals (``flint.fmpq``), SymPy expressions."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy
from flint import fmpq
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError

Coefficients = NDArray[Any]


def is_zero(value: Any) -> bool:
    """Say whether a float, rational or SymPy coefficient is exactly zero."""
    if isinstance(value, sympy.Basic):
        return bool(value.is_zero) or (not value.is_Atom and sympy.expand(value) == 0)
    return bool(value == 0)


def coefficient_array(values: ArrayLike, m: int) -> Coefficients:
    """Return ``m`` coefficients as an array of finite floats or of objects.

    Raises
    ------
    InputError
        For another number of them, or for infinite or undefined floats.
    """
    array = np.asarray(values)
    if array.shape != (m,):
        raise InputError(
            "trigonometric polynomial", "shape of coefficients", array.shape, f"({m},)"
        )
    if array.dtype == object:
        return array
    array = array.astype(np.float64)
    if not np.all(np.isfinite(array)):
        raise InputError("trigonometric polynomial", "coefficients", array, "finite numbers")
    return array


def integer_like(value: int, like: Coefficients) -> Any:
    """Return an integer as a coefficient of the same kind as those in ``like``."""
    if like.dtype != object:
        return float(value)
    return sympy.Integer(value) if any(isinstance(x, sympy.Basic) for x in like) else fmpq(value)


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
            "trigonometric polynomial", "coefficient", value, "a number (substitute the symbols)"
        ) from None


def to_sympy(value: Any) -> sympy.Expr:
    """Return a coefficient as a SymPy expression, exactly."""
    if isinstance(value, fmpq):
        return sympy.Rational(int(value.p), int(value.q))
    return sympy.sympify(value)
