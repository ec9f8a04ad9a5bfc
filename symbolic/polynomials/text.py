"""Trigonometric polynomials as readable text."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.polynomials.coefficients import (
    Coefficients,
    is_expression,
    is_zero,
    to_float,
)


def polynomial_text(
    frequencies: NDArray[np.int64], cos: Coefficients, sin: Coefficients, names: tuple[str, ...]
) -> str:
    """Write sum over k of cos_k cos(k.q) + sin_k sin(k.q), numbers with six digits."""
    pieces: list[str] = []
    for k, a, b in zip(frequencies.tolist(), cos, sin, strict=True):
        phase = _phase_text(k, names)
        for value, function in ((a, "cos"), (b, "sin")):
            if is_zero(value):
                continue
            wave = f"{function}({phase})" if any(k) else ""
            pieces.append(_term_text(value, wave))
    if not pieces:
        return "0"
    text = " + ".join(pieces)
    return text.replace("+ -", "- ")


def _phase_text(k: list[int], names: tuple[str, ...]) -> str:
    text = ""
    for factor, name in zip(k, names, strict=True):
        if factor:
            size = name if abs(factor) == 1 else f"{abs(factor)} {name}"
            sign = " - " if factor < 0 else " + "
            text += (sign if text else sign.strip(" +")) + size
    return text


def _term_text(value: Any, wave: str) -> str:
    if is_expression(value):
        import sympy

        factor = sympy.factor_terms(value)
        if wave and abs(factor) == 1:
            return wave if factor == 1 else f"-{wave}"
        size = f"({factor})" if wave and isinstance(factor, sympy.Add) else str(factor)
        return f"{size}*{wave}" if wave else size
    number = f"{to_float(value):.6g}"
    return f"{number} {wave}".strip()
