"""Good rank-1 lattices in a box: Korobov's generators, the best found by search."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Multipliers tried at most; with more points than that they are spread over the range.
CANDIDATES = 256
#: Numbers (multipliers x points x dimensions) looked at together, to bound memory.
TOGETHER = 2_000_000


def korobov_points(generator: ArrayLike, count: int) -> Array:
    """Points ``i z / N mod 1`` of a rank-1 lattice in the unit cube, i = 0 .. N - 1.

    Parameters
    ----------
    generator : (r,) int array
        Generating vector z.
    count : int
        N.

    Returns
    -------
    (N, r) array

    Examples
    --------
    >>> korobov_points([1, 2], 5).tolist()
    [[0.0, 0.0], [0.2, 0.4], [0.4, 0.8], [0.6, 0.2], [0.8, 0.6]]
    """
    z = np.asarray(generator, dtype=np.int64)
    return np.asarray((np.arange(count)[:, None] * z % count) / count)


def korobov_generator(count: int, sides: ArrayLike) -> Integers:
    """Generating vector ``(1, a, a^2, ..) mod N`` whose points lie farthest apart in a box.

    Parameters
    ----------
    count : int
        Number of points N in the box.
    sides : (r,) array
        Lengths of the sides of the box, in units in which distances mean something.

    Returns
    -------
    (r,) int array

    Raises
    ------
    InputError
        If there is no point, or a side is not positive.

    Notes
    -----
    The merit of a multiplier a is the shortest distance of two points of the lattice that repeats
    the box in all directions: of one point and 0, as differences of points are points. All a are
    tried up to `CANDIDATES` of them, otherwise so many spread evenly. In more than one dimension
    the best beats a grid in two ways: no two points share a coordinate, and any N is possible.

    References
    ----------
    N. M. Korobov, "The approximate computation of multiple integrals", Dokl. Akad. Nauk SSSR 124
    (1959). C. Cervellera et al., "Lattice point sets for efficient kernel smoothing models", IJCNN
    2014.

    Examples
    --------
    A square with five points: knight's moves, sqrt(5) / 5 apart.

    >>> korobov_generator(5, [1.0, 1.0]).tolist()
    [1, 2]
    """
    lengths = np.asarray(sides, dtype=float)
    if lengths.ndim != 1 or not len(lengths) or not np.all((lengths > 0) & np.isfinite(lengths)):
        raise InputError("lattice", "sides", lengths.tolist(), "positive lengths")
    if count < 1:
        raise InputError("lattice", "number of points", count, "at least 1")
    if len(lengths) == 1 or count < 4:
        return np.ones(len(lengths), dtype=np.int64)
    multipliers = np.arange(1, count // 2 + 1)  # count - a mirrors a
    if len(multipliers) > CANDIDATES:
        spread = np.linspace(0, len(multipliers) - 1, CANDIDATES)
        multipliers = multipliers[np.unique(np.rint(spread).astype(np.int64))]
    generators = _powers(multipliers, len(lengths), count)
    chunk = max(1, TOGETHER // (count * len(lengths)))
    merit = np.concatenate(
        [
            _shortest(generators[i : i + chunk], count, lengths)
            for i in range(0, len(generators), chunk)
        ]
    )
    return generators[int(np.argmax(merit))]


def _powers(multipliers: Integers, dimension: int, count: int) -> Integers:
    columns = [np.ones(len(multipliers), dtype=np.int64)]
    for _ in range(dimension - 1):
        columns.append(columns[-1] * multipliers % count)
    return np.stack(columns, axis=1)


def _shortest(generators: Integers, count: int, lengths: Array) -> Array:
    """Squared shortest vector of each lattice (c, r); i and N - i are mirrored."""
    index = np.arange(1, count // 2 + 1)
    residue = index[None, :, None] * generators[:, None, :] % count / count
    nearest = (residue - np.rint(residue)) * lengths
    return np.asarray((nearest**2).sum(axis=2).min(axis=1))
