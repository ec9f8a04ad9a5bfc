"""What joints carry beside gravity, known well enough to be taken off a measured torque."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Correction:
    """Torque ``c_j(q) = constant_j + rate_j q_j`` of every joint beside gravity.

    Attributes
    ----------
    constant : (n,) array
        Zero of a sensor, friction approached from one side [N m].
    rate : (n,) array
        Spring rates [N m/rad]. Where there are any, angles count as they are: a turn makes a
        difference.

    Examples
    --------
    >>> Correction([0.0, 0.3], [0.0, 0.1]).at([[0.5, 2.0]]).tolist()
    [[0.0, 0.5]]
    """

    constant: Array
    rate: Array

    def __init__(self, constant: ArrayLike, rate: ArrayLike | None = None) -> None:
        fixed = np.array(constant, dtype=float)
        rates = np.zeros(fixed.shape) if rate is None else np.array(rate, dtype=float)
        for name, value in (("constant", fixed), ("rate", rates)):
            if value.shape != fixed.shape or value.ndim != 1:
                raise InputError("correction", f"shape of {name}", value.shape, "(n,), both alike")
            if not np.isfinite(value).all():
                raise InputError("correction", name, value.tolist(), "finite numbers")
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def at(self, q: ArrayLike) -> Array:
        """Return the torques (..., n) [N m] at configurations (..., n) [rad], not wrapped."""
        return np.asarray(self.constant + self.rate * np.asarray(q, dtype=float))

    def same_as(self, other: Correction | None) -> bool:
        """Say whether both are one correction."""
        return other is not None and bool(
            np.array_equal(self.constant, other.constant) and np.array_equal(self.rate, other.rate)
        )

    def as_json(self) -> dict[str, list[float]]:
        """Return it as plain data, as relation files have it."""
        return {"constant": self.constant.tolist(), "rate": self.rate.tolist()}

    def in_words(self) -> str:
        """Return what is taken off, joint by joint.

        Examples
        --------
        >>> Correction([0.0, 0.3], [0.0, 0.1]).in_words()
        'c_2 = +0.3 +0.1 q2'
        """
        said = []
        for j, (constant, rate) in enumerate(zip(self.constant, self.rate, strict=True), 1):
            parts = [f"{constant:+.3g}"] if constant else []
            parts += [f"{rate:+.3g} q{j}"] if rate else []
            said += [f"c_{j} = {' '.join(parts)}"] if parts else []
        return ", ".join(said) or "c = 0"
