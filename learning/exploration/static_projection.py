"""Projection of a torque that cannot be held onto one that can (Algorithm 2, lines 17 and 18)."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

#: Steps and safety of the search for the boundary of the set of static torques.
BISECTIONS = 6
SAFE_SHARE = 0.7


class StaticTorques(Protocol):
    """Set of static torques as exploration needs it (``StaticTorqueSet``)."""

    def contains(self, torque: Any) -> Any:
        """Whether the torque (n,) [N m] is admissible."""
        ...

    def nearest(self, torque: Any) -> Any:
        """The nearest admissible torque (n,) [N m]."""
        ...

    def add(self, torque: Any) -> None:
        """The torque (n,) [N m] held the arm."""
        ...

    def mark_inadmissible(self, torque: Any) -> None:
        """The torque (n,) [N m] did not hold the arm."""
        ...


def nearest_admissible(known: StaticTorques | None, torque: Vector, to_boundary: bool) -> Vector:
    """The torque itself where admissible, else a torque near it that is.

    Parameters
    ----------
    known : StaticTorques or None
        Set of static torques; None: every torque is admissible.
    torque : (n,) array
        Wanted torque [N m].
    to_boundary : bool
        Whether to look, from the nearest torque ever held towards the wanted one, for the last
        admissible one (and then stay 30 % of the way behind it). The set is a continuum of
        which finitely many torques are stored: taking those alone leaves its fringe, where
        joints are near their largest torque, unexplored.

    Returns
    -------
    (n,) array
        The very object ``torque`` if it is admissible.
    """
    if known is None or known.contains(torque):
        return torque
    held = np.asarray(known.nearest(torque), dtype=float)
    if not to_boundary:
        return held
    inside, outside = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        if known.contains(held + middle * (torque - held)):
            inside = middle
        else:
            outside = middle
    return np.asarray(held + SAFE_SHARE * inside * (torque - held))
