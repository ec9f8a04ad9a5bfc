"""Verdict of a judge: a claim, how it is known, and where it fails if it does."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Status(StrEnum):
    """Status of a claim, from the strongest to the weakest, not tested, and refuted."""

    PROVED = "proved"
    BOUNDED = "bounded"
    TESTED = "tested"
    UNTESTED = "not tested"
    REFUTED = "refuted"


@dataclass(frozen=True, eq=False)
class Verdict:
    """The judgement of one claim.

    Attributes
    ----------
    claim : str
        What was claimed, in one line.
    status : Status
        ``proved``: in exact arithmetic, for every configuration. ``bounded``: a bound that holds
        for every configuration lies within the tolerance. ``tested``: no bound, but a search
        found nothing beyond the tolerance, or measurements that would have shown more contradict
        nothing. ``not tested``: measurements that cannot tell. ``refuted``: the claim is false.
    passed : bool
        Whether the claim stands within the tolerance; what was not tested does not pass.
    worst_error : float
        For ``proved`` and ``bounded`` the bound, otherwise the largest error found; in the unit
        of the claim, N m unless it says otherwise. NaN, and null in JSON, where the claim is
        about no error, such as that a list is complete.
    counterexample : (n,) array or None
        For ``refuted``: the simplest configuration found where the claim fails [rad]; None where
        the claim is not about single configurations.
    rmse : float or None
        Root mean square error, where the claim is about one.
    reason : str
        By what means it was judged, or what is missing; empty where the status says it.

    Examples
    --------
    >>> verdict = Verdict("q1' = -q1", Status.REFUTED, 2.0, np.array([1.0]))
    >>> verdict.passed
    False
    >>> print(verdict)
    refuted: q1' = -q1 (worst error 2, at q = (1))
    """

    claim: str
    status: Status
    worst_error: float
    counterexample: NDArray[np.float64] | None = None
    rmse: float | None = None
    reason: str = ""

    @property
    def passed(self) -> bool:
        """Whether the claim stands."""
        return self.status not in (Status.REFUTED, Status.UNTESTED)

    def to_json(self) -> dict[str, Any]:
        """Return the verdict as the command line prints it; rmse and reason where it has them."""
        more: dict[str, Any] = {} if self.rmse is None else {"rmse": float(self.rmse)}
        if self.reason:
            more["reason"] = self.reason
        return {
            "claim": self.claim,
            "status": str(self.status),
            "passed": self.passed,
            "worst_error": None if np.isnan(self.worst_error) else float(self.worst_error),
            "counterexample": None
            if self.counterexample is None
            else [float(x) for x in self.counterexample],
            **more,
        }

    def __str__(self) -> str:
        said = []
        if self.rmse is not None:
            said = [f"RMSE {self.rmse:.3g}", f"largest error {self.worst_error:.3g}"]
        elif not np.isnan(self.worst_error):
            said = [f"worst error {self.worst_error:.3g}"]
        if self.counterexample is not None:
            said += ["at q = (" + ", ".join(f"{x:.6g}" for x in self.counterexample) + ")"]
        figures = f" ({', '.join(said)})" if said else ""
        reason = f"; {self.reason}" if self.reason else ""
        return f"{self.status}: {self.claim}{figures}{reason}"


def all_passed(verdicts: Iterable[Verdict]) -> bool:
    """Return whether every claim stands (also when there is none)."""
    return all(verdict.passed for verdict in verdicts)


def sizes(values: NDArray[np.float64]) -> str:
    """Write tolerances of joints: one number where they are equal.

    Examples
    --------
    >>> sizes(np.array([0.1, 0.1])), sizes(np.array([0.245312, 0.0613]))
    ('0.1', '(0.245, 0.0613)')
    """
    if np.all(values == values[0]):
        return f"{values[0]:g}"
    return "(" + ", ".join(f"{x:.3g}" for x in values) + ")"
