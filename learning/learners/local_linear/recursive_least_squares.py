"""Joint recursive least squares on the tied, exactly equivariant local linear basis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.local_linear.cell_list import make_cell_list, with_room
from isotorque.learning.learners.local_linear.cell_list_search import enter
from isotorque.learning.learners.local_linear.predict_kernels import make_scratch
from isotorque.learning.learners.local_linear.square_root_filter import SquareRootFilter
from isotorque.learning.learners.local_linear.tied_basis import (
    copies_of,
    least_distance,
    tied_features_batch,
)
from isotorque.learning.learners.memory.sample_dictionary import SampleDictionary
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

#: Prototypes for which there is room at first; doubled whenever it runs out.
FIRST_ROOM = 32


@dataclass(eq=False)
class _Solved:
    """Filters and parameters of each class of joints; brought up to date when asked for.

    Attributes
    ----------
    filters : list of SquareRootFilter
        Of no use while ``stale``: a prototype has appeared since.
    solution : list of (F, joints) arrays, or None
        Parameters; None where samples have come since.
    stale : bool
        Whether all must be solved anew.
    """

    filters: list[SquareRootFilter]
    solution: list[Array] | None = None
    stale: bool = True


class RecursiveLeastSquares(TorqueRegressor, SavedLearner):
    """All local linear functions fitted together, exactly equivariant, from few samples.

    Parameters
    ----------
    radius : float
        d: a sample whose orbit is at least this far from all prototypes becomes one [rad].
    kernel_width : float
        kappa: kernels are ``exp(-(r / (kappa d))^2)``.
    ridge : float
        Ridge on the parameters: the variance of the labels' errors over that of the parameters.
        1e-12 for labels without noise (their rounding), 1e-6 to 1e-4 for noisy ones.
    memory : int
        Samples kept (a ``SampleDictionary``) from which all is solved anew when a prototype has
        appeared, since that changes the features of every sample.
    group : SymmetryGroup or None
        Relations that the map shall have, exactly.
    cutoff : float
        Kernels are taken as zero beyond this many widths.

    Attributes
    ----------
    n_prototypes_ : int
        Number of prototypes, one per orbit.
    prototypes_ : (M, r) array
        Their coordinates y = B q [rad].
    n_samples_seen_ : int
        Samples learned, copies not counted.

    Notes
    -----
    Prefer it where samples are dear: some 60 on the 2R and 150 on the 3R arm reach what the local
    linear map needs thousands for. It wants a torque map that is smooth on the scale of
    ``radius``, and a group that really holds: a symmetry that is not there is enforced all the
    same. The number of parameters is ``M (1 + r)`` with M growing like the volume of the
    fundamental domain over ``radius^r``: meant for up to four coordinates or so. An update costs
    ``O(F^2)`` for F parameters, independent of the number of samples seen.

    The estimate is a blend of local linear functions around prototypes as in ``LocalLinearMap``,
    but each stands for its whole orbit (``tied_basis``), the kernel is wide, and all parameters
    are found together (``SquareRootFilter``) instead of by gradient steps.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-np.pi, np.pi, (40, 1))
    >>> pendulum = RecursiveLeastSquares().fit(q, 5.0 * np.cos(q))
    >>> bool(np.abs(pendulum.predict(q) - 5.0 * np.cos(q)).max() < 1e-3)
    True
    """

    _solved: _Solved

    def __init__(
        self,
        radius: float = 0.7,
        *,
        kernel_width: float = 2.0,
        ridge: float = 1e-12,
        memory: int = 1000,
        group: GroupArrays | None = None,
        cutoff: float = 5.0,
    ) -> None:
        self.radius = radius
        self.kernel_width = kernel_width
        self.ridge = ridge
        self.memory = memory
        self.group = group
        self.cutoff = cutoff

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> RecursiveLeastSquares:
        """Forget everything, then learn the samples in their order.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].
        sample_weight : (m,) array_like, optional
            Weights of the squared errors.

        Returns
        -------
        RecursiveLeastSquares
            Itself.
        """
        some_weight(sample_weight)
        if hasattr(self, "n_outputs_"):
            del self.n_outputs_
        return self.partial_fit(X, y, sample_weight)

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> RecursiveLeastSquares:
        """Learn further samples; arguments as in ``fit``.

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
        for sample in zip(q, torque, weights, strict=True):
            self._dictionary.add(*sample)
            if self._offer_prototype(sample[0]):
                self._solved.stale = True
        if not self._solved.stale:
            self._take_in(q, torque, weights)
        self._solved.solution = None
        self.n_samples_seen_ += len(q)
        return self

    def predict(self, X: Any) -> Array:
        """Torques (m, n) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        solution = self._solve()
        features = self._features(q)
        result = np.empty((len(q), self.n_outputs_))
        for c, joints in enumerate(self._classes):
            result[:, joints] = features[c] @ solution[c]
        return result[:, 0] if self._flat else result

    @property
    def n_prototypes_(self) -> int:
        """Number of prototypes."""
        require_fitted(self)
        return int(self._counts[0])

    @property
    def prototypes_(self) -> Array:
        """Coordinates of the prototypes [rad], shape (M, r)."""
        return self._grid.point[: self.n_prototypes_].copy()

    def _arrays(self) -> dict[str, NDArray]:
        self._solve()
        arrays = {"prototypes": self.prototypes_, **self._dictionary.to_arrays()}
        for c, least_squares in enumerate(self._solved.filters):
            arrays[f"factor_{c}"] = least_squares.factor
            arrays[f"right_{c}"] = least_squares.right
        return arrays

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        for point in arrays["prototypes"]:
            self._add_prototype(point)
        self._dictionary.restore(arrays)
        self._solved.filters = [SquareRootFilter(0, 0, self.ridge) for _ in self._classes]
        for c, least_squares in enumerate(self._solved.filters):
            least_squares.factor = arrays[f"factor_{c}"]
            least_squares.right = arrays[f"right_{c}"]
        self._solved.stale = False

    def _check_parameters(self) -> None:
        for name in ("radius", "kernel_width", "ridge", "cutoff"):
            require(self, name, 0 < getattr(self, name) < np.inf, "a number > 0")
        require(self, "memory", self.memory >= 1, "at least 1")
        # Neighbours up to d away must be seen.
        reach = self.cutoff * self.kernel_width
        require(self, "cutoff", reach >= 1, f"at least {1 / self.kernel_width} here")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if self.group is not None and outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        symmetric = self._coordinates = SymmetryCoordinates.of(self.group, joints)
        signs = symmetric.Y if outputs == joints else np.ones((1, outputs))
        columns, member = np.unique(signs.T, axis=0, return_inverse=True)
        self._signs = np.ascontiguousarray(columns)
        self._classes = [np.flatnonzero(member.ravel() == c) for c in range(len(columns))]
        self._symmetries = (symmetric.basis, symmetric.A_sat, symmetric.d_sat)
        self._images = np.empty((symmetric.order, symmetric.rank))
        self._grid = make_cell_list(
            symmetric.isometry,
            self.cutoff * self.kernel_width * self.radius,
            1.5 * self.radius,
        )
        self._counts = np.zeros(2, dtype=np.int64)
        self._make_room(FIRST_ROOM)
        self._dictionary = SampleDictionary(self.memory, self.group)
        self._solved = _Solved([])
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0

    def _make_room(self, points: int) -> None:
        self._grid = with_room(self._grid, points)
        self._work = make_scratch(self._grid, self._signs.shape[0])

    def _offer_prototype(self, q: Array) -> bool:
        """Make q a prototype if no prototype's orbit is near; whether it became one."""
        copies_of(self._symmetries, q, self._images)
        if self._counts[0]:
            least = least_distance(self._grid, self._counts, self._images, self._work)
            if least < self.radius**2:
                return False
        self._add_prototype(self._coordinates.coordinates(q))
        return True

    def _add_prototype(self, y: Array) -> None:
        if self._counts[0] == len(self._grid.point):
            self._make_room(2 * int(self._counts[0]))
        self._counts[1] = enter(self._grid, self._counts[1], self._counts[0], y)
        self._counts[0] += 1

    def _features(self, q: Array) -> Array:
        """Features (c, m, F) of configurations (m, n), for each class of joints."""
        count = int(self._counts[0]) * (1 + self._coordinates.rank)
        result = np.empty((len(self._classes), len(q), count))
        tied_features_batch(
            self._grid,
            self._counts,
            self._symmetries,
            self._signs,
            q,
            self.radius,
            self.kernel_width * self.radius,
            self._work,
            result,
        )
        return result

    def _take_in(self, q: Array, torque: Array, weights: Array) -> None:
        features = self._features(q)
        for c, joints in enumerate(self._classes):
            for row, target, weight in zip(features[c], torque[:, joints], weights, strict=True):
                self._solved.filters[c].update(row, target, weight)

    def _solve(self) -> list[Array]:
        """Parameters (F, joints of the class) for each class of joints."""
        if self._solved.stale:
            root = np.sqrt(self._dictionary.weights)[:, None]
            features = self._features(self._dictionary.q)
            self._solved.filters = [
                SquareRootFilter.from_samples(
                    root * features[c], root * self._dictionary.torque[:, joints], self.ridge
                )
                for c, joints in enumerate(self._classes)
            ]
            self._solved.stale = False
            self._solved.solution = None
        if self._solved.solution is None:
            self._solved.solution = [
                least_squares.solution() for least_squares in self._solved.filters
            ]
        return self._solved.solution
