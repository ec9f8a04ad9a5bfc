"""Growth in words: fitted laws, times and the table of all curves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from benchmarks.growth.curves import LONGEST, Curve, Growth, Measured, growth


def law(curve: Curve, found: Growth) -> str:
    """The fitted law of a curve: its exponent, or its factor where it is exponential.

    Examples
    --------
    >>> from benchmarks.growth.curves import Work
    >>> square = growth([1, 2, 4, 8], [1.0, 4.0, 16.0, 64.0])
    >>> law(Curve("a square", (1, 2, 4, 8), Work), square)
    'exponent 2.00 ± 0.00'
    """
    if curve.per:
        return f"factor {_with_error(found.factor, found.factor_error)} per {curve.per}"
    return f"exponent {_with_error(found.exponent, found.exponent_error)}"


def text_of(seconds: float) -> str:
    """A time with its unit.

    Examples
    --------
    >>> [text_of(x) for x in (1.234e-7, 0.01234, 12.34)]
    ['123 ns', '12.3 ms', '12.3 s']
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.9995 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def table(families: Mapping[str, Sequence[Measured]]) -> str:
    """All curves as Markdown.

    Parameters
    ----------
    families
        Curves by the quantity they depend on.
    """
    head = ["grows with", "of", "what", "from", "to", "time there", "and there", "growth"]
    lines = [head, ["---"] * len(head)]
    for quantity, curves in families.items():
        for one in curves:
            cells = [quantity, one.curve.panel, one.curve.what]
            cells += [f"{one.x[0]:,.0f}", f"{one.x[-1]:,.0f}"]
            cells += [text_of(one.seconds[0]), text_of(one.seconds[-1]), _growth(one)]
            lines.append(cells)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _growth(one: Measured) -> str:
    if len(one.x) < 2:
        text = ""
    else:
        found = growth(one.x, one.seconds)
        text = law(one.curve, found)
        if one.curve.per:
            text += f" (as a power {_with_error(found.exponent, found.exponent_error)})"
    if one.stopped:
        text += f"; ends where a point takes over {LONGEST:.0f} s"
    return text.removeprefix("; ")


def _with_error(value: float, error: float) -> str:
    return f"{value:.2f}" + (f" ± {error:.2f}" if math.isfinite(error) else "")
