"""Samples spread evenly over a region: lattices (Eq. 23), or low-discrepancy sequences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from isotorque.learning.sampling.korobov import korobov_generator, korobov_points
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

Array = NDArray[np.float64]
Admit = Callable[[Array], NDArray[np.bool_]]

#: Shifts of the lattice tried to meet a number of points exactly.
SHIFTS = 20
#: Densest lattice looked at, in multiples of what would do if every point were admissible.
DENSEST = 4096
TIE = 1e-9


class Spread(StrEnum):
    """Evenness of points in a region."""

    KOROBOV = "korobov"
    GRID = "grid"
    SOBOL = "sobol"
    HALTON = "halton"
    RANDOM = "random"


@dataclass(frozen=True, eq=False)
class LatticeSamples:
    """Configurations spread over a region.

    Attributes
    ----------
    q : (m, n) array
        Configurations [rad].
    generators : (r, n) array or None
        Rows p_i of Eq. 23: all differences of the points, before any was moved to a symmetric
        one, are integer combinations of them; None for sequences.
    """

    q: Array
    generators: Array | None


def lattice_samples(
    region: SamplingRegion,
    count: int,
    rng: np.random.Generator,
    spread: Spread | str = Spread.KOROBOV,
    *,
    admit: Admit | None = None,
    images: SymmetryGroup | None = None,
    refill: bool = True,
    exact: bool = True,
) -> LatticeSamples:
    """Spread configurations evenly over a region.

    Parameters
    ----------
    region : SamplingRegion
        A fundamental domain (BCTS) or a box.
    count : int
        Number of configurations wanted.
    rng : numpy.random.Generator
        Shifts the lattice, scrambles the sequences.
    spread : Spread or its name
        ``korobov``: the best rank-1 lattice found by search. ``grid``: a cubic grid. ``sobol``,
        ``halton``: scrambled low-discrepancy sequences. ``random``: uniform, for comparison.
    admit : callable, optional
        Says which of configurations (m, n) can be visited (within limits, stable); (m,) bools.
    images : SymmetryGroup, optional
        A configuration that cannot be visited is replaced by the first symmetric one (angles in
        (-pi, pi]) that can: it tells the learner the same.
    refill : bool
        Whether a denser lattice makes up for configurations that cannot be visited; otherwise
        they are left out, and fewer than ``count`` come back.
    exact : bool
        Whether anything but ``count`` configurations is an error. If not, the nearest number the
        lattice can give is taken; for sequences any number is possible.

    Returns
    -------
    LatticeSamples

    Raises
    ------
    InputError
        If the count is not positive, if next to nothing is admissible, or if an exact count is
        out of reach of a grid (several of its points enter a region with flat sides at once).

    Notes
    -----
    A lattice is scaled about the centre of the region until it holds as many points as wanted:
    with w_i the points and ``gauge(w) = max_f a_f.w / b_f``, ``w_i / s`` is inside if ``gauge(w_i)
    <= s``, so sorting the gauges gives s. With ``admit`` the number of points no longer grows with
    s; since it changes one by one, bisection still finds an s that fits. No point lies on the
    boundary unless the lattice's shift happens to put it there.

    References
    ----------
    The paper, section 6. C. Cervellera et al., "Lattice point sets for efficient kernel smoothing
    models", IJCNN 2014. J. Dick, F. Kuo, I. Sloan, "High-dimensional integration: the quasi-Monte
    Carlo way", Acta Numerica 22 (2013).

    Examples
    --------
    >>> square = SamplingRegion.of_box([[0.0, 1.0], [0.0, 1.0]])
    >>> points = lattice_samples(square, 100, np.random.default_rng(0)).q
    >>> len(points), bool((points >= 0).all() and (points <= 1).all())
    (100, True)
    >>> from scipy.spatial.distance import pdist
    >>> bool(pdist(points).min() > 0.95 / np.sqrt(100))  # evenly
    True
    """
    if count < 1:
        raise InputError("lattice", "number of points", count, "at least 1")
    kind = _spread(spread)
    choose = _Chooser(region, admit if refill else None, images)
    if kind in (Spread.KOROBOV, Spread.GRID):
        q, generators = _scaled_lattice(choose, count, rng, kind, exact)
    else:
        q, generators = _sequence(choose, count, rng, kind), None
    if admit is not None and not refill:
        q, allowed = _Chooser(region, admit, images).choice(q)
        q = q[allowed]
    return LatticeSamples(q, generators)


@dataclass(frozen=True, eq=False)
class _Chooser:
    """Choice among points of a region: admissible ones, moved or not."""

    region: SamplingRegion
    admit: Admit | None
    images: SymmetryGroup | None

    def choice(self, q: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Configurations, moved where that helps, and which of them are admissible."""
        if self.admit is None or not len(q):
            return q, np.ones(len(q), dtype=bool)
        allowed = np.asarray(self.admit(q), dtype=bool)
        if self.images is not None:
            q = q.copy()
            for relation in self.images:
                rest = np.flatnonzero(~allowed)
                if not len(rest):
                    break
                moved = wrap(relation.configuration(q[rest]))
                good = np.asarray(self.admit(moved), dtype=bool)
                q[rest[good]] = moved[good]
                allowed[rest[good]] = True
        return q, allowed

    def admissible(self, w: Array) -> Array:
        """The admissible configurations (m', n) of points w (m, r)."""
        q, allowed = self.choice(self.region.configurations(w))
        return q[allowed]


