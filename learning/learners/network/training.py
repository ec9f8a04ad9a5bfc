"""Training of a network: several starts tried for a while, the best one fitted to the end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.network.levenberg_marquardt import (
    LeastSquaresFit,
    levenberg_marquardt,
)
from isotorque.learning.learners.network.tanh_layer import TanhLayer

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NetworkProblem:
    """Samples that a network is to reproduce.

    Attributes
    ----------
    layer : TanhLayer
        The network.
    x : (m, G, f) array
        Inputs.
    targets : (m, k) array
        Outputs wanted.
    root_weights : (m,) array
        Roots of the weights of the squared errors.
    """

    layer: TanhLayer
    x: Array
    targets: Array
    root_weights: Array

    def residuals(self, parameters: Array) -> Array:
        """Weighted errors, (m k,)."""
        error = self.layer.values(parameters, self.x) - self.targets
        return np.asarray((error * self.root_weights[:, None]).ravel())

    def jacobian(self, parameters: Array) -> tuple[Array, Array]:
        """Weighted errors (m k,) and their derivatives (m k, p)."""
        values, slopes = self.layer.derivatives(parameters, self.x)
        slopes *= self.root_weights[:, None, None]
        error = (values - self.targets) * self.root_weights[:, None]
        return error.ravel(), slopes.reshape(error.size, -1)

    def error(self, parameters: Array) -> float:
        """Root mean square of the weighted errors."""
        return float(np.sqrt(np.mean(self.residuals(parameters) ** 2)))


def best_network(
    problem: NetworkProblem,
    held_out: NetworkProblem | None,
    rng: np.random.Generator,
    *,
    restarts: int,
    trial_iterations: int,
    iterations: int,
    tolerance: float,
    ridge: float,
) -> LeastSquaresFit:
    """Try random starts, fit the one with the least training error to the end.

    Parameters
    ----------
    problem, held_out
        Samples to fit; samples whose error ends the search, None without.
    rng
        Draws the starts.
    restarts, trial_iterations, iterations
        Number of starts, steps to try each, steps of the best one altogether.
    tolerance, ridge
        See `levenberg_marquardt`.

    Returns
    -------
    LeastSquaresFit
    """

    def search(x: Array, steps: int) -> LeastSquaresFit:
        return levenberg_marquardt(
            problem.residuals,
            problem.jacobian,
            x,
            ridge=ridge,
            iterations=steps,
            tolerance=tolerance,
            held_out=None if held_out is None else held_out.error,
        )

    def objective(fit: LeastSquaresFit) -> float:
        return fit.rms**2 * problem.targets.size + ridge * float(fit.x @ fit.x)

    starts = [problem.layer.initial(rng) for _ in range(restarts)]
    trials = [search(x, min(trial_iterations, iterations)) for x in starts]
    best = min(trials, key=objective)
    if iterations <= trial_iterations:
        return best
    rest = search(best.x, iterations - trial_iterations)
    return replace(rest, iterations=best.iterations + rest.iterations)
