"""Extrapolation: where a model has no data, and how large what it answers there is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

POINTS = 4096
"""Configurations at which a model is asked."""
WILD = 2.0
"""Answers larger than this many times the largest torque of the data are said."""
COVERED = 0.5
"""Data that cover a smaller share of the joint ranges than this are said."""
MARGIN = 0.1
"""So much beyond the data [rad] still counts as among them."""


@dataclass(frozen=True, eq=False)
class Extrapolation:
    """Answers of a model beyond its data.

    Attributes
    ----------
    low, high : (n,) arrays
        Range of every joint in the data [rad].
    outside : float
        Share of the joint ranges that lies beyond them.
    seen, predicted : float
        Largest torque of the data, and of the answers within the joint ranges [N m].
    where : (n,) array
        Configuration of the largest answer [rad].
    standard_error : float
        Median over the points beyond the data of the largest standard error of a joint's torque
        [N m]; NaN where the learner states none.
    """

    low: Array
    high: Array
    outside: float
    seen: float
    predicted: float
    where: Array
    standard_error: float

    @property
    def wild(self) -> bool:
        """Whether an answer exceeds ``WILD`` times the largest torque of the data."""
        return not self.predicted <= WILD * self.seen

    @property
    def remark(self) -> str | None:
        """What a user should know; None where the data cover the joints and nothing is wild."""
        if not self.wild and self.outside <= 1.0 - COVERED:
            return None
        ranges = ", ".join(f"{a:.3g} to {b:.3g}" for a, b in zip(self.low, self.high, strict=True))
        said = (
            f"no data in {100.0 * self.outside:.0f} % of the joint ranges (seen: {ranges} rad): "
            f"there the model answers up to {self.predicted:.3g} N m, the data have "
            f"{self.seen:.3g} N m"
        )
        if np.isfinite(self.standard_error):
            said += f", with a standard error of {self.standard_error:.2g} N m (median)"
        return f"{said}; not to be trusted there" if self.wild else said

    def document(self) -> dict[str, Any]:
        """The same as plain data."""
        return {
            "seen_from": self.low.tolist(),
            "seen_to": self.high.tolist(),
            "share_without_data": self.outside,
            "largest_torque_of_data": self.seen,
            "largest_answer": self.predicted,
            "at": self.where.tolist(),
            "standard_error": self.standard_error if np.isfinite(self.standard_error) else None,
            "trusted": not self.wild,
        }


def extrapolation(
    learner: Any, q: ArrayLike, torque: ArrayLike, limits: ArrayLike
) -> Extrapolation:
    """Ask a model within the joint ranges, and compare its answers with the data.

    Parameters
    ----------
    learner
        Fitted (``predict``); ``standard_error`` or ``predict(q, return_std=True)`` is used where
        it is there.
    q, torque : (m, n) array_like
        The data [rad], [N m], m at least 1.
    limits : (n, 2) array_like
        Joint ranges [rad].

    Examples
    --------
    >>> from isotorque import EquivariantTrigonometric
    >>> q = np.linspace(-0.3, 0.3, 12)[:, None]
    >>> arm = EquivariantTrigonometric().fit(q, np.cos(q))
    >>> found = extrapolation(arm, q, np.cos(q), [[-np.pi, np.pi]])
    >>> round(found.outside, 1), round(found.predicted, 3), found.wild
    (0.9, 1.0, False)
    >>> found.remark.split(":")[0]
    'no data in 87 % of the joint ranges (seen'
    """
    samples, torques = np.asarray(q, dtype=float), np.asarray(torque, dtype=float)
    box = np.asarray(limits, dtype=float)
    box = np.clip(np.where(np.isfinite(box), box, np.sign(box) * np.pi), -4.0 * np.pi, 4.0 * np.pi)
    low, high = samples.min(axis=0), samples.max(axis=0)
    points = np.random.default_rng(0).uniform(box[:, 0], box[:, 1], (POINTS, len(box)))
    beyond = ((points < low - MARGIN) | (points > high + MARGIN)).any(axis=1)
    answers = np.asarray(learner.predict(points), dtype=float)
    size = np.abs(answers).max(axis=1)
    size = np.where(np.isfinite(size), size, np.inf)
    far = int(size.argmax())
    far_errors = standard_errors(learner, points[beyond][:256]) if beyond.any() else None
    error = float("nan") if far_errors is None else float(np.median(np.max(far_errors, axis=1)))
    return Extrapolation(
        low,
        high,
        float(beyond.mean()),
        float(np.abs(torques).max()),
        float(size[far]),
        points[far],
        error,
    )


def standard_errors(learner: Any, q: ArrayLike) -> Array | None:
    """Standard errors (m, n) [N m] that a model states at configurations q; None: it states none.

    Parameters
    ----------
    learner
        Fitted; ``standard_error`` or ``predict(q, return_std=True)`` is used where it is there.
    q : (m, n) array_like
        Configurations [rad].

    Examples
    --------
    >>> from isotorque import EquivariantTrigonometric
    >>> q = np.linspace(-3.0, 3.0, 12)[:, None]
    >>> arm = EquivariantTrigonometric().fit(q, np.cos(q))
    >>> standard_errors(arm, q).shape, standard_errors(object(), q)
    ((12, 1), None)
    """
    if hasattr(learner, "standard_error"):
        errors = learner.standard_error(q)
    elif "return_std" in _arguments(learner):
        errors = learner.predict(q, return_std=True)[1]
    else:
        return None
    return None if errors is None else np.asarray(errors, dtype=float)


def _arguments(learner: Any) -> tuple[str, ...]:
    """Names in ``predict`` of a model."""
    code = getattr(getattr(type(learner), "predict", None), "__code__", None)
    return () if code is None else code.co_varnames
