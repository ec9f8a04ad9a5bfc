"""Periodic covariance function with exactly the symmetries of a group."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.gaussian_process.kernels import Hyperparameter, Kernel

from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates

Array = NDArray[np.float64]


class SymmetrisedPeriodicKernel(Kernel):
    """Covariance of periodic functions with ``f(A y + d) = s f(y)`` for every relation.

    Parameters
    ----------
    coordinates : SymmetryCoordinates
        The group (without symmetries: the identity alone).
    output : int
        Joint whose signs s are meant (column of Y).
    length_scale : float
        Unit of distance on the torus [rad], the only hyperparameter.
    length_scale_bounds : (float, float) or "fixed"
        Where it is sought.

    Notes
    -----
    With ``D(y, y') = sum over rows a of w_a (1 - cos a.(y - y'))``, the rows a of all A_sat, each
    with its share w_a of them times the rank, the base kernel ``exp(-D / l^2)`` is the
    squared-exponential kernel of points on circles, so positive definite, and the group leaves it
    invariant. Its average

        k(y, y') = sum over g of s_g exp(-D(A_g y + d_g, y') / l^2)

    is the covariance of functions that are averaged over the group, hence has the symmetry in both
    arguments; the factor 1 / order is left to the amplitude.

    References
    ----------
    D. Ginsbourger, O. Roustant, N. Durrande, "On degeneracy and invariances of random fields paths
    with applications in Gaussian process modelling", J. Stat. Plan. Inference 170 (2016).
    D. J. C. MacKay, "Introduction to Gaussian processes", 1998 (the periodic kernel).

    Examples
    --------
    >>> kernel = SymmetrisedPeriodicKernel(SymmetryCoordinates.of(None, 1), 0, 1.0)
    >>> kernel(np.array([[0.0]]), np.array([[0.0], [2 * np.pi], [np.pi]])).round(3).tolist()
    [[1.0, 1.0, 0.135]]
    """

    def __init__(
        self,
        coordinates: SymmetryCoordinates,
        output: int,
        length_scale: float = 1.0,
        length_scale_bounds: tuple[float, float] | str = (0.05, 50.0),
    ) -> None:
        self.coordinates = coordinates
        self.output = output
        self.length_scale = length_scale
        self.length_scale_bounds = length_scale_bounds

    @property
    def hyperparameter_length_scale(self) -> Hyperparameter:
        """The length scale, sought on a logarithmic scale."""
        return Hyperparameter("length_scale", "numeric", self.length_scale_bounds)

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Parameters by name (scikit-learn)."""
        names = ("coordinates", "output", "length_scale", "length_scale_bounds")
        return {name: getattr(self, name) for name in names}

    def clone_with_theta(self, theta: Array) -> SymmetrisedPeriodicKernel:
        """The same kernel with another logarithm of the length scale; the group is shared."""
        return SymmetrisedPeriodicKernel(
            self.coordinates, self.output, float(np.exp(theta[0])), self.length_scale_bounds
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SymmetrisedPeriodicKernel) and (
            self.coordinates is other.coordinates
            and self.output == other.output
            and self.length_scale == other.length_scale
        )

    def __hash__(self) -> int:
        return hash((id(self.coordinates), self.output, self.length_scale))

    def __call__(self, X: Any, Y: Any = None, eval_gradient: bool = False) -> Any:
        """Covariances (m, m') of configurations X (m, n) and Y (m', n) [rad].

        Also their derivatives (m, m, 1) by the logarithm of the length scale, where asked for.
        """
        X = np.atleast_2d(X)
        images, signs = self._images(X)
        right = self._circles(np.atleast_2d(X if Y is None else Y) @ self.coordinates.basis.T)
        total = np.zeros((len(X), len(right)))
        slope = np.zeros_like(total) if eval_gradient else None
        for image, sign in zip(images, signs, strict=True):
            # all points lie on one sphere of radius^2 = rank
            exponent = (image @ right.T - self.coordinates.rank) / self.length_scale**2
            value = sign * np.exp(exponent)
            total += value
            if slope is not None:
                slope -= 2 * exponent * value
        return total if slope is None else (total, slope[:, :, None])

    def diag(self, X: Any) -> Array:
        """Variances (m,) at configurations X (m, n)."""
        X = np.atleast_2d(X)
        images, signs = self._images(X)
        own = self._circles(X @ self.coordinates.basis.T)
        total = np.zeros(len(X))
        for image, sign in zip(images, signs, strict=True):
            exponent = ((image * own).sum(axis=1) - self.coordinates.rank) / self.length_scale**2
            total += sign * np.exp(exponent)
        return total

    def is_stationary(self) -> bool:
        """Whether it depends on differences only: with symmetries it does not."""
        return self.coordinates.order == 1

    def __repr__(self) -> str:
        return f"Symmetrised(order={self.coordinates.order}, length_scale={self.length_scale:.3g})"

    def _images(self, X: Array) -> tuple[Array, Array]:
        """Points on circles of all symmetric copies (G, m, f), and their signs (G,)."""
        y = X @ self.coordinates.basis.T
        copies = np.einsum("gij,mj->gmi", self.coordinates.A_sat, y)
        copies += self.coordinates.d_sat[:, None]
        signs = self.coordinates.Y
        column = signs[:, self.output] if self.output < signs.shape[1] else np.ones(len(signs))
        return self._circles(copies), column

    def _circles(self, y: Array) -> Array:
        """Coordinates on the circles of every row a, (..., 2 rows)."""
        rows, weights = _rows_of(self.coordinates)
        phase = y @ rows.T
        return np.asarray(np.sqrt(np.tile(weights, 2))) * np.concatenate(
            [np.cos(phase), np.sin(phase)], axis=-1
        )


@lru_cache(maxsize=16)
def _rows_of(coordinates: SymmetryCoordinates) -> tuple[Array, Array]:
    """`distinct_rows` of a group, which a search for hyperparameters asks for hundreds of times."""
    return distinct_rows(coordinates.A_sat)


def distinct_rows(A_sat: Array) -> tuple[Array, Array]:
    """Rows of all A_sat, one of each pair +-a, and their weights, which sum to the rank."""
    rows = A_sat.reshape(-1, A_sat.shape[-1])
    first = (np.abs(rows) > 1e-9).argmax(axis=1)
    rows = rows * np.sign(rows[np.arange(len(rows)), first])[:, None] + 0.0
    distinct, counts = np.unique(rows.round(9) + 0.0, axis=0, return_counts=True)
    return distinct, counts / len(A_sat)
