"""Number of parameters of a chain of a kind, and of the poses that determine them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from isotorque.learning.learners.rigid.fitting.chain_parameters import serial
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel


def poses_needed(model: ChainModel) -> int:
    """Different poses that determine a chain of this kind and leave something to check it."""
    return -(-(most_parameters(model) + 1) // model.n)


def fewest_poses(joints: int, parents: Sequence[int] | None = None) -> int:
    """Return `poses_needed` of an arm whose sensors have neither gains nor offsets.

    Examples
    --------
    >>> [fewest_poses(n) for n in (1, 2, 3, 7)]
    [3, 4, 4, 4]
    """
    model = ChainModel(
        serial(joints) if parents is None else np.asarray(parents),
        np.ones(joints),
        np.zeros(joints, dtype=bool),
        (),
    )
    return poses_needed(model)


def most_parameters(model: ChainModel) -> int:
    """Number of parameters that torques can tell apart, of a generic chain."""
    if model.n == 1:
        return 2 + len(model.columns)
    firsts = int(np.sum(model.parents < 0))
    gains = max(int(model.free_gains.sum()) - 1, 0)
    return 4 * model.n - firsts + gains + len(model.columns)
