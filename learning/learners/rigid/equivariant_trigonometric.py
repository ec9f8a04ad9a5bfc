"""Linear regression on trigonometric polynomials with exactly the symmetries of a group."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.rigid.causes.beside_gravity import shown_beside
from isotorque.learning.learners.rigid.equivariant_basis import (
    multi_affine_frequencies,
    potential_basis,
    torque_basis,
)
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.learning.statistics.causes.extension import Shape
from isotorque.learning.statistics.causes.linear_model import ADDING
from isotorque.learning.statistics.poses import by_pose_and_side
from isotorque.learning.statistics.shrinkage import shrunk_least_squares
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]


class EquivariantTrigonometric(TorqueRegressor, SavedLearner):
    """The torque of a rigid arm up to its coefficients, which are found by least squares.

    Parameters
    ----------
    potential : bool
        Fit one potential, of which the torques are the derivatives; otherwise a function for
        every joint, for which the group is all that joins them.
    ridge : float
        Penalty on the squares of the coefficients, in units of one sample's worth; 0: as much as
        the residuals and the size of the torques call for (`shrunk_least_squares`): none for exact
        samples, and the smallest coefficients where the samples leave some open.
    group : SymmetryGroup or None
        Relations that the model shall have, exactly; frequencies are those of y = B q.

    Attributes
    ----------
    n_coefficients_ : int
        Numbers to be determined; samples give n equations each for a potential, one each per
        joint otherwise. Constants not counted.
    offsets_ : (n,) array
        Constant torques of the joints that the samples show beside a potential [N m]; 0 where they
        show none. ``predict`` contains them; gravity alone is ``predict(q) - offsets_``.

    Notes
    -----
    Parametric: gravity of a rigid arm with revolute joints *is* such a polynomial with
    frequencies in {-1, 0, 1}^n (docs/theory.md), so it contains the truth and is exact to
    rounding from as many equations as coefficients: on the 2R arm with its group one sample (a
    potential) or two (by joints), on the 3R one or three. Prefer it where kinematics and masses
    are not known but the arm is rigid. Springs, cables and bending are not in it, and its
    residuals say so; use ``SymmetricGaussianProcess`` or ``RecursiveLeastSquares`` then. Samples
    from a narrow region leave coefficients open; noise would make them huge, so they are kept as
    small as the torques, and ``standard_error`` says where nothing is known. What is predicted is
    the torque that would be measured: of a potential, which has the group, and a constant of every
    joint where the samples show one (`shown_beside`), say a sensor's zero, which is no gravity
    and has no symmetry. Rows of one pose count as one sample in standard errors. Without
    a group the number of frequencies grows as 3^n: up to six joints or so.

    Examples
    --------
    >>> q = np.array([[0.3, -1.0], [1.1, 0.4], [-2.0, 0.7], [0.2, 2.9]])
    >>> lower = 6.13 * np.cos(q.sum(axis=1))
    >>> torque = np.stack([18.39 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> arm = EquivariantTrigonometric().fit(q, torque)
    >>> bool(np.abs(arm.predict(q + 1.0) - [18.39, 0] * np.cos(q[:, :1] + 1.0)
    ...     - 6.13 * np.cos(q.sum(axis=1) + 2.0)[:, None]).max() < 1e-12)
    True
    """

    def __init__(
        self,
        potential: bool = True,
        *,
        ridge: float = 0.0,
        group: GroupArrays | None = None,
    ) -> None:
        self.potential = potential
        self.ridge = ridge
        self.group = group

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> EquivariantTrigonometric:
        """Fit to samples, forgetting what was before.

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
        EquivariantTrigonometric
            Itself.

        Raises
        ------
        InputError
            If a number is NaN or infinite, a parameter of the learner is unusable, or there is
            not one torque per joint for a potential or a group.
        """
        self._check_parameters()
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=True)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        self.n_samples_seen_ = len(q)
        q, torque, _, weights = by_pose_and_side(q, torque, None, weights)
        root = np.sqrt(weights)[:, None]
        self._roots: list[Array] = []
        self._largest = float(np.abs(torque).max(initial=0.0))
        self.offsets_ = np.zeros(self.n_outputs_)
        if self.potential:
            columns = self._gradients(q) @ self._bases[0]
            self._constant = self._constants_shown(q, torque, columns, weights)
            columns = self._with_constants(columns) * root[:, :, None]
            solution = self._solve(columns.reshape(torque.size, -1), (torque * root).ravel())
            count = self._bases[0].shape[1]
            self._coefficients = self._bases[0] @ solution[:count, None]
            self.offsets_[self._constant] = solution[count:]
        else:
            features = self._features(q) * root
            self._coefficients = np.zeros((features.shape[1], self.n_outputs_))
            for basis, joints in zip(self._bases, self._classes, strict=True):
                solution = self._solve(features @ basis, (torque * root)[:, joints])
                self._coefficients[:, joints] = basis @ solution
        return self

    def predict(self, X: Any) -> Array:
        """Measured torques (m, n) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        if self.potential:
            result = self._weighted_gradients(q) + self.offsets_
        else:
            result = self._features(q) @ self._coefficients
        return result[:, 0] if self._flat else result

    def standard_error(self, X: Any) -> Array | None:
        """Standard errors (m, n) [N m] of ``predict``, as far as the residuals tell.

        None for a loaded model, and where ``ridge`` was given.
        """
        require_fitted(self)
        if not getattr(self, "_roots", None):
            return None
        q = checked_configurations(self, X, first=False)
        result = np.zeros((len(q), self.n_outputs_))
        if self.potential:
            effect = self._with_constants(self._gradients(q) @ self._bases[0]) @ self._roots[0]
            return np.asarray(np.linalg.norm(effect, axis=2))
        for basis, joints, root in zip(self._bases, self._classes, self._roots, strict=True):
            error = np.linalg.norm(self._features(q) @ (basis @ root), axis=1)
            result[:, joints] = error[:, None]
        return result

    def jacobian(self, X: Any) -> Array:
        """Estimated stiffness d torque / d q, (m, n, n) [N m / rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        return np.stack(
            [f.hessian(q)[:, i] if self.potential else f.gradient(q) for i, f in self._functions()],
            axis=1,
        )

    def fitted_potential(self) -> TrigonometricPolynomial:
        """The potential [J] of gravity that was fitted, without terms below 1e-14 of the largest.

        Raises
        ------
        InputError
            If functions for every joint were fitted (``potential=False``).
        """
        require_fitted(self)
        require(self, "potential", self.potential, "True: only then there is one")
        return self._polynomial(self._coefficients[:, 0]).significant(1e-14)

    @property
    def n_coefficients_(self) -> int:
        """Numbers that the samples determine."""
        require_fitted(self)
        if self.potential:
            return self._bases[0].shape[1]
        return sum(b.shape[1] * len(j) for b, j in zip(self._bases, self._classes, strict=True))

    def _constants_shown(
        self, q: Array, torque: Array, columns: Array, weights: Array
    ) -> NDArray[np.intp]:
        """Joints with a constant torque beside the potential, as far as samples show it."""
        k, phase = self._joint_frequencies, self._phases(q)

        def stiffness(x: Array, rows: NDArray[np.intp]) -> Array:
            a, b = np.split(self._bases[0] @ x, 2)
            weight = -np.cos(phase[rows]) * a - np.sin(phase[rows]) * b
            return np.einsum("mk,ki,kj->mij", weight, k, k, optimize=True)

        shown = shown_beside(q, torque, columns, weights, kinds=ADDING, stiffness_of=stiffness)
        found = {term.place for term in shown.terms if term.shape is Shape.CONSTANT}
        springs = {term.place for term in shown.terms if term.shape is Shape.ANGLE}
        return np.array(sorted(found - springs), dtype=np.intp)

    def _with_constants(self, columns: Array) -> Array:
        """Columns (m, n, p) of the potential, and those of the constants that were seen."""
        one = np.eye(columns.shape[1])[:, self._constant]
        constants = np.broadcast_to(one, (len(columns), *one.shape))
        return np.concatenate([columns, constants], axis=2)

    def _functions(self) -> list[tuple[int, TrigonometricPolynomial]]:
        columns = [0] * self.n_outputs_ if self.potential else range(self.n_outputs_)
        made = {c: self._polynomial(self._coefficients[:, c]) for c in set(columns)}
        return [(i, made[c]) for i, c in enumerate(columns)]

    def _polynomial(self, coefficients: Array) -> TrigonometricPolynomial:
        a, b = np.split(coefficients, 2)
        return TrigonometricPolynomial(self._joint_frequencies, a, b)

    def _phases(self, q: Array) -> Array:
        return np.asarray(q @ self._joint_frequencies.T)

    def _features(self, q: Array) -> Array:
        """Cosines, then sines, (m, 2 K)."""
        phase = self._phases(q)
        return np.concatenate([np.cos(phase), np.sin(phase)], axis=1)

    def _gradients(self, q: Array) -> Array:
        """Derivatives of the features by the joints, (m, n, 2 K)."""
        phase, k = self._phases(q)[:, None], self._joint_frequencies.T
        return np.concatenate([-np.sin(phase) * k, np.cos(phase) * k], axis=2)

    def _weighted_gradients(self, q: Array) -> Array:
        phase = self._phases(q)
        a, b = np.split(self._coefficients[:, 0], 2)
        return np.asarray((np.cos(phase) * b - np.sin(phase) * a) @ self._joint_frequencies)

    def _solve(self, features: Array, targets: Array) -> Array:
        if not features.shape[1]:
            self._roots.append(np.zeros((0, 0)))
            return np.zeros((0, *targets.shape[1:]))
        if not self.ridge:
            solution, root = shrunk_least_squares(features, targets, self._largest)
            self._roots.append(root)
            return solution
        constants = len(self._constant) if self.potential else 0
        more = np.sqrt(self.ridge) * np.eye(features.shape[1] - constants, features.shape[1])
        features = np.concatenate([features, more])
        targets = np.concatenate([targets, np.zeros((len(more), *targets.shape[1:]))])
        return np.asarray(lstsq(features, targets, cond=1e-12, check_finite=False)[0])

    def _arrays(self) -> dict[str, NDArray]:
        return {
            "coefficients": self._coefficients.copy(),
            "frequencies": self._joint_frequencies,
            "offsets": self.offsets_.copy(),
        }

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        if not np.array_equal(arrays["frequencies"], self._joint_frequencies):
            raise InputError("saved model", "frequencies", "others", "those of its group")
        self._coefficients = arrays["coefficients"]
        self.offsets_ = arrays.get("offsets", np.zeros(self.n_outputs_))

    def _check_parameters(self) -> None:
        require(self, "ridge", 0 <= self.ridge < np.inf, "a number >= 0")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if (self.group is not None or self.potential) and outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        self._coordinates = SymmetryCoordinates.of(self.group, joints)
        frequencies = multi_affine_frequencies(self._coordinates.basis)
        rows = np.rint(self._coordinates.basis).astype(np.int64)
        self._joint_frequencies = frequencies @ rows
        if self.potential:
            self._bases = [potential_basis(self._coordinates, frequencies)]
            self._classes = [np.arange(joints)]
        else:
            signs = self._coordinates.Y if outputs == joints else np.ones((1, outputs))
            columns, member = np.unique(signs.T, axis=0, return_inverse=True)
            self._bases = [torque_basis(self._coordinates, frequencies, c) for c in columns]
            self._classes = [np.flatnonzero(member.ravel() == c) for c in range(len(columns))]
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0
