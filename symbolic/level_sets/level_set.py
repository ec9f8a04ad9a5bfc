"""All configurations that need a torque up to signs, split into primary sets, stable or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.level_sets.closed_form import has_closed_form, solve_in_closed_form
from isotorque.symbolic.level_sets.equations import LevelSetEquations, level_set_equations
from isotorque.symbolic.level_sets.newton_search import SINGULAR, search
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

SAME = 1e-8
"""Torques that differ by less, relative to the largest of the level set, are the same."""


@dataclass(frozen=True, eq=False)
class LevelSet:
    """Configurations whose static torque has given absolute values (Eq. 4 of the paper).

    Attributes
    ----------
    configurations : (m, n) array
        Joint angles in (-pi, pi] [rad]; along free directions one of the continuum is listed.
    torques : (m, n) array
        The torque that each of them needs [N m].
    primary_sets : (m,) int array
        Number of the primary set (orbit of the symmetry group) of each, from 0. Configurations
        with different numbers are secondary symmetric.
    stable : (m,) bool array
        Whether the configuration holds itself under its constant torque: dg/dq is positive
        definite, free directions apart.
    regular : (m,) bool array
        Whether dg/dq is invertible, free directions apart: then no other solution is near. The
        others are double solutions, or members of a continuum of which only some are listed.
    complete : bool
        Whether these are proved to be all; otherwise there are at least these.
    fewest_hits : int
        For a search: how often the least-hit primary set was reached from random starts (many:
        a missing one is unlikely). 0 for a closed form.
    """

    configurations: Floats
    torques: Floats
    primary_sets: NDArray[np.int64]
    stable: NDArray[np.bool_]
    regular: NDArray[np.bool_]
    complete: bool
    fewest_hits: int = 0

    def __len__(self) -> int:
        return len(self.configurations)

    @property
    def primary_set_count(self) -> int:
        """Number of primary sets."""
        return len(np.unique(self.primary_sets))

    @property
    def stable_members(self) -> LevelSet:
        """The stable ones: all that an arm without a controller can be found in."""
        return self._only(self.stable)

    def primary_set(self, number: int) -> LevelSet:
        """Return one primary set (S_A, S_B, ... in the paper's Fig. 2)."""
        return self._only(self.primary_sets == number)

    def with_torque(self, torque: ArrayLike) -> LevelSet:
        """Return the members that need exactly ``torque`` (n,) [N m] (Eq. 2 of the paper)."""
        away = np.abs(self.torques - np.asarray(torque, dtype=float)).max(axis=1, initial=0.0)
        return self._only(away <= SAME * np.abs(self.torques).max(initial=0.0))

    def _only(self, chosen: NDArray[np.bool_]) -> LevelSet:
        return LevelSet(
            self.configurations[chosen],
            self.torques[chosen],
            self.primary_sets[chosen],
            self.stable[chosen],
            self.regular[chosen],
            self.complete,
            self.fewest_hits,
        )


def level_set(
    potential: TrigonometricPolynomial,
    torque: ArrayLike,
    *,
    group: SymmetryGroup | None = None,
    rng: np.random.Generator | None = None,
    max_starts: int = 20_000,
) -> LevelSet:
    """Find all configurations with |g(q)| = |torque|, g the gradient of the potential.

    Parameters
    ----------
    potential
        Gravity potential [J].
    torque : (n,) array
        The torque [N m]; its signs do not matter.
    group
        Symmetries of the potential, where they are already known (exact ones only).
    rng
        Source of starts for the search; a fixed one by default.
    max_starts
        Bound on the starts of a search.

    Returns
    -------
    LevelSet
        Members of one primary set stand together, in the order of the group, led by the member
        nearest to q = 0. Empty where no configuration needs the torque.

    Raises
    ------
    InputError
        If the torque has the wrong length or is not finite, if the group belongs to another
        arm, or if the potential contains symbols.

    Notes
    -----
    Where the frequencies of the potential are linearly independent (pendulum, 2R, planar arms)
    all solutions follow in closed form and the set is complete: for the 2R arm 16 in two primary
    sets, or 8 in one. Other arms are searched by Newton's method from random starts until every
    primary set has been reached several times, each completed by the symmetry group; then the
    set holds "at least" these. Solutions that differ by less than about 1e-5 rad and are joined by
    (almost) solutions count as one.

    References
    ----------
    The paper, Eq. 1-4 and 8, Fig. 2A.

    Examples
    --------
    >>> arm = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.39, 6.13])
    >>> found = level_set(arm, arm.gradient([1.2, 0.1]))
    >>> len(found), found.primary_set_count, found.complete
    (16, 2, True)
    >>> len(found.with_torque(arm.gradient([1.2, 0.1]))), len(found.stable_members)
    (4, 4)
    """
    wanted = np.asarray(torque, dtype=float)
    if group is None:
        group = primary_symmetries(potential)
    elif group.n != potential.n:
        raise InputError("level set", "number of joints of the group", group.n, str(potential.n))
    equations = level_set_equations(potential, wanted, group)
    if has_closed_form(equations):
        left = solve_in_closed_form(equations)
        orbits = []
        while len(left):
            orbit = _orbit(left[0], equations, group)
            orbits.append(orbit)
            left = left[[not _contains(orbit, y, equations) for y in left]]
        return _assemble(orbits, equations, complete=True, fewest_hits=0)
    rng = np.random.default_rng(0) if rng is None else rng
    result = search(equations, group, rng, max_starts)
    orbits = [_orbit(y, equations, group) for y in result.y]
    # a bound on the torques proves emptiness, a search that finds nothing does not
    complete = len(equations.targets) == 0
    return _assemble(orbits, equations, complete, int(result.hits.min()) if len(result.hits) else 0)


def _orbit(y: Floats, equations: LevelSetEquations, group: SymmetryGroup) -> Floats:
    """Return the images of a solution, each once, led by the one nearest to zero."""
    images = wrap(np.einsum("gij,j->gi", group.A_sat, y) + group.d_sat)
    size = np.abs(wrap(images @ equations.lift.T)).sum(axis=1)
    lead = np.lexsort((*-images.T[::-1].round(6), size.round(6)))[0] if len(images) else 0
    images = wrap(np.einsum("gij,j->gi", group.A_sat, images[lead]) + group.d_sat)
    kept: list[Floats] = []
    for image in images:
        if not kept or not _contains(np.array(kept), image, equations):
            kept.append(image)
    return np.array(kept)


def _contains(solutions: Floats, y: Floats, equations: LevelSetEquations) -> bool:
    goal = equations.potential.gradient(y)
    near = equations.potential.gradient(solutions) - goal
    alike = np.abs(near).max(axis=1, initial=0.0) <= 10 * equations.accuracy
    others = np.broadcast_to(y, solutions.shape)
    return bool(np.any(alike & equations.same(solutions, others, goal)))


def _assemble(
    orbits: list[Floats], equations: LevelSetEquations, complete: bool, fewest_hits: int
) -> LevelSet:
    orbits = sorted(orbits, key=lambda orbit: tuple(np.round(orbit[0], 6)))
    r, n = equations.basis.shape
    y = np.concatenate([np.zeros((0, r)), *orbits])
    labels = np.repeat(np.arange(len(orbits)), [len(orbit) for orbit in orbits])
    stiffness = np.linalg.eigvalsh(equations.potential.hessian(y)) if r else np.zeros((len(y), 0))
    least = SINGULAR * equations.scale
    return LevelSet(
        configurations=wrap(y @ equations.lift.T).reshape(-1, n),
        torques=equations.potential.gradient(y) @ equations.basis,
        primary_sets=labels.astype(np.int64),
        stable=np.all(stiffness > least, axis=1),
        regular=np.all(np.abs(stiffness) > least, axis=1),
        complete=complete,
        fewest_hits=fewest_hits,
    )
