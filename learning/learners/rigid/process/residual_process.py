"""A Gaussian process of the torque that a rigid chain leaves at one joint."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize

Array = NDArray[np.float64]

OWN_SIZE, OWN_LENGTH, SIZE = 0, 1, 2
"""Places in the hyperparameters: variance and length of the own angle, variance of all angles."""
EXPECTED = {"own size": 0.5, "own length": 0.8, "size": 0.3, "length": 2.0, "noise": 0.02}
"""Medians of the priors: variances relative to the residuals', lengths as chords of the circle.
The own angle comes first; a length of 2 is the diameter, beyond which an angle hardly matters."""
UNCERTAIN = {"own size": 1.5, "own length": 0.7, "size": 1.5, "length": 1.0, "noise": 2.0}
"""Standard deviations of their logarithms."""
LIMITS = {
    "own size": (-9.0, 4.0),
    "own length": (-2.0, 2.5),
    "size": (-9.0, 4.0),
    "length": (-2.0, 4.0),
    "noise": (-14.0, 1.0),
}
"""Of the logarithms."""
JITTER = 1e-7
"""Added to the variance of the noise, relative to the residuals'."""
MOST_SEARCHED = 150
"""Hyperparameters are sought on at most so many samples; the process is conditioned on all."""
ITERATIONS = 60


