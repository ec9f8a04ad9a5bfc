"""Causes of torques beside gravity, as samples show them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extensible_model import F
from isotorque.learning.statistics.causes.extension import Kind, Shape
from isotorque.learning.statistics.causes.selection import Choice, Selection

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cause:
    """A cause of torques beside gravity.

    Attributes
    ----------
    kind : Kind
    joint : int or None
        From 0; None for all joints and for a payload.
    size, standard_error : (k,) arrays
        Of all its unknowns, in the units of the kind.
    p_value : float
        Chance that anything as clear is seen where there is nothing.
    effect : float
        Torque that it adds, RMS over the samples, at the joint where that is largest [N m].
    rivals : tuple of (Kind, int or None)
        Causes that cannot be told apart with these samples, this one first.
    since : int or None
        First sample with it, from 0: of a change of the payload.
    """

    kind: Kind
    joint: int | None
    size: Array
    standard_error: Array
    p_value: float
    effect: float
    rivals: tuple[tuple[Kind, int | None], ...]
    since: int | None = None

    def as_json(self) -> dict[str, Any]:
        """Everything as plain numbers and names; joints from 0."""
        return {
            "kind": str(self.kind),
            "joint": self.joint,
            "size": self.size.tolist(),
            "standard_error": [x if np.isfinite(x) else None for x in self.standard_error],
            "p_value": self.p_value,
            "effect": self.effect,
            "rivals": [[str(kind), joint] for kind, joint in self.rivals],
        } | ({} if self.since is None else {"since": self.since})

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Cause:
        """Inverse of `as_json`."""
        error = [np.inf if x is None else x for x in found["standard_error"]]
        return cls(
            Kind(found["kind"]),
            found["joint"],
            np.array(found["size"], dtype=float),
            np.array(error, dtype=float),
            float(found["p_value"]),
            float(found["effect"]),
            tuple((Kind(kind), joint) for kind, joint in found["rivals"]),
            found.get("since"),
        )

    def joints(self, count: int) -> list[int]:
        """Joints (from 0) of an arm of so many that it concerns."""
        return list(range(count)) if self.joint is None else [self.joint]


def causes_of(selection: Selection[F], joints: Sequence[int] | None = None) -> tuple[Cause, ...]:
    """The causes that were chosen, with sizes as the fit with all of them has them.

    Parameters
    ----------
    selection : Selection
    joints : sequence of int, optional
        Which joints of the arm those of the model are, from 0; the same ones by default.
    """
    return tuple(_cause(selection, choice, joints) for choice in selection.choices)


def _cause(selection: Selection[F], choice: Choice, joints: Sequence[int] | None) -> Cause:
    fit = selection.fit
    terms = [term for term in choice.extension.terms if term in fit.terms]
    estimates = [fit.estimate(term) for term in terms]
    effect = float(np.sqrt(np.mean(fit.effect(terms) ** 2, axis=0)).max())

    def numbered(joint: int | None) -> int | None:
        return joint if joint is None or joints is None else int(joints[joint])

    return Cause(
        choice.extension.kind,
        numbered(choice.extension.joint),
        np.concatenate([value for value, _ in estimates]),
        np.concatenate([error for _, error in estimates]),
        choice.p_value,
        effect,
        tuple((rival.kind, numbered(rival.joint)) for rival in choice.rivals),
        next((term.place for term in terms if term.shape is Shape.LOAD), None),
    )
