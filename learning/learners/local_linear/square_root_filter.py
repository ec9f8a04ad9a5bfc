"""Recursive least squares in square-root form: one triangular factor, updated by rotations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from isotorque.symbolic.common.compiled import compiled

Array = NDArray[np.float64]


class SquareRootFilter:
    """Least squares with a ridge, one observation at a time.

    Minimises ``sum_i w_i |t_i - theta^T phi_i|^2 + ridge |theta|^2``. Kept is the upper triangular
    R with ``R^T R = ridge I + sum w phi phi^T`` and ``z = R^-T (sum w phi t^T)``; a Givens
    rotation per feature takes a new observation in. Unlike the textbook's update of the inverse
    this never subtracts, so it stays accurate when R is as ill-conditioned as double precision
    can hold at all.

    Parameters
    ----------
    features : int
        Length F of phi.
    outputs : int
        Length k of the targets t.
    ridge : float
        Ridge > 0.

    References
    ----------
    Bierman (1977), "Factorization Methods for Discrete Sequential Estimation", chapter 4;
    Golub, Van Loan, "Matrix Computations", section 5.1.

    Examples
    --------
    >>> line = SquareRootFilter(2, 1, 1e-12)
    >>> for x in (0.0, 1.0, 2.0):
    ...     line.update(np.array([1.0, x]), np.array([3.0 + 2.0 * x]))
    >>> line.solution().ravel().round(6).tolist()
    [3.0, 2.0]
    """

    def __init__(self, features: int, outputs: int, ridge: float) -> None:
        self.factor: Array = np.sqrt(ridge) * np.eye(features)
        self.right: Array = np.zeros((features, outputs))

    @classmethod
    def from_samples(cls, phi: Array, targets: Array, ridge: float) -> SquareRootFilter:
        """The same after the (weighted) observations phi (m, F), targets (m, k), at once.

        Notes
        -----
        Householder QR of the stacked system, in place of m F rotations.
        """
        features, outputs = phi.shape[1], targets.shape[1]
        stacked = np.zeros((features + len(phi), features + outputs))
        stacked[:features, :features] = np.sqrt(ridge) * np.eye(features)
        stacked[features:, :features] = phi
        stacked[features:, features:] = targets
        upper: Array = np.asarray(np.linalg.qr(stacked, mode="r"))
        result = cls(features, outputs, ridge)
        result.factor = np.ascontiguousarray(upper[:features, :features])
        result.right = np.ascontiguousarray(upper[:features, features:])
        return result

    def update(self, phi: Array, targets: Array, weight: float = 1.0) -> None:
        """Take in one observation phi (F,), targets (k,) with a weight >= 0."""
        root = np.sqrt(weight)
        _rotate(self.factor, self.right, root * phi, root * targets)

    def solution(self) -> Array:
        """Theta (F, k)."""
        return np.asarray(solve_triangular(self.factor, self.right, check_finite=False))


@compiled
def _rotate(factor, right, row, targets):
    """Rotate the observation into the triangle; ``row`` and ``targets`` are used up."""
    features = row.size
    for k in range(features):
        if row[k] == 0.0:
            continue
        length = np.hypot(factor[k, k], row[k])
        c = factor[k, k] / length
        s = row[k] / length
        factor[k, k] = length
        for j in range(k + 1, features):
            old = factor[k, j]
            factor[k, j] = c * old + s * row[j]
            row[j] = c * row[j] - s * old
        for j in range(targets.size):
            old = right[k, j]
            right[k, j] = c * old + s * targets[j]
            targets[j] = c * targets[j] - s * old
