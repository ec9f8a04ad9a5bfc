"""Wording of the rows of the table."""

from __future__ import annotations

import math

from isotorque.paper.table.table import Numbers, Value


def number(key: str) -> Value:
    """Take a measured number by its name."""
    return lambda numbers: numbers[key]


def entry(key: str, place: int) -> Value:
    """Take one entry of a measured list."""
    return lambda numbers: numbers[key][place]


def settings_differ(numbers: Numbers) -> str:
    """Say why a number differs where no theory forbids it."""
    return "measured; no theory speaks against the paper's number, whose settings are not given"


def percent(share: float | None) -> str:
    """Write a share, which may not have been watched, in per cent."""
    return "an unknown part" if share is None or math.isinf(share) else f"{100 * share:.0f} %"


def text(value: float | None, never: str = "not reached") -> str:
    """Write a number that may not have been reached.

    Examples
    --------
    >>> text(0.00531), text(None)
    ('0.00531', 'not reached')
    """
    return never if value is None or math.isinf(value) else f"{value:.3g}"
