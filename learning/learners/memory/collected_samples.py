"""A batch learner behind an exploration: an online learner leads, all samples are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class CollectedSamples:
    """Batch learner that stands behind an exploration: an online learner leads it.

    Parameters
    ----------
    leader
        Online learner that estimates torques on the way (``partial_fit``, ``predict``).
    make_batch : callable
        Returns a fresh batch learner (``fit``).

    Notes
    -----
    Every sample counts alike: the weights of an exploration (Eq. 16) say how well the arm moved
    where it was meant to, not how well a sample was measured.

    Examples
    --------
    >>> from sklearn.linear_model import LinearRegression
    >>> from types import SimpleNamespace
    >>> leader = SimpleNamespace(partial_fit=lambda X, y, w: None)
    >>> collected = CollectedSamples(leader, LinearRegression)
    >>> for q in (0.0, 1.0, 2.0):
    ...     _ = collected.partial_fit([[q]], [[3.0 * q]])
    >>> collected.fitted_learner().predict([[5.0]]).round(9).tolist()
    [[15.0]]
    """

    def __init__(self, leader: Any, make_batch: Callable[[], Any]) -> None:
        self._leader, self._make_batch = leader, make_batch
        self._q: list[Array] = []
        self._torque: list[Array] = []
        self._fitted: Any = None

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> CollectedSamples:
        """Keep samples (m, n) [rad], (m, n) [N m], and teach the leader."""
        self._q.append(np.array(X, dtype=float))
        self._torque.append(np.array(y, dtype=float))
        self._leader.partial_fit(X, y, sample_weight)
        self._fitted = None
        return self

    def predict(self, X: Any) -> Any:
        """Torques (m, n) [N m] as the leader estimates them."""
        return self._leader.predict(X)

    def fitted_learner(self) -> Any:
        """Return a batch learner fitted to all samples so far."""
        if self._fitted is None:
            learner = self._make_batch()
            self._fitted = learner.fit(np.concatenate(self._q), np.concatenate(self._torque))
        return self._fitted
