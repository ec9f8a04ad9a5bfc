"""The online learners by the names the command line knows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from symbolic.errors import InputError
from symbolic.relations import SymmetryGroup


def _local_linear_map(group: SymmetryGroup | None) -> Any:
    from learning.learners.local_linear_map import LocalLinearMap

    return LocalLinearMap(radius=0.15, group=group)


def _local_linear_map_it(group: SymmetryGroup | None) -> Any:
    from learning.learners.local_linear_map import LocalLinearMap

    return LocalLinearMap(
        radius=0.3,
        kernel_width=2.5,
        inner_iterations=None,
        relaxation=0.6,
        replay=60,
        group=group,
    )


def _recursive_least_squares(group: SymmetryGroup | None) -> Any:
    from learning.learners.recursive_least_squares import RecursiveLeastSquares

    return RecursiveLeastSquares(group=group)


ONLINE_LEARNERS: dict[str, Callable[[SymmetryGroup | None], Any]] = {
    "local-linear-map": _local_linear_map,
    "local-linear-map-it": _local_linear_map_it,
    "recursive-least-squares": _recursive_least_squares,
}
"""Names and factories; every factory takes the group to exploit (None: no symmetries)."""

EQUIVARIANT_LEARNERS = frozenset({"recursive-least-squares"})
"""Learners whose predictions obey the relations they exploit exactly."""


def online_learner(name: str, group: SymmetryGroup | None) -> Any:
    """Return a fresh online learner.

    Parameters
    ----------
    name
        ``local-linear-map``: Eq. 17-22 as printed. ``local-linear-map-it``: each sample learned
        to convergence, wider kernels and replay. ``recursive-least-squares``: all parameters
        jointly, on an exactly equivariant basis.
    group
        Relations to exploit.

    Raises
    ------
    InputError
        If there is no learner of that name.

    Examples
    --------
    >>> online_learner("local-linear-map", None).radius
    0.15
    """
    if name not in ONLINE_LEARNERS:
        raise InputError("learner", "name", name, ", ".join(sorted(ONLINE_LEARNERS)))
    return ONLINE_LEARNERS[name](group)