def _spread(spread: Spread | str) -> Spread:
    try:
        return Spread(spread)
    except ValueError:
        raise InputError("lattice", "spread", spread, ", ".join(Spread)) from None


def _scaled_lattice(
    choose: _Chooser, count: int, rng: np.random.Generator, kind: Spread, exact: bool
) -> tuple[Array, Array]:
    region = choose.region
    denser, best = 1.0, None
    nearest: list[int] = []
    while denser <= DENSEST:
        box, base, generators = _base_lattice(region, count * denser, kind)
        for _ in range(SHIFTS):
            # a little more than the box, so that points are complete up to scale `most`
            w = box[0] + (base + rng.random(region.dimension)) % 1.0 * (box[1] - box[0])
            gauge = region.gauge(w)
            order = np.argsort(gauge)
            q, scale = _fit(choose, w[order], gauge[order], count, _most(region))
            if q is None:
                break  # too few even so: denser
            nearest.append(len(q))
            if best is None or abs(len(q) - count) < abs(len(best[0]) - count):
                best = (q, generators / scale)
            if len(q) == count:
                return best
        else:
            break
        denser *= 1.5
    if best is None:
        raise InputError(
            "lattice", "share of admissible configurations", "next to none", "a larger region"
        )
    if exact:
        raise InputError(
            "lattice", "number of points", count, f"with this {kind} e.g. {len(best[0])}"
        )
    return best


def _most(region: SamplingRegion) -> float:
    return float(1.5 ** (1 / region.dimension))


def _base_lattice(region: SamplingRegion, count: float, kind: Spread) -> tuple[Array, Array, Array]:
    """A box (2, r) around the region, lattice points in the unit cube, generators in q."""
    box = np.stack([region.vertices.min(axis=0), region.vertices.max(axis=0)]) * _most(region)
    sides = box[1] - box[0]
    number = max(1, round(count * float(np.prod(sides)) / region.volume))
    if kind is Spread.KOROBOV:
        z = korobov_generator(number, sides)
        base = korobov_points(z, number)
        rows = np.concatenate([z[None] / number, np.eye(len(z))[1:]])
        return box, base, rows * sides @ region.to_configuration.T
    spacing = float(np.prod(sides) / number) ** (1 / len(sides))
    steps = np.maximum(1, np.ceil(sides / spacing - TIE)).astype(int)
    box = box * (steps * spacing / sides)  # a whole number of cubes
    axes = [np.arange(m) / m for m in steps]
    base = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(sides))
    return box, base, spacing * region.to_configuration.T


def _fit(
    choose: _Chooser, w: Array, gauge: Array, count: int, most: float
) -> tuple[Array | None, float]:
    """Configurations of the lattice scaled to ``count`` admissible ones, and the scale."""

    def at(scale: float) -> Array:
        inside = w[: np.searchsorted(gauge, scale, side="right")]
        return choose.admissible(inside / scale)

    if choose.admit is None:
        if len(gauge) <= count or gauge[count] > most:
            return None, most
        gap = gauge[count] - gauge[count - 1]
        if gap > TIE:
            scale = float(gauge[count] - gap / 2)
            return choose.region.configurations(w[:count] / scale), scale
        # Several points enter at once: the nearer of the counts before and after.
        level = gauge[count]
        before = int(np.searchsorted(gauge, level - TIE))
        after = int(np.searchsorted(gauge, level + TIE))
        number = before if before and count - before <= after - count else after
        if number == len(gauge):
            return None, most
        scale = float((gauge[number - 1] + gauge[number]) / 2)
        return choose.region.configurations(w[:number] / scale), scale
    low, high = 0.0, most
    q = at(high)
    if len(q) < count:
        return None, most
    scale = high
    for _ in range(60):
        if len(q) == count:
            break
        scale = (low + high) / 2
        q = at(scale)
        low, high = (scale, high) if len(q) < count else (low, scale)
    return q, scale


def _sequence(choose: _Chooser, count: int, rng: np.random.Generator, kind: Spread) -> Array:
    """The first ``count`` admissible points of a sequence in the box around the region."""
    region = choose.region
    lowest, highest = region.vertices.min(axis=0), region.vertices.max(axis=0)
    share = region.volume / float(np.prod(highest - lowest))
    power = int(np.ceil(np.log2(count / share))) + 1
    seed = int(rng.integers(2**63))
    q = np.empty((0, len(region.center)))
    while power <= np.log2(count / share) + np.log2(DENSEST):
        unit = _unit_sequence(kind, region.dimension, power, np.random.default_rng(seed))
        w = lowest + unit * (highest - lowest)
        q = choose.admissible(w[region.contains(w)])
        if len(q) >= count:
            return q[:count]
        power += 1
    raise InputError(
        "lattice", "share of admissible configurations", "next to none", "a larger region"
    )


def _unit_sequence(kind: Spread, dimension: int, power: int, rng: np.random.Generator) -> Array:
    if kind is Spread.SOBOL:
        return np.asarray(qmc.Sobol(dimension, rng=rng).random_base2(power))
    if kind is Spread.HALTON:
        return np.asarray(qmc.Halton(dimension, rng=rng).random(2**power))
    return rng.random((2**power, dimension))