@dataclass(frozen=True, eq=False)
class ResidualProcess:
    """A process of one joint's torque, conditioned on residuals.

    Attributes
    ----------
    joint : int
        Number of the joint, from 0.
    q : (m, n) array
        Configurations of the samples [rad].
    residuals : (m,) array
        What the chain leaves there [N m].
    scale : float
        Unit of the process [N m].
    hyperparameters : (n + 4,) array
        Logarithms of: variance and length of the part of the joint's own angle, variance of the
        part of all angles, its lengths, variance of the noise.

    Notes
    -----
    The covariance is a function of angles on their circles, ``u = (cos q, sin q)``:

        a1 exp(-|u_j - u_j'|^2 / 2 l1^2) + a2 exp(-sum over i of |u_i - u_i'|^2 / 2 l_i^2).

    Cables and springs act by the angle of their own joint, which few samples tell; bending acts by
    all of them. C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning",
    2006, sections 2.2, 4.2.4 and 5.4.1.

    Examples
    --------
    A cable at the second joint:

    >>> q = np.random.default_rng(0).uniform(-2, 2, (25, 2))
    >>> process = ResidualProcess.fitted_to(1, q, 0.3 * np.sin(2 * q[:, 1]))
    >>> new = np.array([[1.0, -0.7]])
    >>> bool(np.abs(process.mean(new) - 0.3 * np.sin(-1.4)).max() < 0.01)
    True
    """

    joint: int
    q: Array
    residuals: Array
    scale: float
    hyperparameters: Array

    @classmethod
    def fitted_to(
        cls,
        joint: int,
        q: Array,
        residuals: Array,
        *,
        slopes: Array | None = None,
        noise: float | None = None,
        start: Array | None = None,
    ) -> ResidualProcess:
        """The process whose hyperparameters are most probable.

        Parameters
        ----------
        joint, q, residuals
            As the attributes.
        slopes : (m, p) array, optional
            Derivatives of the residuals by what was fitted to them before: what these directions
            hold says nothing of the process (restricted likelihood).
        noise : float, optional
            Standard deviation of the torque where it is known [N m].
        start : (n + 4,) array, optional
            Hyperparameters to start from.
        """
        scale = float(np.std(residuals)) or float(np.abs(residuals).max()) or 1.0
        n = q.shape[1]
        limits = [LIMITS[name] for name in _names(n)]
        if noise is not None:
            known = float(np.clip(2.0 * np.log(max(noise / scale, 1e-7)), *limits[-1]))
            limits[-1] = (known, known)
        rows = _spread(len(q))
        fixed = None
        if slopes is not None:
            u, s, _ = np.linalg.svd(slopes[rows], full_matrices=False)
            fixed = u[:, s > 1e-6 * s.max(initial=1e-300)][:, : max(1, len(rows) // 3)]
        found = minimize(
            _cost,
            np.clip(_expected(n) if start is None else start, *np.transpose(limits)),
            (joint, _chords(q[rows], q[rows]), residuals[rows] / scale, fixed),
            jac=True,
            method="L-BFGS-B",
            bounds=limits,
            options={"maxiter": ITERATIONS},
        )
        return cls(joint, q, residuals, scale, np.asarray(found.x))

    def conditioned_on(self, q: Array, residuals: Array) -> ResidualProcess:
        """The same process, of other samples."""
        return ResidualProcess(self.joint, q, residuals, self.scale, self.hyperparameters)

    @property
    def size(self) -> float:
        """Standard deviation of the process before any sample [N m]."""
        own, _, everything = np.exp(self.hyperparameters[:3])
        return float(self.scale * np.sqrt(own + everything))

    @property
    def noise(self) -> float:
        """Standard deviation of the samples' errors [N m]."""
        return float(self.scale * np.exp(0.5 * self.hyperparameters[-1]))

    @cached_property
    def whitening(self) -> Array:
        """W (m, m) lower triangular: errors of residuals, times W, are independent of size 1."""
        return np.asarray(
            solve_triangular(self._factor, np.eye(len(self.q)), lower=True) / self.scale
        )

    @cached_property
    def weights(self) -> Array:
        """What covariances with the samples are multiplied by, (m,) [N m]."""
        solved = cho_solve((self._factor, True), self.residuals / self.scale)
        return np.asarray(solved * self.scale)

    def mean(self, q: Array) -> Array:
        """Of the process at configurations (m, n) [rad], (m,) [N m]."""
        return np.asarray(self.covariance(q) @ self.weights)

    def covariance(self, q: Array) -> Array:
        """Between configurations (k, n) and the samples, (k, m), in units of ``scale`` squared."""
        return np.asarray(sum(_parts(self.hyperparameters, _chords(q, self.q), self.joint)))

    @cached_property
    def _factor(self) -> Array:
        K = self.covariance(self.q)
        K[np.diag_indices(len(K))] += np.exp(self.hyperparameters[-1]) + JITTER
        return np.asarray(np.linalg.cholesky(K))


def _names(joints: int) -> list[str]:
    return ["own size", "own length", "size", *["length"] * joints, "noise"]


def _expected(joints: int) -> Array:
    return np.log([EXPECTED[name] for name in _names(joints)])


def _spread(rows: int) -> NDArray[np.int64]:
    """Return all samples, or as many as hyperparameters need, the same ones each time."""
    if rows <= MOST_SEARCHED:
        return np.arange(rows)
    return np.sort(np.random.default_rng(rows).choice(rows, MOST_SEARCHED, replace=False))


def _chords(a: Array, b: Array) -> Array:
    """Squared chords between the angles of configurations (m, n) and (k, n), (m, k, n)."""
    return 2.0 - 2.0 * np.cos(a[:, None] - b[None])


def _parts(x: Array, chords: Array, joint: int) -> tuple[Array, Array]:
    """Covariances by the own angle and by all angles."""
    own, own_length, size = np.exp(x[[OWN_SIZE, OWN_LENGTH, SIZE]])
    alone = own * np.exp(chords[..., joint] * (-0.5 / own_length**2))
    return alone, size * np.exp(chords @ (-0.5 * np.exp(-2.0 * x[3:-1])))


def _cost(
    x: Array, joint: int, chords: Array, values: Array, fixed: Array | None
) -> tuple[float, Array]:
    """Negative logarithm of the posterior density of hyperparameters, and its gradient."""
    alone, together = _parts(x, chords, joint)
    noise = np.exp(x[-1])
    K = alone + together
    K[np.diag_indices(len(K))] += noise + JITTER
    factor = cho_factor(K, lower=True)
    inverse = cho_solve(factor, np.eye(len(K)))
    cost = float(np.log(np.diag(factor[0])).sum())
    if fixed is not None:
        across = inverse @ fixed
        normal = fixed.T @ across
        cost += 0.5 * float(np.linalg.slogdet(normal)[1])
        inverse = inverse - across @ np.linalg.solve(normal, across.T)
    solved = inverse @ values
    cost += 0.5 * float(values @ solved)
    change = inverse - np.outer(solved, solved)
    gradient = np.empty_like(x)
    by_own = change * alone
    gradient[OWN_SIZE] = 0.5 * by_own.sum()
    gradient[OWN_LENGTH] = 0.5 * np.sum(by_own * chords[..., joint]) * np.exp(-2.0 * x[OWN_LENGTH])
    by_all = change * together
    gradient[SIZE] = 0.5 * by_all.sum()
    gradient[3:-1] = 0.5 * np.exp(-2.0 * x[3:-1]) * (by_all.ravel() @ chords.reshape(K.size, -1))
    gradient[-1] = 0.5 * noise * np.trace(change)
    names = _names(len(x) - 4)
    away = (x - _expected(len(x) - 4)) / [UNCERTAIN[name] for name in names]
    return cost + 0.5 * float(away @ away), gradient + away / [UNCERTAIN[name] for name in names]
