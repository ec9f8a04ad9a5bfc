"""Numbers, matrices and relations as people read them, in HTML."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from markupsafe import Markup

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

SHOWN_DIGITS = 6
"""Decimals of an offset [rad] in a written relation; its error stands beside it in full."""


def number(value: float | int | None, digits: int = 3) -> Markup:
    """Write a number for people: ``digits`` significant ones, powers of ten where they help.

    Examples
    --------
    >>> str(number(0.0053)), str(number(-12.3456)), str(number(2.14e-15))
    ('0.0053', '−12.3', '2.14·10<sup>−15</sup>')
    """
    if value is None or not math.isfinite(value):
        return Markup("–")
    if isinstance(value, int | np.integer):
        return Markup(f"{value:,}".replace(",", "\N{NARROW NO-BREAK SPACE}").replace("-", "−"))
    if abs(value) < 1e-300:
        return Markup("0")
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 5:
        places = max(0, digits - 1 - exponent)
        text = f"{value:,.{places}f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
        text = text.rstrip("0").rstrip(".") if "." in text else text
        return Markup(text.replace("-", "−"))
    mantissa = f"{value / 10.0**exponent:.{digits - 1}f}".rstrip("0").rstrip(".")
    power = str(exponent).replace("-", "−")
    return Markup(f"{mantissa.replace('-', '−')}·10<sup>{power}</sup>")


def vector(values: Any, digits: int = 4) -> Markup:
    """Write the entries of a vector in brackets."""
    return Markup("(") + Markup(", ").join(number(_entry(x), digits) for x in values) + Markup(")")


def matrix(values: Any) -> Markup:
    """Write a matrix as a table."""
    rows = (
        Markup("<tr>")
        + Markup("").join(
            Markup("<td>") + number(_entry(x), 5) + Markup("</td>") for x in np.atleast_1d(row)
        )
        + Markup("</tr>")
        for row in np.asarray(values)
    )
    return Markup('<table class="matrix">') + Markup("").join(rows) + Markup("</table>")


def _entry(value: Any) -> float | int:
    x = float(value)
    return int(x) if x.is_integer() and abs(x) < 1e9 else x


def map_lines(relation: SymmetryRelation) -> Markup:
    """Write the map of a relation, one line per joint, and its torque signs.

    Examples
    --------
    >>> print(map_lines(SymmetryRelation([[-1]], [np.pi], [-1])))
    q<sub>1</sub>′ = −q<sub>1</sub> + π<br>τ<sub>1</sub>′ = −τ<sub>1</sub>
    """
    lines = [
        Markup("q<sub>{0}</sub>′ = {1}").format(i, _row(row, offset))
        for i, (row, offset) in enumerate(zip(relation.A, relation.d, strict=True), 1)
    ]
    flipped = [
        Markup("τ<sub>{0}</sub>′ = −τ<sub>{0}</sub>").format(i)
        for i, sign in enumerate(relation.Y, 1)
        if sign < 0
    ]
    torque = Markup(", ").join(flipped) if flipped else Markup("τ′ = τ")
    return Markup("<br>").join([*lines, torque])


def _row(coefficients: Any, offset: float) -> Markup:
    terms = []
    for j, x in enumerate(coefficients, 1):
        if x:
            size = Markup("") if abs(x) == 1 else number(_entry(abs(x)), SHOWN_DIGITS) + Markup(" ")
            terms.append((x < 0, size + Markup("q<sub>{0}</sub>").format(j)))
    if abs(offset) == np.pi:
        terms.append((offset < 0, Markup("π")))
    elif round(abs(offset), SHOWN_DIGITS):
        terms.append((offset < 0, Markup(f"{abs(offset):.{SHOWN_DIGITS}f}".rstrip("0"))))
    text = Markup("")
    for place, (negative, term) in enumerate(terms):
        sign = ("−" if negative else "") if not place else (" − " if negative else " + ")
        text += Markup(sign) + term
    return text or Markup("0")
