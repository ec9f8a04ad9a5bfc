"""Configurations of a torque by search: Newton's method from many starts, completed to orbits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.level_sets.equations import LevelSetEquations

BATCH = 64
"""Starts per round and target."""
LEAST_STARTS = 256
"""Starts per target before the search may end."""
HITS = 6
"""The search ends when every orbit of regular solutions was reached this often."""
SINGULAR = 1e-7
"""Stiffness this small, relative to the largest torque, counts as none."""
MOST_SINGULAR = 16
"""Orbits of singular solutions to keep: there may be a continuum of them."""


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Result of a search.

    Attributes
    ----------
    y : (m, r) array
        One solution per orbit.
    hits : (m,) int array
        How many starts led to its orbit.
    starts : int
        Number of starts in all.
    """

    y: Floats
    hits: NDArray[np.int64]
    starts: int


def search(
    equations: LevelSetEquations,
    group: SymmetryGroup,
    rng: np.random.Generator,
    max_starts: int,
) -> SearchResult:
    """Search one solution of every orbit.

    Parameters
    ----------
    equations, group
        The equations and the symmetries of their potential.
    rng
        Source of the starts.
    max_starts
        Give up after this many.

    Notes
    -----
    A relation maps the solutions for one sign pattern to those for another; one pattern per class
    is searched. Starts are uniform. The search ends when every orbit found has been reached
    several times: evidence, not proof, that none is missing.
    """
    found: list[_Orbit] = []
    starts = 0
    for number in _independent_targets(equations, group):
        goal, torque = equations.targets[number], equations.torques[number]
        keeping = np.flatnonzero((group.Y * torque == torque).all(axis=1))
        orbits: list[_Orbit] = []
        tried = 0
        while starts + tried < max_starts and (
            tried < LEAST_STARTS or any(orbit.hits < HITS for orbit in orbits if not orbit.singular)
        ):
            tried += BATCH
            for y in newton(equations, rng.uniform(0, 2 * np.pi, (BATCH, len(goal))), goal):
                _record(y, orbits, goal, keeping, equations, group)
        starts += tried
        found += orbits
    return SearchResult(
        np.array([orbit.images[0] for orbit in found]).reshape(-1, equations.targets.shape[1]),
        np.array([orbit.hits for orbit in found], dtype=np.int64),
        starts,
    )


@dataclass
class _Orbit:
    """Solutions for one target that relations carry into each other."""

    images: Floats  # (k, r), the first as found
    singular: bool
    hits: int = 1


def _record(
    y: Floats,
    orbits: list[_Orbit],
    goal: Floats,
    keeping: NDArray[np.int64],
    equations: LevelSetEquations,
    group: SymmetryGroup,
) -> None:
    """Count a solution for its orbit, or start a new one."""
    for orbit in orbits:
        if equations.same(orbit.images, np.broadcast_to(y, orbit.images.shape), goal).any():
            orbit.hits += 1
            return
    stiffness = np.linalg.eigvalsh(equations.potential.hessian(y))
    singular = bool(np.abs(stiffness).min(initial=np.inf) < SINGULAR * equations.scale)
    if singular and sum(orbit.singular for orbit in orbits) >= MOST_SINGULAR:
        return
    images = np.einsum("gij,j->gi", group.A_sat[keeping], y) + group.d_sat[keeping]
    orbits.append(_Orbit(images, singular))


def newton(equations: LevelSetEquations, y: Floats, goal: Floats) -> Floats:
    """Solve ``gradient(y) = goal`` from the starts ``y`` (m, r); return those that converged.

    Levenberg-Marquardt, all starts side by side, with plain Newton steps at the end.
    """
    potential, accuracy = equations.potential, equations.accuracy
    r = y.shape[1]
    if r == 0:
        return y[:1]
    damping = np.full(len(y), 1e-2)
    miss = potential.gradient(y) - goal
    for _ in range(60):
        far = np.abs(miss).max(axis=1) > 1e-3 * accuracy
        if not far.any():
            break
        stiffness = potential.hessian(y[far]) / equations.scale
        normal = stiffness @ stiffness + damping[far, None, None] * np.eye(r)
        right = np.einsum("mij,mj->mi", stiffness, miss[far]) / equations.scale
        step = -np.linalg.solve(normal, right[..., None])[..., 0]
        there = potential.gradient(y[far] + step) - goal
        better = (there**2).sum(axis=1) < (miss[far] ** 2).sum(axis=1)
        rows = np.flatnonzero(far)
        damping[rows] = np.where(better, damping[rows] / 10, damping[rows] * 8)
        damping = np.clip(damping, 1e-15, 1e3)
        y[rows[better]] += step[better]
        miss[rows[better]] = there[better]
    return np.asarray(np.remainder(y[np.abs(miss).max(axis=1) <= accuracy], 2 * np.pi))


def _independent_targets(equations: LevelSetEquations, group: SymmetryGroup) -> list[int]:
    """Return one target of each class of targets that relations carry into each other."""
    left = list(range(len(equations.torques)))
    chosen = []
    while left:
        chosen.append(left[0])
        images = group.Y * equations.torques[left[0]]
        left = [i for i in left if not (images == equations.torques[i]).all(axis=1).any()]
    return chosen
