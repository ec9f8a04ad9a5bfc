"""Rules by which a measured number is said to agree with a printed one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Rule:
    """A rule in words, and as a decision on (paper, ours).

    Attributes
    ----------
    words : str
        As it stands in the row.
    holds : callable
        ``holds(paper, ours)``, ours a number (infinity where nothing was reached) or nested
        list of numbers.
    """

    words: str
    holds: Callable[[Any, Any], bool]


def equal() -> Rule:
    """The numbers are equal."""
    return Rule("equal", lambda paper, ours: bool(np.array_equal(paper, ours)))


def at_most(slack: float = 0.0) -> Rule:
    """Ours is at most the paper's, and a share of it more.

    Examples
    --------
    >>> at_most(0.15).words, at_most(0.15).holds(0.0053, 0.0061), at_most().holds(30, np.inf)
    ('at most the paper’s + 15 %', False, False)
    """
    words = "at most the paper’s" + (f" + {100 * slack:g} %" if slack else "")
    return Rule(words, lambda paper, ours: _finite(ours) and ours <= paper * (1 + slack))


def at_least(slack: float = 0.0) -> Rule:
    """Ours is at least the paper's, less a share of it."""
    words = "at least the paper’s" + (f" − {100 * slack:g} %" if slack else "")
    return Rule(words, lambda paper, ours: _finite(ours) and ours >= paper * (1 - slack))


def within(share: float) -> Rule:
    """Ours differs from the paper's by at most a share of it.

    Examples
    --------
    >>> within(0.03).holds(24.5, 24.52), within(0.03).holds(-18.4, -24.5)
    (True, False)
    """
    return Rule(
        f"within {100 * share:g} % of the paper’s",
        lambda paper, ours: _finite(ours) and abs(ours - paper) <= share * abs(paper),
    )


def below(limit: float, unit: str) -> Rule:
    """Ours is below a limit, where the paper has words and no number."""
    return Rule(f"below {limit:g} {unit}".rstrip(), lambda _, ours: _finite(ours) and ours < limit)


def above(limit: float, unit: str) -> Rule:
    """Ours is above a limit, where the paper has words and no number."""
    return Rule(f"above {limit:g} {unit}".rstrip(), lambda _, ours: _finite(ours) and ours > limit)


def close_to(tolerance: float, unit: str) -> Rule:
    """All numbers of a list are as printed, within a tolerance."""
    return Rule(
        f"each within {tolerance:g} {unit}".rstrip(),
        lambda paper, ours: bool(
            np.shape(paper) == np.shape(ours)
            and np.all(np.abs(np.subtract(paper, ours)) <= tolerance)
        ),
    )


def _finite(value: Any) -> bool:
    return value is not None and math.isfinite(value)
