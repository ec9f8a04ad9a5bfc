"""Number of parameters of a chain of a kind, and of the poses that determine them."""

from __future__ import annotations

import numpy as np

from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel


def poses_needed(model: ChainModel) -> int:
    """Different poses that determine a chain of this kind and leave something to check it."""
    return -(-(most_parameters(model) + 1) // model.n)


def most_parameters(model: ChainModel) -> int:
    """Number of parameters that torques can tell apart, of a generic chain."""
    if model.n == 1:
        return 2 + len(model.columns)
    firsts = int(np.sum(model.parents < 0))
    gains = max(int(model.free_gains.sum()) - 1, 0)
    return 4 * model.n - firsts + gains + len(model.columns)
