"""Local linear map: the paper's online learner (section 5.3), with symmetries and replay."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.local_linear.cell_list import (
    make_cell_list,
    sees_several_images,
    with_room,
)
from isotorque.learning.learners.local_linear.cell_list_search import enter
from isotorque.learning.learners.local_linear.predict_kernels import (
    Rule,
    make_scratch,
    predict_batch,
    slope_batch,
)
from isotorque.learning.learners.local_linear.update_kernels import train
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
    some_weight,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

FIRST_ROOM = 64  # prototypes; doubled whenever it runs out


class LocalLinearMap(TorqueRegressor, SavedLearner):
    """Blend of local linear functions around prototypes that appear where samples do (Eq. 17-22).

    Parameters
    ----------
    radius : float
        d: a sample this far from all prototypes becomes one [rad]; unit of Eq. 17.
    kernel_width : float
        kappa: responsibilities are ``exp(-(r / (kappa d))^2)``. 1 is the paper's Eq. 18; 1.5 to 2
        lowers the best reachable error from some 10 mNm to 0.1 mNm and wants replay.
    learning_rate : float
        eta of Eq. 20. Being the gradient of a square, one step moves by ``2 eta``; it is stable
        while ``2 eta w |phi|^2 < 2`` with the feature vector phi (|phi|^2 is near 0.2).
    inner_iterations : int or None
        Gradient steps per sample (the paper's LLM_it); None: until the error of the sample has
        vanished. The features stay fixed meanwhile, so any number of steps is done at the cost of
        one: k steps move by ``(1 - (1 - 2 eta w |phi|^2)^k) / |phi|^2`` times error and feature.
    relaxation : float
        Share of the error of a sample that is taken away when ``inner_iterations`` is None;
        less than 1 where labels are noisy.
    replay : int
        Remembered samples that are learned again after every new one, with weight 1.
    memory : int
        Samples remembered for replay; when full, every sample seen is kept with equal
        probability (reservoir sampling).
    group : SymmetryGroup or None
        Relations to exploit: every sample is learned with all its symmetric copies, and distances
        are those the group leaves invariant.
    cutoff : float
        Responsibilities are zero beyond this many kernel widths, which changes the estimate by
        some ``exp(-cutoff^2)``; 6 is the printed formula to double precision.
    looped : bool
        Do inner iterations one by one (the closed form gives the same).
    random_state : int
        Seed of the choice of samples to be replayed.

    Notes
    -----
    Prefer it where the torque is more than rigid gravity, where samples never stop coming and
    each may cost microseconds at most: the cost of an update does not depend on the number of
    prototypes. Where samples are dear, `RecursiveLeastSquares` needs some 20 times fewer.

    Angles are periodic. With a group, coordinates are y = B q and distances the group's
    (``SymmetryCoordinates``); without one, Eq. 17-22 hold as printed in q. Readings of the paper:
    slopes are W = J d, and J includes the derivative of the responsibilities; the prototype is
    added before the gradient step; the test of Eq. 22 is made for every symmetric copy. A query
    beyond the reach of all kernels is answered by the nearest local functions.

    References
    ----------
    Rayyes, Kubus, Steil (2018), "Learning Inverse Statics Models Efficiently With Symmetry-Based
    Exploration", Frontiers in Neurorobotics 12:68, section 5.3. Rolf, Steil, Gienger (2011),
    "Online Goal Babbling for rapid bootstrapping of inverse models in high dimensions".

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-np.pi, np.pi, (4000, 1))
    >>> pendulum = LocalLinearMap(radius=0.3, inner_iterations=None, kernel_width=1.5)
    >>> pendulum = pendulum.partial_fit(q, 5.0 * np.cos(q))
    >>> bool(np.abs(pendulum.predict(q) - 5.0 * np.cos(q)).max() < 0.05)
    True
    """

    def __init__(
        self,
        radius: float = 0.15,
        *,
        kernel_width: float = 1.0,
        learning_rate: float = 0.5,
        inner_iterations: int | None = 1,
        relaxation: float = 1.0,
        replay: int = 0,
        memory: int = 20_000,
        group: GroupArrays | None = None,
        cutoff: float = 4.0,
        looped: bool = False,
        random_state: int = 0,
    ) -> None:
        self.radius = radius
        self.kernel_width = kernel_width
        self.learning_rate = learning_rate
        self.inner_iterations = inner_iterations
        self.relaxation = relaxation
        self.replay = replay
        self.memory = memory
        self.group = group
        self.cutoff = cutoff
        self.looped = looped
        self.random_state = random_state

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> LocalLinearMap:
        """Forget everything, then learn the samples in their order.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].
        sample_weight : (m,) array_like, optional
            Weights w_dir of Eq. 21.

        Returns
        -------
        LocalLinearMap
            Itself.
        """
        some_weight(sample_weight)
        if hasattr(self, "n_outputs_"):
            del self.n_outputs_
        return self.partial_fit(X, y, sample_weight)

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> LocalLinearMap:
        """Learn further samples in their order; arguments as in ``fit``.

        Raises
        ------
        InputError
            If a number is NaN or infinite, or a parameter of the learner is unusable. Nothing
            has been learned then.
        """
        first = not hasattr(self, "n_outputs_")
        if first:
            self._check_parameters()
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=first)
        if first:
            self._start(q.shape[1], torque.shape[1], np.asarray(y).ndim == 1)
        draws = self._random.random((len(q), 1 + self.replay if self.replay else 0))
        progress = np.zeros(3, dtype=np.int64)
        while not train(
            self._grid,
            self._counts,
            self._parameters,
            self._symmetries,
            q,
            torque,
            weights,
            self._memory_q,
            self._memory_torque,
            self._stored,
            draws,
            self._scratch,
            self._rule,
            progress,
        ):
            self._make_room(2 * len(self._parameters))
        self.n_samples_seen_ += len(q)
        return self

    def predict(self, X: Any) -> Array:
        """Torques (m, n) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        result = np.empty((len(q), self.n_outputs_))
        predict_batch(
            self._grid,
            self._counts,
            self._parameters,
            self._coordinates.coordinates(q),
            self._scratch,
            self._rule,
            result,
        )
        return result[:, 0] if self._flat else result

    def jacobian(self, X: Any) -> Array:
        """Estimated stiffness d torque / d q, (m, n, n) [N m / rad], the map's exact derivative."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        result = np.empty((len(q), self.n_outputs_, self._coordinates.rank))
        slope_batch(
            self._grid,
            self._counts,
            self._parameters,
            self._coordinates.coordinates(q),
            self._scratch,
            self._rule,
            result,
        )
        return np.asarray(result @ (self._coordinates.isometry @ self._coordinates.basis))

    @property
    def n_prototypes_(self) -> int:
        """Number of local linear functions M."""
        require_fitted(self)
        return int(self._counts[0])

    @property
    def prototypes_(self) -> Array:
        """Coordinates y = B q of the prototypes (q without a group) [rad], shape (M, r)."""
        return self._grid.point[: self.n_prototypes_].copy()

    @property
    def offsets_(self) -> Array:
        """Offsets o [N m], shape (M, n)."""
        return self._parameters[: int(self._counts[0]), :, 0].copy()

    @property
    def slopes_(self) -> Array:
        """Slopes W [N m per local unit], shape (M, n, r)."""
        return self._parameters[: int(self._counts[0]), :, 1:].copy()

    def _arrays(self) -> dict[str, NDArray]:
        stored = int(self._stored[0])
        return {
            "prototypes": self.prototypes_,
            "offsets": self.offsets_,
            "slopes": self.slopes_,
            "memory_q": self._memory_q[:stored].copy(),
            "memory_torque": self._memory_torque[:stored].copy(),
        }

    def _counters(self) -> dict[str, Any]:
        return {
            "offered_to_memory": int(self._stored[1]),
            "generator": self._random.bit_generator.state,
        }

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        points = arrays["prototypes"]
        self._make_room(max(FIRST_ROOM, 2 * len(points)))
        self._parameters[: len(points), :, 0] = arrays["offsets"]
        self._parameters[: len(points), :, 1:] = arrays["slopes"]
        for number, point in enumerate(points):
            self._counts[1] = enter(self._grid, self._counts[1], number, point)
        self._counts[0] = len(points)
        stored = len(arrays["memory_q"])
        self._memory_q[:stored] = arrays["memory_q"]
        self._memory_torque[:stored] = arrays["memory_torque"]
        self._stored[:] = stored, state["offered_to_memory"]
        self._random.bit_generator.state = state["generator"]

    def _check_parameters(self) -> None:
        for name in ("radius", "kernel_width", "learning_rate", "cutoff"):
            require(self, name, 0 < getattr(self, name) < np.inf, "a number > 0")
        steps, reach = self.inner_iterations, self.cutoff * self.kernel_width
        require(self, "inner_iterations", steps is None or steps >= 1, "None or at least 1")
        require(
            self, "looped", not self.looped or steps is not None, "a number of inner iterations"
        )
        require(self, "relaxation", 0 < self.relaxation < 2, "0 < number < 2")
        require(self, "replay", self.replay >= 0, "at least 0")
        require(self, "memory", self.memory >= 1, "at least 1")
        # Neighbours up to 2 d away must be seen (Eq. 22).
        require(self, "cutoff", reach >= 2, f"at least {2 / self.kernel_width} here")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if self.group is not None and outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        self._coordinates = SymmetryCoordinates.of(self.group, joints)
        symmetric = self._coordinates
        self._symmetries = (
            symmetric.basis,
            symmetric.A_sat,
            symmetric.d_sat,
            symmetric.Y if outputs == joints else np.ones((1, outputs)),
        )
        kernel = self.kernel_width * self.radius
        self._grid = make_cell_list(symmetric.isometry, self.cutoff * kernel, self.radius)
        self._rule = Rule(
            (0.0,) * outputs,
            float(self.radius),
            float(kernel),
            float(self.learning_rate),
            0 if self.inner_iterations is None else int(self.inner_iterations),
            float(self.relaxation),
            bool(self.looped),
            sees_several_images(self._grid),
        )
        self._counts = np.zeros(2, dtype=np.int64)
        self._parameters = np.zeros((0, outputs, 1 + symmetric.rank))
        self._make_room(FIRST_ROOM)
        room = self.memory if self.replay else 0
        self._memory_q = np.zeros((room, joints))
        self._memory_torque = np.zeros((room, outputs))
        self._stored = np.zeros(2, dtype=np.int64)
        self._random = np.random.default_rng(self.random_state)
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0

    def _make_room(self, points: int) -> None:
        grown = np.zeros((points, *self._parameters.shape[1:]))
        grown[: len(self._parameters)] = self._parameters
        self._parameters = grown
        self._grid = with_room(self._grid, points)
        self._scratch = make_scratch(self._grid, grown.shape[1])
