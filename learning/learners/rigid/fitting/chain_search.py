"""Search for a chain: from a start to a minimum, weights brought up to date, polished."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.compiled_fit import levenberg_marquardt, turn
from isotorque.learning.learners.rigid.fitting.joint_columns import JointColumn, features

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

ITERATIONS = 200
PROGRESS = 1e-6
"""A search ends when two steps in a row lower the cost by smaller shares."""
REWEIGHTINGS = 3
POLISHING = 40
DAMPINGS = (0.0, *10.0 ** np.arange(-10, 0))
"""Of steps of polishing, relative to the largest singular value; the first that helps is taken."""
LITTLE = 1e-8
"""Polishing ends when a step lowers the cost by a smaller share,"""
ROUNDED = 1e-8
"""or at so small a cost per equation (for exact samples: 1e-15 of the largest torque)."""
EXACT_COST = 1e-20
"""Cost, relative to that of zero torque, at which a search hands over to polishing."""


@dataclass(frozen=True, eq=False)
class SearchedChain:
    """A local minimum.

    Attributes
    ----------
    chain : ChainParameters
    cost : float
        Sum of the squares of whitened torque errors.
    whitening : (m, n, n) array
        With which it was computed.
    """

    chain: ChainParameters
    cost: float
    whitening: Array


@dataclass(frozen=True, eq=False)
class ChainModel:
    """Family of chains that is searched.

    Attributes
    ----------
    parents : (n,) int array
        Joint that carries each joint, -1 for the base.
    gains : (n,) array
        Known gains; where they are free, where to start.
    free_gains : (n,) bool array
        Which are unknown.
    columns : tuple of JointColumn
        What the torques have beside the chain's.
    """

    parents: NDArray[np.int64]
    gains: Array
    free_gains: Mask
    columns: tuple[JointColumn, ...]

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.parents)

    def random_start(self, rng: np.random.Generator) -> ChainParameters:
        """Rotations distributed uniformly (Haar), no levers."""
        F = Rotation.random(self.n, random_state=rng).as_matrix()
        return self.start(np.atleast_3d(F).reshape(self.n, 3, 3))

    def start(self, rotations: Array) -> ChainParameters:
        """A chain with given rotations, no levers."""
        return ChainParameters.of(
            rotations,
            np.zeros((self.n, 2)),
            parents=self.parents,
            gains=self.gains,
            columns=self.columns,
            coefficients=np.zeros(len(self.columns)),
        )

    @property
    def free(self) -> Mask:
        """Mask over turns, levers, gains, coefficients (`Information`)."""
        return np.concatenate(
            [np.ones(4 * self.n, bool), self.free_gains, np.ones(len(self.columns), bool)]
        )


@dataclass(frozen=True, eq=False)
class Constraint:
    """Offsets, twists and levers of a chain in canonical form that may change.

    Attributes
    ----------
    turns, levers : (2 n,) bool arrays
        Offset and twist, x and y of every joint.
    """

    turns: Mask
    levers: Mask


def minimise(
    samples: ChainSamples,
    start: ChainParameters,
    free_gains: Mask,
    whitening: Array,
    *,
    constraint: Constraint | None = None,
    extra: Array | None = None,
    iterations: int = ITERATIONS,
    progress: float = PROGRESS,
    enough: float | None = None,
) -> SearchedChain:
    """Go from a start to a minimum with a given whitening.

    ``extra`` holds columns (m, n, c) in place of those of the start: the coefficients found are
    theirs. It ends at a cost below ``enough``; by default where polishing takes over.
    """
    n = start.n
    everything = np.ones(2 * n, dtype=bool)
    size = float(np.sum(np.einsum("kij,kj->ki", whitening, samples.torque) ** 2))
    rotations, levers, gains, coefficients, cost, _ = levenberg_marquardt(
        start.parents,
        start.rotations,
        start.gains,
        samples.q,
        samples.torque,
        whitening,
        features(start.columns, samples.q) if extra is None else extra,
        everything if constraint is None else constraint.turns,
        everything if constraint is None else constraint.levers,
        free_gains,
        constraint is not None,
        iterations,
        progress,
        EXACT_COST * size if enough is None else enough,
    )
    chain = replace(
        start, rotations=rotations, levers=levers, gains=gains, coefficients=coefficients
    )
    return SearchedChain(chain, float(cost), whitening)


def search(
    samples: ChainSamples,
    start: ChainParameters,
    free_gains: Mask,
    *,
    constraint: Constraint | None = None,
    worthwhile: float = np.inf,
    warm: bool = False,
) -> SearchedChain:
    """Go from a start to a minimum, with weights that follow from the chain found.

    Parameters
    ----------
    samples
        Static samples.
    start
        Rotations, gains; levers do not matter.
    free_gains
        Which gains are unknown.
    constraint
        What must not change, of a chain in canonical form.
    worthwhile
        Weights are brought up to date only for chains that cost less than this.
    warm
        Whether the start is good enough to take its weights.
    """
    whitening = samples.whitening(start if warm else None)
    found = minimise(samples, start, free_gains, whitening, constraint=constraint)
    if samples.angle_noise.any() and np.isfinite(found.cost):
        for _ in range(REWEIGHTINGS):
            if found.cost > worthwhile:
                break
            before = found.cost
            whitening = samples.whitening(found.chain)
            found = minimise(samples, found.chain, free_gains, whitening, constraint=constraint)
            if abs(found.cost - before) < 1e-3 * found.cost:
                break
    return found


def polished(samples: ChainSamples, found: SearchedChain, model: ChainModel) -> SearchedChain:
    """The minimum to rounding: Gauss' and Newton's steps on all unknowns, by orthogonal factors.

    Normal equations lose half of the digits; this brings them back.
    """
    chain, cost = found.chain, _cost(samples, found.chain, found.whitening)
    free, directions = model.free, raw_directions(chain.n)
    for _ in range(POLISHING):
        slopes = chain.derivatives(samples.q, directions)
        rows = (found.whitening @ slopes.by_parameters()[:, :, free]).reshape(samples.equations, -1)
        rest = np.einsum("kij,kj->ki", found.whitening, samples.torque - slopes.torque).ravel()
        size = np.linalg.norm(rows, axis=0)
        scale = np.maximum(size, 1e-9 * size.max(initial=0.0) + np.finfo(float).tiny ** 0.5)
        u, s, v = np.linalg.svd(rows / scale, full_matrices=False)
        along, before = u.T @ rest, cost
        for damping in DAMPINGS:
            kept = s > 1e-12 * s.max(initial=0.0)
            factor = np.zeros_like(s)
            factor[kept] = s[kept] / (s[kept] ** 2 + (damping * s.max()) ** 2)
            step = np.zeros(len(free))
            step[free] = (v.T @ (factor * along)) / scale
            moved = stepped(chain, directions, step)
            moved_cost = _cost(samples, moved, found.whitening)
            if moved_cost < cost:
                chain, cost = moved, moved_cost
                break
        if cost > (1 - LITTLE) * before or cost < ROUNDED * samples.equations:
            break
    return SearchedChain(orthonormal(chain), cost, found.whitening)


def stepped(chain: ChainParameters, directions: Array, step: Array) -> ChainParameters:
    """The chain moved along turns, levers, gains and coefficients (`ChainDerivatives`)."""
    n = chain.n
    return replace(
        chain,
        rotations=turn(chain.rotations, directions, np.ascontiguousarray(step[: 2 * n])),
        levers=chain.levers + step[2 * n : 4 * n].reshape(n, 2),
        gains=chain.gains + step[4 * n : 5 * n],
        coefficients=chain.coefficients + step[5 * n :],
    )


def best_of(found: Sequence[SearchedChain]) -> SearchedChain:
    """The chain that costs least."""
    return min(found, key=lambda f: f.cost)


def _cost(samples: ChainSamples, chain: ChainParameters, whitening: Array) -> float:
    rest = np.einsum("kij,kj->ki", whitening, samples.torque - chain.torque(samples.q))
    return float(np.sum(rest**2))


def orthonormal(chain: ChainParameters) -> ChainParameters:
    """Rotations without the rounding of many products."""
    u, _, v = np.linalg.svd(chain.rotations)
    return replace(chain, rotations=np.ascontiguousarray(u @ v))
