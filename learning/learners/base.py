"""Learners as arrays and plain numbers, to be saved, and back."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from isotorque.learning.learners.sample_checks import require_fitted
from isotorque.learning.learners.symmetry_coordinates import SavedGroup, SymmetryCoordinates


class SavedLearner(BaseEstimator, ABC):
    """A learner with a ``group`` that can stop, be saved, and go on where it stopped.

    Subclasses say what there is to save beside settings, group and counters.

    Attributes
    ----------
    n_features_in_, n_outputs_ : int
        Number of joints and of torques per sample.
    n_samples_seen_ : int
        Samples learned, copies and replays not counted.
    """

    group: Any
    n_features_in_: int
    n_outputs_: int
    n_samples_seen_: int
    _flat: bool
    _coordinates: SymmetryCoordinates

    def to_arrays(self) -> dict[str, NDArray]:
        """Everything learned, as arrays; with ``parameters()`` all that a saved model needs."""
        require_fitted(self)
        group = {} if self.group is None else self._coordinates.to_arrays()
        return {**self._arrays(), **group}

    def parameters(self) -> dict[str, Any]:
        """Settings and counters as plain numbers (JSON), without the group."""
        require_fitted(self)
        settings = {k: v for k, v in self.get_params(deep=False).items() if k != "group"}
        state = {
            "joints": int(self.n_features_in_),
            "outputs": int(self.n_outputs_),
            "flat": bool(self._flat),
            "samples_seen": int(self.n_samples_seen_),
        }
        return {"settings": settings, "state": state | self._counters()}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray], parameters: Mapping[str, Any]) -> Self:
        """The learner that was saved, ready to go on learning where it stopped."""
        settings = dict(parameters["settings"])
        if "group_basis" in arrays:
            settings["group"] = SavedGroup.from_arrays(arrays)
        learner = cls(**settings)
        state = parameters["state"]
        learner._check_parameters()
        learner.n_features_in_ = state["joints"]
        learner._start(state["joints"], state["outputs"], state["flat"])
        learner._restore({k: np.array(v, dtype=float) for k, v in arrays.items()}, state)
        learner.n_samples_seen_ = state["samples_seen"]
        return learner

    def __getstate__(self) -> dict[str, Any]:
        if not hasattr(self, "n_outputs_"):
            return dict(self.get_params(deep=False))
        return {"group": self.group, "saved": (self.to_arrays(), self.parameters())}

    def __setstate__(self, state: dict[str, Any]) -> None:
        if "saved" in state:
            self.__dict__.update(type(self).from_arrays(*state["saved"]).__dict__)
            self.group = state["group"]
        else:
            self.__dict__.update(state)

    def _counters(self) -> dict[str, Any]:
        return {}

    @abstractmethod
    def _arrays(self) -> dict[str, NDArray]: ...

    @abstractmethod
    def _check_parameters(self) -> None: ...

    @abstractmethod
    def _start(self, joints: int, outputs: int, flat: bool) -> None: ...

    @abstractmethod
    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None: ...
