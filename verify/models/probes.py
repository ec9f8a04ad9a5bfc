"""Probes of a learned model: under symmetries, under whole turns, and at joint limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.verify.models.target_sets import TargetSet

Array = NDArray[np.float64]


def equivariance_error(
    predict: Callable[[Array], Array], group: SymmetryGroup, q: Array
) -> tuple[float, Array]:
    """Largest |predict(A q + d) - Y predict(q)| of any joint [N m], and where it is."""
    here = predict(q)
    worst, at = 0.0, q[0]
    for relation in group:
        error = np.abs(predict(relation.configuration(q)) - relation.torque(here))
        size = error.max(axis=1, initial=0.0)
        if size.max() > worst:
            worst, at = float(size.max()), q[int(np.argmax(size))]
    return worst, at


def periodicity_error(predict: Callable[[Array], Array], q: Array) -> tuple[float, Array]:
    """Largest change of a prediction by turns of -1, 0 or 1 per joint [N m], and where it is."""
    turns = np.random.default_rng(0).integers(-1, 2, q.shape)
    change = np.abs(predict(q + 2 * np.pi * turns) - predict(q))
    size = change.max(axis=1, initial=0.0)
    return float(size.max()), q[int(np.argmax(size))]


def moved_to_limits(dense: TargetSet, box: Array) -> TargetSet | None:
    """The dense set with one joint of each configuration moved to one of its limits (n, 2) [rad].

    None where every joint turns all the way round.
    """
    limited = np.flatnonzero(box[:, 1] - box[:, 0] < 2 * np.pi * (1 - 1e-9))
    if not len(limited):
        return None
    q = dense.q.copy()
    number = np.arange(len(q))
    joint = limited[number % len(limited)]
    q[number, joint] = box[joint, number // len(limited) % 2]
    return TargetSet("at joint limits", q)
