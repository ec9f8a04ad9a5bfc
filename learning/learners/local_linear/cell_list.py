"""Cell list on a torus: where to look for the points near a point."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: More cells than this are not worth their memory; all prototypes are scanned instead.
LARGEST_GRID = 2_000_000


class CellList(NamedTuple):
    """Box cells over [-pi, pi)^r with a margin of ghost cells, entries sorted by cell.

    A point is entered once per periodic image that lies in the margin, so that a search never has
    to wrap anything: it visits rows of cells at fixed offsets from the cell of the query and
    compares unwrapped positions. As entries are sorted by cell, a row is one run of memory. A
    search radius wider than the torus sees several images of one point.

    Attributes
    ----------
    axes : tuple of r zeros
        Its length tells the compiler the number of coordinates: loops over them are unrolled, and
        vectors kept in tuples of this kind stay in registers (twice as fast as small arrays).
    isometry : (r, r) array
        L, upper triangular; distances are ``|L dy|``.
    cells, margin, strides : (r,) integer arrays
        Cells per turn, ghost cells on either side, steps of the flat cell index. No cells (zeros):
        scan everything.
    row_first, row_cells : integer arrays
        Rows to be visited: step to the first cell, number of cells.
    start : (number of cells + 1,) integer array
        First entry of every cell.
    position : (e, r) array
        Position ``L y`` of every entry.
    number : (e,) integer array
        The point it is an image of.
    point : (p, r) array
        Wrapped coordinates y of every point.
    search_radius : float
        Radius within which every image is found.
    """

    axes: tuple[float, ...]
    isometry: Array
    cells: Integers
    margin: Integers
    strides: Integers
    row_first: Integers
    row_cells: Integers
    start: NDArray[np.int32]
    position: Array
    number: NDArray[np.int32]
    point: Array
    search_radius: float


def make_cell_list(isometry: Array, search_radius: float, cell_side: float) -> CellList:
    """An empty cell list.

    Parameters
    ----------
    isometry : (r, r) array
        L of the distance ``|L dy|``, upper triangular.
    search_radius : float
        Largest distance at which points must be found.
    cell_side : float
        Wanted side of a cell, as a distance.

    Returns
    -------
    CellList
        With room for no point yet (``with_room``). Without cells where their number would exceed
        ``LARGEST_GRID`` (many dimensions): then every search looks at all points.
    """
    rank = len(isometry)
    axis_length = np.linalg.norm(isometry, axis=0)
    cells = np.maximum(1, np.floor(2 * np.pi * axis_length / cell_side)).astype(np.int64)
    width = 2 * np.pi / cells
    reach = search_radius * np.linalg.norm(np.linalg.inv(isometry), axis=1)
    margin = np.ceil(reach / width - 1e-9).astype(np.int64)
    padded = cells + 2 * margin
    strides = np.ones(rank, dtype=np.int64)
    for axis in range(rank - 2, -1, -1):
        strides[axis] = strides[axis + 1] * padded[axis + 1]
    if np.prod(padded.astype(float)) > LARGEST_GRID:
        cells = np.zeros(rank, dtype=np.int64)
        margin = np.zeros(rank, dtype=np.int64)
        row_first = row_cells = np.zeros(0, dtype=np.int64)
        start = np.zeros(0, dtype=np.int32)
    else:
        row_first, row_cells = _rows(_reached_offsets(isometry * width, margin, search_radius))
        row_first = row_first @ strides
        start = np.zeros(int(np.prod(padded)) + 1, dtype=np.int32)
    return CellList(
        (0.0,) * rank,
        np.ascontiguousarray(isometry, dtype=float),
        cells,
        margin,
        strides,
        row_first,
        row_cells,
        start,
        np.zeros((0, rank)),
        np.zeros(0, dtype=np.int32),
        np.zeros((0, rank)),
        float(search_radius),
    )


def images_per_point(grid: CellList) -> int:
    """Largest number of entries one point can need (0 without cells)."""
    if grid.start.size == 0:
        return 0
    return int(np.prod(1 + -(-2 * grid.margin // grid.cells)))


def sees_several_images(grid: CellList) -> bool:
    """Whether one point can be found at two periodic images in one search."""
    reach = grid.search_radius * np.linalg.norm(np.linalg.inv(grid.isometry), axis=1)
    return bool(grid.start.size and np.any(reach >= np.pi))


def with_room(grid: CellList, points: int) -> CellList:
    """The same list with room for ``points`` points (never less than it has)."""
    points = max(points, len(grid.point))
    entries = max(points * images_per_point(grid), len(grid.number))

    def longer(old: NDArray, length: int) -> NDArray:
        new = np.zeros((length, *old.shape[1:]), dtype=old.dtype)
        new[: len(old)] = old
        return new

    return grid._replace(
        position=longer(grid.position, entries),
        number=longer(grid.number, entries),
        point=longer(grid.point, points),
    )


def _reached_offsets(cell: Array, margin: Integers, radius: float) -> Integers:
    """All integer steps between cells that have points within ``radius`` of each other.

    The columns of ``cell`` are the edges of one cell. Two cells a step ``o`` apart hold points at
    ``cell (o + t)``, t in [-1, 1]^r; the least norm is a box-constrained least squares problem.
    Coordinate descent solves it for all steps at once and the duality gap of Frank and Wolfe makes
    the result a true lower bound: a cell is never left out by mistake.
    """
    steps = np.array(
        list(itertools.product(*(range(-m, m + 1) for m in margin))), dtype=np.int64
    ).reshape(-1, len(margin))
    gram = cell.T @ cell
    free = np.zeros(steps.shape)
    for _ in range(50):
        for axis in range(len(margin)):
            gradient = (steps + free) @ gram[:, axis]
            free[:, axis] = np.clip(free[:, axis] - gradient / gram[axis, axis], -1.0, 1.0)
    gradient = (steps + free) @ gram
    squared = np.einsum("ij,ij->i", gradient, steps + free)
    gap = np.sum(gradient * free + np.abs(gradient), axis=1)
    lower = squared - 2 * gap
    return np.asarray(steps[lower <= radius**2 * (1 + 1e-9)])


def _rows(steps: Integers) -> tuple[Integers, Integers]:
    """Runs along the last axis: first step (o, r) and length (o,) of each.

    The steps that reach a convex neighbourhood leave no gaps in a run.
    """
    _, run = np.unique(steps[:, :-1], axis=0, return_inverse=True)
    order = np.lexsort((steps[:, -1], run.ravel()))
    lengths = np.bincount(run.ravel())
    first = steps[order][np.concatenate([[0], np.cumsum(lengths)[:-1]])]
    return first, lengths.astype(np.int64)
