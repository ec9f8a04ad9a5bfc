"""Torque form: the interface of all exported models, from a configuration to torques."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import NumpySpace, Space

Array = NDArray[np.float64]
CHECKS = 100


class TorqueForm(Protocol):
    """A torque map as constant tables and one formula.

    Attributes
    ----------
    KIND : str
        Its name in files.
    FORMULA : str
        What is computed from the tables, in words a programmer can follow.
    """

    KIND: ClassVar[str]
    FORMULA: ClassVar[str]

    @property
    def joints(self) -> int:
        """Number of joints n."""

    @property
    def outputs(self) -> int:
        """Number of torques, one per joint for anything that moves an arm."""

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (n, 1) [N m] at a configuration (n, 1) [rad]."""

    def c_source(self) -> str:
        """C99: tables, static functions and ``isotorque_gravity``, without headers."""

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> Self:
        """The form with these tables."""


def evaluate(form: TorqueForm, q: Array) -> Array:
    """Torques (m, n) [N m] of a form at configurations (m, n) [rad], by NumPy, one by one."""
    space = NumpySpace()
    points = np.asarray(q, dtype=float)
    torques = [form.torque(space, point[:, None])[:, 0] for point in points]
    return np.array(torques).reshape(len(points), form.outputs)


def largest_difference(form: TorqueForm, predict: Callable[[Array], Array]) -> float:
    """How far a form is from what it was made of, at `CHECKS` configurations [N m]."""
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (CHECKS, form.joints))
    return float(np.abs(evaluate(form, q) - predict(q).reshape(CHECKS, -1)).max(initial=0.0))
