"""The paper's local linear map written down a second time: no cell list, no closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np

from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates

Array = np.ndarray


class LiteralMap:
    """Eq. 17-22 for angles, with a loop over all prototypes wherever the paper has a sum.

    Parameters
    ----------
    d : float
        A sample this far from all prototypes becomes one [rad].
    eta : float
        Learning rate.
    kappa : float
        Width of the kernels over d.
    iterations : int
        Gradient steps per sample.
    distance : (r, r) array
        L of the distance ``|L dy|``.
    group : SymmetryGroup, optional
        Relations: ``partial_fit`` makes every copy of a sample one update.
    """

    def __init__(
        self,
        d: float,
        eta: float,
        kappa: float = 1.0,
        iterations: int = 1,
        *,
        distance: Array,
        group: GroupArrays | None = None,
    ) -> None:
        self.d, self.eta, self.kappa, self.iterations = d, eta, kappa, iterations
        self.L, self.group = distance, group
        self.prototypes: Any = []
        self.o: Any = []
        self.W: Any = []

    @classmethod
    def like(cls, learner: LocalLinearMap) -> Any:
        """Settings, and what it has learned, from a local linear map without replay.

        Raises
        ------
        ValueError
            If the map learns in a way that Eq. 17-22 do not have.
        """
        steps = learner.inner_iterations
        if steps is None or learner.replay:
            raise ValueError("Eq. 17-22 have a number of inner iterations, and no replay")
        used = SymmetryCoordinates.of(learner.group, learner.n_features_in_)
        made = cls(
            learner.radius,
            learner.learning_rate,
            learner.kernel_width,
            steps,
            distance=used.isometry,
            group=used,
        )
        for known in zip(learner.prototypes_, learner.offsets_, learner.slopes_, strict=True):
            made.insert(*known)
        return made

    def partial_fit(self, X: Array, y: Array) -> Any:
        """Learn samples (m, n) [rad], (m, n) [N m] in their order, each with all its copies."""
        for q, torque in zip(X, y, strict=True):
            if self.group is None:
                self.learn(q, torque)
                continue
            group = self.group
            for A, shift, signs in zip(group.A_sat, group.d_sat, group.Y, strict=True):
                self.learn(A @ (group.basis @ q) + shift, signs * torque)
        return self

    def predict(self, X: Array) -> Array:
        """Torques (m, n) [N m] at configurations (m, n) [rad]."""
        basis = np.eye(np.shape(X)[1]) if self.group is None else self.group.basis
        return np.array([self.value(basis @ q) for q in X])

    def learn(self, y: Array, torque: Array, weight: float = 1.0) -> None:
        """One update (Eq. 19-22)."""
        flat = np.zeros((len(torque), len(y)))
        if not len(self.prototypes):
            self.insert(y, torque, flat)
        x = self.local(y)
        nearest = np.sqrt((x**2).sum(axis=1).min())
        if nearest >= 1:
            if nearest > 2:
                self.insert(y, torque, flat)
            else:
                self.insert(y, self.value(y), self.derivative(y))
            x = self.local(y)
        h = self.responsibilities(x)
        for _ in range(self.iterations):
            self.descend(x, h, 2 * self.eta * weight * (torque - self.blend(x, h)))

    def value(self, y: Array) -> Array:
        """Estimate of Eq. 18."""
        x = self.local(y)
        return self.blend(x, self.responsibilities(x))

    def responsibilities(self, x: Array) -> Array:
        """Normalised kernels of Eq. 18."""
        weights = np.exp(-np.sum(x**2, axis=1) / self.kappa**2)
        return weights / weights.sum()

    def local(self, y: Array) -> Array:
        """Offsets from all prototypes in units of d (Eq. 17)."""
        difference = [(y - p + np.pi) % (2 * np.pi) - np.pi for p in self.prototypes]
        return np.array([self.L @ x for x in difference]) / self.d

    def blend(self, x: Array, h: Array) -> Any:
        """Sum of the local functions, each by its responsibility."""
        return sum(h[i] * (self.W[i] @ x[i] + self.o[i]) for i in range(len(x)))

    def derivative(self, y: Array) -> Array:
        """dG/dx of Eq. 18 by the product and quotient rules, x in units of d."""
        x = self.local(y)
        weights = np.exp(-np.sum(x**2, axis=1) / self.kappa**2)
        total = weights.sum()
        d_weights = -2 * x / self.kappa**2 * weights[:, None]
        result = np.zeros((len(self.o[0]), len(y)))
        for i in range(len(x)):
            d_share = d_weights[i] / total - weights[i] / total**2 * d_weights.sum(axis=0)
            result += np.outer(self.W[i] @ x[i] + self.o[i], d_share)
            result += weights[i] / total * self.W[i]
        return result

    def descend(self, x: Array, h: Array, step: Array) -> None:
        """Move all parameters by a step, the error times twice the learning rate (Eq. 20, 21)."""
        for i in range(len(x)):
            self.o[i] = self.o[i] + h[i] * step
            self.W[i] = self.W[i] + h[i] * np.outer(step, x[i])

    def insert(self, y: Array, offset: Array, slope: Array) -> None:
        """Add a prototype."""
        self.prototypes.append(np.array(y))
        self.o.append(np.array(offset))
        self.W.append(np.array(slope))


class ArrayMap(LiteralMap):
    """The same with NumPy's array operations over all prototypes in place of the loops."""

    def local(self, y: Array) -> Array:
        """Offsets from all prototypes in units of d (Eq. 17)."""
        difference = (y - self.prototypes + np.pi) % (2 * np.pi) - np.pi
        return difference @ self.L.T / self.d

    def blend(self, x: Array, h: Array) -> Any:
        """Sum of the local functions, each by its responsibility."""
        return np.einsum("mij,mj->i", self.W, h[:, None] * x) + h @ self.o

    def derivative(self, y: Array) -> Array:
        """dG/dx of Eq. 18 by the product and quotient rules, x in units of d."""
        x = self.local(y)
        h = self.responsibilities(x)
        d_logs = -2 * x / self.kappa**2
        d_shares = h[:, None] * (d_logs - h @ d_logs)
        values = np.einsum("mij,mj->mi", self.W, x) + self.o
        return np.asarray(values.T @ d_shares + np.tensordot(h, self.W, 1))

    def descend(self, x: Array, h: Array, step: Array) -> None:
        """Move all parameters by a step, the error times twice the learning rate (Eq. 20, 21)."""
        moves = h[:, None] * step
        self.o += moves
        self.W += moves[:, :, None] * x[:, None, :]

    def insert(self, y: Array, offset: Array, slope: Array) -> None:
        """Add a prototype."""
        new = np.array(y)[None], np.array(offset)[None], np.array(slope)[None]
        if not len(self.prototypes):
            self.prototypes, self.o, self.W = new
            return
        self.prototypes = np.concatenate([self.prototypes, new[0]])
        self.o = np.concatenate([self.o, new[1]])
        self.W = np.concatenate([self.W, new[2]])
